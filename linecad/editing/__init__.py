"""The page of `linecad edit`: look at a photo's lines, correct them, solve again, export, label."""
