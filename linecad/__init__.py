"""From one photo of a Manhattan scene to its 3D lines, planes and CAD files.

Nothing is re-exported here: `solver` and `exporters` import `linecad.scene`, and a re-export would close a circle.
"""

import os

# OpenCV reads this when it is loaded. A file whose header deceives linecad.camera.decoding, which looks at it first, is
# then refused before memory is taken for its pixels. The number is that of linecad.camera.decoding.
os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", "200000000")

__version__ = "0.1.0"
