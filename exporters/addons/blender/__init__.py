"""The add-on for Blender; only Blender can load what is in here."""
