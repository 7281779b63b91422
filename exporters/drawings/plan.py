"""The plan: the walls of a scene as seen from above, with what the photo shows of the ground, and the camera.

Drawing metres are x along the facade from its left end, y behind its plane; the camera stands below the walls on the
paper. Walls are as thin as the photo tells them: their outer side. Nothing hides anything, as under a roof that is off.
"""

from pathlib import Path

import numpy as np

from exporters.beside import Names, SideFiles
from exporters.drawings.choice import Choice
from exporters.drawings.content import camera_line, corners_of, guessed_planes, is_metric, lines_of, notes_of, unit_of
from exporters.drawings.dimensions import build_dimensions, distinct_spans, spread
from exporters.drawings.elevation import extents_of, front_of
from exporters.drawings.facades import Facade, facade_at, facades_of
from exporters.drawings.paper import fit
from exporters.drawings.projection import Box, Projection, visible_parts
from exporters.drawings.records import CAMERA, FACES, OPENINGS, OUTLINES, WALLS, Drawing, Layer, Stroke
from exporters.drawings.sheet import BORDERS, Facts, build_sheet, place_view
from exporters.drawings.writers import write_drawing
from exporters.model import Model
from exporters.options import Value
from exporters.textures.layout import view_of
from exporters.triangulation import checked_polygon
from linecad.arrays import Float
from linecad.directions import UP
from linecad.scene import OUTLINE

_AROUND = 0.04  # of the larger side of what is drawn, beyond it
_MARK = 0.008  # of the same: the radius of the camera's mark
_JAMB = 0.006  # of the same: half of the stroke across a wall where an opening ends
_CORNERS = 24  # of the circle of the mark
_SHORTEST = 1e-9  # drawing metres, of a piece of wall between two openings

Span = tuple[float, float]


def write(model: Model, path: Path, names: Names | None = None, **chosen: Value) -> SideFiles | None:
    """Write the plan in the format of the suffix of `path`, and return what lies beside it.

    `chosen` are fields of a Choice. Raises OSError where the file cannot be written, OutputError for a face that is no
    polygon, a facade that is not there, or a scale that does not fit.
    """
    return write_drawing(build_plan(model, Choice(**chosen)), path, names)  # type: ignore[arg-type]  # read as options


def build_plan(model: Model, choice: Choice) -> Drawing:
    """The plan of a scene, with the chosen facade level."""
    facade = facade_at(model, choice.facade)
    for face in model.faces:
        checked_polygon(face)
    projection = above(facade, model)
    walls = [(each, _ends(each, projection)) for each in facades_of(model)]
    eye = projection(model.eye)[:2]
    places = np.concatenate([eye[None], *(ends for _, ends in walls)])
    box = _box(places)
    fitted = fit((box[2] - box[0], box[3] - box[1]), BORDERS, choice.paper, choice.drawing_scale, is_metric(model))
    view = place_view(box, fitted)
    width = extents_of(facade, front_of(facade, model))[0]
    unit = unit_of(model, width[1] - width[0])
    low, high = places.min(axis=0).tolist(), places.max(axis=0).tolist()
    across = [sorted({low[0], *width, high[0]}), [low[0], high[0]]]
    up = [sorted({float(eye[1]), 0.0, high[1]}), [low[1], high[1]]]
    chains = [chain[1:] if chain[0] == chain[1] else chain for chain in (across, up)]
    dimensions = spread(build_dimensions(chains[0], chains[1], (high[0], low[1]), view), view, unit)
    strokes, guessed = _strokes(model, projection, walls, box)
    notes = notes_of(model, guessed, f"the width of facade {facade.number}")
    title = f"Plan, facade {facade.number} (plane {facade.plane}) level"
    frame, labels = build_sheet(
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
        sheet=tuple(frame),
        labels=tuple(labels),
        dimensions=tuple(dimensions),
        picture=None,
    )


def above(facade: Facade, model: Model) -> Projection:
    """The view from above, the facade from left to right and its rear upwards."""
    front = front_of(facade, model)
    return Projection(front.right, -front.toward, front.up, front.origin)


def _ends(facade: Facade, projection: Projection) -> Float:
    """(2, 2) drawing metres, from where to where the walls of a plane reach."""
    points = projection(np.concatenate([face.rings[0] for face in facade.faces]))[:, :2]
    along = points @ projection(facade.right + projection.origin)[:2]
    return points[[along.argmin(), along.argmax()]]


