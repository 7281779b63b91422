"""From one photo of a Manhattan scene to its 3D lines, planes and CAD files.

Nothing is re-exported here: `solver` and `exporters` import `linecad.scene`, and a re-export would close a circle.
"""

__version__ = "0.1.0"
