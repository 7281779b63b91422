"""A line graph in, a solution out: which crossings are real, which lines are boundaries, how deep each line is."""
