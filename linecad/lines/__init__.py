"""Straight segments of the photo, grouped to whole lines along their vanishing points."""
