"""Depth maps that a network or a phone made of the photo: reading them, and laying them onto the photo's pixels."""
