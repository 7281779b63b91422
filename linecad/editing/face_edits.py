"""What the page sends about faces, turned into corrections: walls are named by a line in them, lassos made simple."""

import numpy as np
import shapely

from linecad.corrections.edits import Anchor, FaceEdit, NoWindow, Point, Region, WallAnchor, WallByEdges
from linecad.corrections.face_file import EDGES, points, shown, window
from linecad.corrections.nodes import point
from linecad.directions import UP
from linecad.editing.session import Session
from linecad.errors import CorrectionError
from linecad.io.strict_json import Node
from linecad.model.regions.telling import IN_THE_SKY, is_above_horizon
from linecad.scene import Plane

LEAST_LASSO = 4.0  # px^2
LASSO_STEP = 5e-4  # of the photo's width, by which a lasso is made simpler: a hand draws no finer


def read_face_edit(node: Node, session: Session) -> FaceEdit:
    """The correction that an edit about faces means; JsonError or CorrectionError where it means none."""
    match node["op"].text():
        case "region":
            return _region(Region(_lasso(points(node["polygon"]), session), shown(node)), session)
        case "window":
            return window(node, _wall(node["plane"].integer(), session))
        case "no-window":
            return NoWindow(point(node["at"]))
        case _:
            items = node["lines"].items()
            if len(items) != EDGES:
                raise node["lines"].wrong(f"a list of {EDGES}")
            one, two, three, four = (session.editing.anchor(item.integer()) for item in items)
            return WallByEdges((one, two, three, four))


def _region(told: Region, session: Session) -> Region:
    """The same; CorrectionError for ground that cannot be any."""
    found = session.now().found
    if told.shows == "ground" and is_above_horizon(told.polygon, found.camera.matrix, found.frame.rotation):
        raise CorrectionError(IN_THE_SKY)
    return told


def _lasso(drawn: tuple[Point, ...], session: Session) -> tuple[Point, ...]:
    """The outline of the largest part of what a line goes around that may cross itself; CorrectionError for none."""
    width = session.now().found.camera.width
    whole = shapely.simplify(shapely.make_valid(shapely.Polygon(drawn)), LASSO_STEP * width)
    parts = [part for part in shapely.get_parts(shapely.make_valid(whole)) if isinstance(part, shapely.Polygon)]
    largest = max(parts, key=lambda part: float(part.area), default=shapely.Polygon())
    if largest.area < LEAST_LASSO:
        raise CorrectionError("the line goes around nothing; draw it around what you mean")
    return tuple((u, v) for u, v in shapely.get_coordinates(largest.exterior)[:-1].tolist())


def _wall(number: int, session: Session) -> WallAnchor:
    """How the file names a wall of the model: by its longest level line, else its longest one that is no detail."""
    scene = session.scene()
    plane = next((each for each in scene.planes if each.id == number), None)
    if plane is None or plane.axis == UP or plane.tilt:
        raise CorrectionError("no wall of the model is there; make one of four edges first")
    return WallAnchor(plane.axis, _line_in(plane, session))


def _line_in(plane: Plane, session: Session) -> Anchor | None:
    """A line of a plane that edits can name; None where it has none."""
    corrected, lines = session.lines.corrected, session.scene().lines
    looks = zip(corrected.segments.axis.tolist(), corrected.segments.ends, corrected.ids.tolist(), strict=True)
    inside = set(plane.lines)
    rows = ((lines.row_by_look.get((axis, ends.tobytes())), axis, ends, number) for axis, ends, number in looks)
    found = [
        (axis == UP, -float(np.linalg.norm(ends[1] - ends[0])), number)
        for row, axis, ends, number in rows
        if row is not None and int(lines.id[row]) in inside
    ]
    return session.editing.anchor(min(found)[2]) if found else None
