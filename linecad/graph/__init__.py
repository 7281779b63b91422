"""The line graph: which lines may meet, how they hang together, and what evidence there is for each crossing."""
