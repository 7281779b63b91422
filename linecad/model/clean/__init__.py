"""The lines of a scene as a draughtsman draws them: one line where there is one, ends that meet, a role for each."""
