"""From one photo of a Manhattan scene to its 3D lines, planes and CAD files.

    import linecad
    scene = linecad.reconstruct("facade.jpg")
    linecad.export(scene, "facade.step")

What is named here is loaded when it is first used: `import linecad` costs nothing, and `solver` and `exporters`, which
import linecad's records, close no circle.
"""

import os
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from linecad.convert import reconstruct
    from linecad.errors import LinecadError
    from linecad.io.scene_file import read_scene
    from linecad.options import Options
    from linecad.outputs import export
    from linecad.scene import Scene
    from solver.options import SolveOptions

__all__ = ["LinecadError", "Options", "Scene", "SolveOptions", "export", "read_scene", "reconstruct"]

# OpenCV reads this when it is loaded. A file whose header deceives linecad.camera.decoding, which looks at it first, is
# then refused before memory is taken for its pixels. The number is that of linecad.camera.decoding.
os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", "200000000")

__version__ = "0.1.0"

_HOMES = {
    "LinecadError": "linecad.errors",
    "Options": "linecad.options",
    "Scene": "linecad.scene",
    "SolveOptions": "solver.options",
    "export": "linecad.outputs",
    "read_scene": "linecad.io.scene_file",
    "reconstruct": "linecad.convert",
}


def __getattr__(name: str) -> object:
    """Load what was named."""
    if name not in _HOMES:
        raise AttributeError(f"module 'linecad' has no attribute {name!r}")
    found = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return found


def __dir__() -> list[str]:
    """With the names that are not loaded yet."""
    return sorted({*globals(), *_HOMES})
