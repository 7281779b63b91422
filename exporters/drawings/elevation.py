"""The elevation of a facade: what an observer sees from straight before its plane, infinitely far away.

Drawing metres are x along the facade from its left end, y above the ground; where no ground is known, above the foot
of the facade. What stands before the facade is drawn too, as far as the camera: there is the section. Nearer faces hide
what is behind them.
"""

from pathlib import Path

import numpy as np

from exporters.beside import Names, SideFiles
from exporters.drawings.choice import Choice
from exporters.drawings.content import (
    LAYER_OF,
    DrawnLines,
    camera_line,
    corners_of,
    is_metric,
    lines_of,
    notes_of,
    unit_of,
)
from exporters.drawings.dimensions import (
    Measured,
    build_dimensions,
    build_levels,
    chains_across,
    chains_up,
    distinct_spans,
    spread,
)
from exporters.drawings.facades import Facade, facade_at
from exporters.drawings.paper import fit
from exporters.drawings.photo import build_picture
from exporters.drawings.projection import EDGE_ON, Box, Projection, Shown, shown_faces, visible_parts
from exporters.drawings.records import FACES, GROUND, OPENINGS, Drawing, Stroke
from exporters.drawings.sheet import BORDERS, Facts, build_sheet, place_view
from exporters.drawings.writers import write_drawing
from exporters.model import Model, metres_per_unit
from exporters.options import Value
from exporters.textures.rectify import Pixels
from exporters.triangulation import checked_polygon
from linecad.arrays import Bool, Float
from linecad.directions import UP
from linecad.scene import OPENING, SAME_HEIGHT, Opening, ground_of

_AROUND = 0.08  # of the facade's larger side, that is drawn beside and above it
# Of the distance of the camera from the facade: what lies so little behind a face is on it, but for rounding. A larger
# one would draw what is hidden (docs/decisions/0102).
_TOUCHING = 1e-6
_SAME = 2e-3  # of the facade's larger side: a line that is so near to the side of an opening repeats it


def write(
    model: Model, path: Path, photo: Pixels | None = None, names: Names | None = None, **chosen: Value
) -> SideFiles | None:
    """Write the elevation in the format of the suffix of `path`, and return what lies beside it.

    `chosen` are the fields of a Choice. Raises OSError where the file cannot be written, OutputError for a face that
    is no polygon, a facade that is not there, or a scale that does not fit.
    """
    drawing = build_elevation(model, Choice(**chosen), photo)  # type: ignore[arg-type]  # read by their options
    return write_drawing(drawing, path, names)


def build_elevation(model: Model, choice: Choice, photo: Pixels | None = None) -> Drawing:
    """The drawing of a facade, with the photo (H, W, 3) beneath where there is one and it is wanted."""
    facade = facade_at(model, choice.facade)
    for face in model.faces:
        checked_polygon(face)
    projection = front_of(facade, model)
    width, height = extents_of(facade, projection)
    roofs = _roofs(model, projection)
    box = _box(width, height, roofs)
    fitted = fit((box[2] - box[0], box[3] - box[1]), BORDERS, choice.paper, choice.drawing_scale, is_metric(model))
    view = place_view(box, fitted)
    shown = shown_faces(model.faces, projection, _section(projection, model))
    unit = unit_of(model, width[1] - width[0])
    strokes, guessed = _strokes(model, projection, shown, box)
    measured = measure(model, facade, projection, roofs)
    marks, heights = build_levels(measured, view, unit)
    corner = (measured.width[1], measured.height[0])
    dimensions = spread(build_dimensions(chains_across(measured), chains_up(measured), corner, view), view, unit)
    title = f"Elevation of facade {facade.number} (plane {facade.plane})"
    wanted = photo if choice.underlay else None
    if choice.underlay and photo is None:
        guessed.append("no photo lies beneath, as it was not at hand")
    notes = notes_of(model, guessed, "the width of the facade")
    frame, texts = build_sheet(
        Facts(title, model.photo, model.unit_note, (camera_line(model),), notes), fitted, view, unit
    )
    return Drawing(
        title=title,
        photo=model.photo,
        unit_note=model.unit_note,
        paper=fitted.paper,
        view=view,
        unit=unit,
        strokes=tuple(strokes),
        sheet=(*frame, *marks),
        labels=(*texts, *heights),
        dimensions=tuple(dimensions),
        picture=None if wanted is None else build_picture(model, shown, projection, view, choice.dpi, wanted),
    )


def _section(projection: Projection, model: Model) -> float:
    """Drawing metres from the facade to the camera: what is before that is not drawn."""
    return float(projection(model.eye)[2])


def front_of(facade: Facade, model: Model) -> Projection:
    """The view of a facade from straight before it."""
    points = np.concatenate([face.rings[0] for face in facade.faces])
    up = np.eye(3)[UP]
    ground = ground_of(model.scene.planes)
    level = (
        float(points[:, UP].min())
        if ground is None
        else ground.offset * metres_per_unit(model.scene) + float(model.eye[UP])
    )
    face = facade.faces[0]
    depth = face.offset * float(face.direction @ facade.normal)
    origin = float((points @ facade.right).min()) * facade.right + level * up + depth * facade.normal
    return Projection(facade.right, up, facade.normal, origin)


def extents_of(facade: Facade, projection: Projection) -> tuple[tuple[float, float], tuple[float, float]]:
    """Drawing metres from where to where a facade reaches, along x and y."""
    points = projection(np.concatenate([face.rings[0] for face in facade.faces]))
    (x0, y0), (x1, y1) = points[:, :2].min(axis=0).tolist(), points[:, :2].max(axis=0).tolist()
    return (x0, x1), (y0, y1)


