"""What a user can choose about formats, for the rows of the table of formats."""

from exporters.drawings.sizes import FIT, SCALES, SIZES
from exporters.model import ORIGINS
from exporters.options import Option

THICKNESS = Option(
    "wall-thickness", 0.3, "how thick walls are taken to be, in metres: the photo shows their faces alone",
    least=0.01, most=5.0,
)  # fmt: skip
BANDS = Option(
    "probability", False, "layers and groups of lines by how sure their depth is: ..._sure, ..._likely, ..._guess"
)
ROLES = Option(
    "roles", False, "layers and groups of lines by what they are drawn for: ..._opening for sides of openings, "
    "..._detail for bars, panes, joints and courses",
)  # fmt: skip
COMPONENTS = Option(
    "components", False, "layers and groups of lines and faces by the groups of lines that hang together: "
    "..._component_1 and so on for all but component 0",
)  # fmt: skip
ORIGIN = Option(
    "origin", ORIGINS[0], "z = 0 is the ground, where the scale and the ground are known, or the camera is the origin",
    words=ORIGINS,
)  # fmt: skip
MODEL_OPTIONS = (BANDS, ROLES, ORIGIN, COMPONENTS)
INSTANCES = Option(
    "instances", False, "equal windows and doors as one shape placed many times, in GLB and USD with the texture of "
    "the one that the photo shows best, in STEP and USD without names by id",
)  # fmt: skip
VERSION = Option("version", "R2010", "the release of AutoCAD that the file is for", words=("R2010", "R2018"))
SEWN = Option("sewn", False, "faces that share edges as shells in one part, which costs the names of the faces")
TUBES = Option("tubes", False, "lines as thin tubes, which renderers show, instead of as lines, which they do not")

IDS = Option("ids", False, "the ids of lines on them in the picture, in place of the marks of crossings")
UP = Option("up", "y", "what is up in an OBJ: y as most programs take it, or z as FreeCAD does", words=("y", "z"))

TEXTURES_ON = Option("textures", True, "the photo on the faces, where it is at hand")
TEXTURE_SIZE = Option("texture-size", 4096, "the most texels a side of a picture of textures", least=256, most=16384)
TEXTURE_FILL = Option(
    "texture-fill", "own", "what is painted where a tree, a car or the like hides a face: its own colours and grain, "
    "or plain grey",
    words=("own", "grey"),
)  # fmt: skip
TEXTURES = (TEXTURES_ON, TEXTURE_SIZE, TEXTURE_FILL)

FACADE_OF_DRAWING = Option(
    "facade", 0, "what is drawn, level in a plan: 0 is the largest facade, and so on", least=0, most=9999
)
SCALE_OF_DRAWING = Option(
    "drawing-scale", FIT, "the scale of the drawing, or the largest usual one that fits on the paper",
    words=(FIT, *(f"1:{each}" for each in SCALES)),
)  # fmt: skip
PAPER_OF_DRAWING = Option(
    "paper", FIT, "the size of the sheet, or the smallest that the scale fits on, A3 without a scale",
    words=(FIT, *SIZES),
)  # fmt: skip
DPI = Option("dpi", 200, "the resolution of the photo on the paper", least=10, most=2400)
UNDERLAY = Option("underlay", True, "the rectified photo beneath the lines, where it is at hand")
DRAWING_SCALE, PAPER, FACADE = SCALE_OF_DRAWING.key, PAPER_OF_DRAWING.key, FACADE_OF_DRAWING.key
SHEET = (FACADE_OF_DRAWING, SCALE_OF_DRAWING, PAPER_OF_DRAWING)
