"""STEP: the assembly, and the text that does not change from one process to the next."""
