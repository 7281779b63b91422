"""linecad inside other programs: the sources of an add-on for Blender and a macro for FreeCAD, and what writes them."""