def _box(places: Float) -> Box:
    low, high = places.min(axis=0), places.max(axis=0)
    margin = _AROUND * float((high - low).max())
    return (*(low - margin).tolist(), *(high + margin).tolist())


def _strokes(
    model: Model, projection: Projection, walls: list[tuple[Facade, Float]], box: Box
) -> tuple[list[Stroke], list[str]]:
    """What is drawn, and what of it is guessed."""
    size = max(box[2] - box[0], box[3] - box[1])
    strokes: list[Stroke] = []

    def draw(layer: Layer, lines: Float, is_guess: bool = False) -> None:
        for _, part in visible_parts(lines, (), box, np.inf, 0.0):
            strokes.append(Stroke(layer.of_guesses if is_guess else layer, part[:, :2]))

    for face in model.faces:
        if (face.axis == UP or face.tilt) and face.kind not in ("ceiling", "reveal"):
            for ring in map(projection, face.rings):
                draw(FACES if face.kind == "ground" else OUTLINES, np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))
    lines = lines_of(model)
    flat = projection(lines.ends)
    for guess in (False, True):
        draw(OUTLINES, flat[(lines.roles == OUTLINE) & (lines.is_guess == guess)], guess)
    guesses = guessed_planes(model)
    for facade, ends in walls:
        whole, openings = _split(model, facade, ends, projection)
        draw(WALLS, _raised(whole), facade.plane in guesses)
        draw(OPENINGS, _raised(openings))
        draw(OPENINGS, _raised(_jambs(openings, _JAMB * size)))
    draw(CAMERA, _cone(model, projection, 2 * size))
    turn = np.linspace(0, 2 * np.pi, _CORNERS, endpoint=False)
    mark = projection(model.eye)[:2] + _MARK * size * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    strokes.append(Stroke(CAMERA, mark, is_closed=True, is_filled=True))
    dashed = sum(facade.plane in guesses for facade, _ in walls)
    return strokes, [f"dashed: {dashed} of {len(walls)} walls, whose place is probably wrong"] if dashed else []


def _split(model: Model, facade: Facade, ends: Float, projection: Projection) -> tuple[Float, Float]:
    """Pieces (N, 2, 2) of a wall between its openings, and its openings (M, 2, 2)."""
    along = ends[1] - ends[0]
    length = float(np.linalg.norm(along))
    along = along / length

    def span(points: Float) -> Span:
        at = (projection(points)[:, :2] - ends[0]) @ along
        return (max(float(at.min()), 0.0), min(float(at.max()), length))

    own = [span(corners_of(each, model)) for each in model.scene.openings if each.plane == facade.plane]
    holes = distinct_spans(each for each in own if each[0] < each[1])
    solid: list[Span] = []
    for start, end in _joined([span(face.rings[0]) for face in facade.faces]):
        for low, high in holes:
            if start < high and low < end:
                solid.append((start, low))
                start = max(start, high)
        solid.append((start, end))
    kept = [each for each in solid if each[1] - each[0] > _SHORTEST]
    placed = [ends[0] + np.array(spans).reshape(-1, 2, 1) * along for spans in (kept, holes)]
    return placed[0], placed[1]


def _joined(spans: list[Span]) -> list[Span]:
    """The union of spans, in ascending order."""
    joined: list[Span] = []
    for low, high in sorted(spans):
        if joined and low <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], high))
        else:
            joined.append((low, high))
    return joined


def _raised(lines: Float) -> Float:
    """(N, 2, 3) of lines (N, 2, 2), at height 0."""
    return np.concatenate([lines, np.zeros((*lines.shape[:2], 1))], axis=2)


def _jambs(openings: Float, half: float) -> Float:
    """(2 M, 2, 2) short strokes across a wall at both ends of its openings (M, 2, 2)."""
    along = openings[:, 1] - openings[:, 0]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1, keepdims=True) * half
    shifts = np.stack([-across, across], axis=1)
    return np.concatenate([openings[:, [end]] + shifts for end in (0, 1)])


def _cone(model: Model, projection: Projection, length: float) -> Float:
    """(2, 2, 3) drawing metres: from the camera along the left and right border of the photo, half-way down."""
    camera = view_of(model.scene)
    borders = np.array([[-0.5, (camera.height - 1) / 2, 1.0], [camera.width - 0.5, (camera.height - 1) / 2, 1.0]])
    rays = projection(borders @ np.linalg.inv(camera.projection).T + projection.origin) * np.array([1.0, 1.0, 0.0])
    rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    eye = projection(model.eye)
    return np.stack([np.stack([eye, eye]), eye + length * rays], axis=1)
