"""fSpy: the project, and the control lines that a person would have drawn in it."""
