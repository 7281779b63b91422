"""Evidence, one file each: a cue gives log-odds per edge, or a log depth per line with a standard error."""
