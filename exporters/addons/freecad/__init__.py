"""The macro for FreeCAD; only FreeCAD can load what is in here."""