def _roofs(model: Model, projection: Projection) -> Float:
    """(V, 2) drawing metres, the corners of the roofs whose eave, the lowest of their edges, is on the facade.

    `Scene.walls_of_roofs` does not do: to it a wall whose lines are all left out carries no roof.
    """
    near = SAME_HEIGHT * float(np.linalg.norm(np.ptp(model.points, axis=0)))
    corners = [np.zeros((0, 2))]
    for face in model.faces:
        if face.kind == "roof":
            flat = projection(face.rings[0])
            eave = flat[flat[:, 1] - flat[:, 1].min() < near]
            if len(eave) > 1 and (np.abs(eave[:, 2]) < near).all():
                corners.append(flat[:, :2])
    return np.concatenate(corners)


def measure(model: Model, facade: Facade, projection: Projection, roofs: Float) -> Measured:
    """What is dimensioned of a facade: itself, the rows and columns of its openings, the top of its roofs (V, 2)."""
    own = [opening for opening in model.scene.openings if opening.plane == facade.plane]
    flat = [projection(corners_of(opening, model))[:, :2] for opening in own]
    across = [(float(each[:, 0].min()), float(each[:, 0].max())) for each in flat]
    up = [(float(each[:, 1].min()), float(each[:, 1].max())) for each in flat]
    width, height = extents_of(facade, projection)
    top = max([height[1], *roofs[:, 1].tolist()])
    return Measured(width, height, distinct_spans(across), distinct_spans(up), top)


def _box(width: tuple[float, float], height: tuple[float, float], roofs: Float) -> Box:
    """What is drawn: the facade with the corners (V, 2) of its roofs and what is about it, down to the ground."""
    side = max(width[1] - width[0], height[1] - height[0])
    corners = np.array([(width[0], min(height[0], 0.0)), (width[1], max(height[1], 0.0)), *roofs])
    (left, low), (right, high) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return (left - _AROUND * side, low, right + _AROUND * side, high + _AROUND * side)


def _strokes(model: Model, projection: Projection, shown: list[Shown], box: Box) -> tuple[list[Stroke], list[str]]:
    """What of the scene is drawn, and what of it is guessed."""
    section = _section(projection, model)
    touching = _TOUCHING * section

    def parts(lines: Float) -> list[tuple[int, Float]]:
        return visible_parts(lines, shown, box, section, touching)

    borders = [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for each in shown for ring in each.rings]
    strokes = [Stroke(FACES, part[:, :2]) for _, part in parts(np.concatenate([np.zeros((0, 2, 3)), *borders]))]
    openings = [each for each in model.scene.openings if _faces(each, model, projection)]
    sides = np.array([_sides(projection(corners_of(each, model))) for each in openings]).reshape(-1, 2, 3)
    lines = lines_of(model)
    flat = projection(lines.ends)
    drawn = np.flatnonzero(~_repeats(flat, lines, sides, _SAME * max(box[2] - box[0], box[3] - box[1])))
    seen = [(int(drawn[row]), part) for row, part in parts(flat[drawn])]
    for role, layer in reversed(LAYER_OF.items()):  # details below outlines
        strokes += [
            Stroke(layer.of_guesses if lines.is_guess[row] else layer, part[:, :2])
            for row, part in seen
            if lines.roles[row] == role
        ]
    framed = parts(sides)
    for row, part in framed:
        strokes.append(Stroke(OPENINGS.of_guesses if openings[row // 4].is_completed else OPENINGS, part[:, :2]))
    if ground_of(model.scene.planes) is not None:
        strokes.append(Stroke(GROUND, np.array([(box[0], 0.0), (box[2], 0.0)])))
    rows = {row for row, _ in seen}
    dashed = sum(bool(lines.is_guess[row]) for row in rows)
    completed = len({row // 4 for row, _ in framed if openings[row // 4].is_completed})
    guessed = []
    if dashed:
        guessed.append(f"dashed: {dashed} of {len(rows)} lines, whose depth is probably wrong")
    if completed:
        guessed.append(f"dashed: {completed} openings that the photo does not show and their rows ask for")
    return strokes, guessed


def _faces(opening: Opening, model: Model, projection: Projection) -> bool:
    """Whether the viewer sees the wall of an opening from a side, that of the camera."""
    normals = (face.normal for face in model.faces if face.plane == opening.plane)
    return any(float(normal @ projection.toward) > EDGE_ON for normal in normals)


def _sides(corners: Float) -> Float:
    """(4, 2, 3) the sides of a rectangle (4, 3)."""
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


def _repeats(flat: Float, lines: DrawnLines, sides: Float, near: float) -> Bool:
    """(N,) which lines of openings lie on a side of one, which is drawn in their place."""
    repeats = np.zeros(len(flat), np.bool_)
    if not len(sides):
        return repeats
    start, along = sides[:, 0], sides[:, 1] - sides[:, 0]
    length = np.linalg.norm(along, axis=1)
    for row in np.flatnonzero(lines.roles == OPENING).tolist():
        apart = flat[row][:, None] - start  # (2, S, 3)
        at = np.clip(np.sum(apart * along, axis=2) / length**2, 0, 1)
        off = np.linalg.norm(apart - at[..., None] * along, axis=2).max(axis=0)
        repeats[row] = bool((off <= near).any())
    return repeats
