"""What every part of the photo shows: one of the planes, the ground, the sky, or nothing that is flat."""
