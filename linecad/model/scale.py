"""How long a unit of a scene is in metres, from a length that a person knows.

One photo has no scale, so somebody must say one length: of a line of the scene, between two points of the photo that
lie on one line or on faces, or the height of the camera above the ground. Only `metres_per_unit` is set; the
coordinates of a scene stay as they are.

Where the scene tells probabilities, whatever a person names is measured, and what is measured says so where its depth
is a guess; else component 0 alone (`measurable`). The ground stands where the lines of the whole scene put it
(linecad.model.regions.surfaces).
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from exporters.bands import GUESS, bands_of
from linecad.arrays import Bool, Float
from linecad.directions import Turns, across, axis_name, components
from linecad.errors import ScaleError
from linecad.geometry import world_rays
from linecad.scene import Face, Plane, Scene, ground_of

REACH = 0.004  # of the photo's longer side: a point that is nearer to a line in the photo lies on it
LOWER_SHARE = 0.1  # of the camera's height: what reaches farther below a plane speaks against its being the ground
STRAY_LINES = 2  # lines that may reach below the ground, because some are always wrong
SHORTEST = 1e-9  # of the scene's median depth; shorter lengths measure nothing
WORDS = ("first", "second")
UNSURE = "stands at a depth that is a guess"  # of lines that are not `measurable`
UNSURE_PLANE = f"{UNSURE} or that no line tells"
DOUBT = ", at a depth that is a guess"  # of what is measured all the same


@dataclass(frozen=True)
class LineLength:
    """A line of the scene is `metres` long, from end to end as the scene has it."""

    line: int  # id
    metres: float

    @property
    def arguments(self) -> tuple[str, str]:
        """As on the command line."""
        return "--scale", f"{self.line}={self.metres:g}"


@dataclass(frozen=True)
class PointDistance:
    """Two points of the photo lie `metres` apart in space."""

    points: tuple[tuple[float, float], tuple[float, float]]  # px, as `segment` of the scene file counts them
    metres: float

    @property
    def arguments(self) -> tuple[str, str]:
        """As on the command line."""
        (a, b), (c, d) = self.points
        return "--scale", f"{a:g},{b:g}:{c:g},{d:g}={self.metres:g}"


@dataclass(frozen=True)
class CameraHeight:
    """The camera stands `metres` above the ground."""

    metres: float

    @property
    def arguments(self) -> tuple[str, str]:
        """As on the command line."""
        return "--camera-height", f"{self.metres:g}"


Known = LineLength | PointDistance | CameraHeight


def set_scale(scene: Scene, known: Known) -> Scene:
    """The scene with `metres_per_unit` as the known length says, and what was measured for it as `scale_source`.

    Raises ScaleError where the scene does not hold what is to be measured.
    """
    match known:
        case LineLength():
            units, doubt = _line_length(scene, known.line)
            what = f"line {known.line}{doubt}{',' * bool(doubt)} is {known.metres:g} m long"
        case PointDistance():
            units, where = _distance(scene, *known.points)
            (a, b), (c, d) = known.points
            what = f"{a:g},{b:g} and {c:g},{d:g} px, on {where}, are {known.metres:g} m apart"
        case CameraHeight():
            plane = find_ground(scene)
            units = -plane.offset
            number, height = f"plane {plane.id}", f"z = {plane.offset:.4g}"
            if plane.shows_ground:
                where = f"the ground, {number} ({height})"
            else:
                where = f"{number} ({height}), taken to be the ground as the lowest horizontal plane"
            what = f"the camera is {known.metres:g} m above {where}"
    factor = known.metres / units
    return replace(scene, metres_per_unit=factor, scale_source=f"{what}, so a unit is {factor:.6g} m")


def find_ground(scene: Scene) -> Plane:
    """The plane of the ground's faces, also where no line lies in it; the lowest of several.

    In a scene without such faces, the lowest horizontal plane of component 0 below the camera. Lines that reach farther
    down than LOWER_SHARE of its depth, more than STRAY_LINES of them, show that it is a balcony or a row of sills.
    Raises ScaleError then, and where there is no such plane.
    """
    shown = ground_of(scene.planes)
    if shown is not None:
        return shown
    own = _own_lines(scene)
    below = [plane for plane in scene.planes if plane.axis == 2 and plane.offset < 0 and own & set(plane.lines)]
    if not below:
        raise ScaleError(
            "component 0 has no horizontal plane below the camera that could be the ground; give a known length instead"
        )
    ground = min(below, key=lambda plane: plane.offset)
    lowest = scene.lines.ends[scene.lines.component == 0, :, 2].min(axis=1)
    lower = int((lowest < ground.offset * (1 + LOWER_SHARE)).sum())
    if lower > STRAY_LINES:
        raise ScaleError(
            f"the lowest horizontal plane, {ground.id} (z = {ground.offset:.4g}), is not the ground: {lower} lines "
            f"reach below it, down to z = {lowest.min():.4g}; give a known length instead"
        )
    return ground


def _own_lines(scene: Scene) -> set[int]:
    """The ids of the lines of component 0."""
    return set(scene.lines.id[scene.lines.component == 0].tolist())


def _line_length(scene: Scene, line: int) -> tuple[float, str]:
    """In units of the scene, and what is to be told of its depth."""
    rows = np.flatnonzero(scene.lines.id == line)
    if len(rows) == 0:
        last = f"has ids up to {scene.lines.id.max()}" if len(scene.lines) else "has no lines"
        raise ScaleError(
            f"the scene has no line {line}, it {last}; name two places in the photo, U,V:U2,V2=METRES, or see the ids "
            "in a picture by `linecad export` with --option ids=on"
        )
    is_sure = bool(measurable(scene)[rows[0]])
    if not is_sure and bands_of(scene.lines) is None:
        raise ScaleError(
            f"line {line} belongs to component {scene.lines.component[rows[0]]}, whose own scale is a guess; "
            "choose a line of component 0, or make its group that one by `linecad export` with --main U,V, a place on "
            "it in the photo"
        )
    start, end = scene.lines.ends[rows[0]]
    return _checked(scene, float(np.linalg.norm(end - start)), f"line {line}"), "" if is_sure else DOUBT


def _distance(scene: Scene, first: tuple[float, float], second: tuple[float, float]) -> tuple[float, str]:
    """How far apart two points of the photo (px) lie in space, in units of the scene, and on what they lie."""
    pixels = np.array([first, second])
    rays = world_rays(pixels, scene.camera.matrix, scene.rotation)
    row = _line_under_both(scene, pixels)
    if row is not None:
        doubt = "" if measurable(scene)[row] else DOUBT
        points, where = nearest_on_line(rays, scene.lines.ends[row]), f"line {scene.lines.id[row]}{doubt}"
    else:
        (one, on), (other, beside) = (_point(scene, pixels[k], rays[k], word) for k, word in enumerate(WORDS))
        comma = "," if on.endswith(DOUBT) else ""
        points, where = np.array([one, other]), on if on == beside else f"{on}{comma} and {beside}"
    return _checked(scene, float(np.linalg.norm(points[1] - points[0])), "between the two points"), where


def _line_under_both(scene: Scene, pixels: Float) -> int | None:
    """The row of the line that both points (2, 2) px lie on; of a guess only where they do not show one sure plane."""
    row = _line_under(scene, pixels, measurable(scene))
    if row is not None or bands_of(scene.lines) is None:
        return row
    one, other = (seen_plane(scene, pixel, None) for pixel in pixels)
    if one is not None and other is not None and one.id == other.id and is_measurable(scene, one):
        return None
    return _line_under(scene, pixels, np.ones(len(scene.lines), bool))


def _point(scene: Scene, pixel: Float, ray: Float, word: str) -> tuple[Float, str]:
    """Where (3,) what a point of the photo (2,) px shows lies, and what it is: a face, else a line; the sure before."""
    plane, sure = seen_plane(scene, pixel, None), measurable(scene)
    is_sure = plane is not None and is_measurable(scene, plane)
    is_told = bands_of(scene.lines) is not None
    row = None if is_sure else _line_under(scene, pixel[None], sure)
    if plane is not None and (is_sure or (is_told and row is None)):
        depth = plane.offset / float(plane.along_normal(ray, scene.turns))
        return ray * depth, f"plane {plane.id} ({axis_name(plane.axis)}){'' if is_sure else DOUBT}"
    if row is None and is_told:
        row = _line_under(scene, pixel[None], np.ones(len(sure), bool))
    if row is not None:
        what = f"line {scene.lines.id[row]}{'' if sure[row] else DOUBT}"
        return nearest_on_line(ray[None], scene.lines.ends[row])[0], what
    lies = "no face" if plane is None else f"plane {plane.id}, which {UNSURE_PLANE},"
    raise ScaleError(
        f"the {word} point lies on {lies} and on no line that can be measured; choose a point on a face or a line, "
        "or give a line by its id"
    )


def _line_under(scene: Scene, pixels: Float, which: Bool) -> int | None:
    """The row of that of some lines (N,) that points (M, 2) px all lie on, the nearest of several; or None."""
    lines = scene.lines
    reach = REACH * max(scene.camera.width, scene.camera.height)
    off = shapely.distance(shapely.linestrings(lines.segment)[:, None], shapely.points(pixels)).max(axis=1, initial=0.0)
    off[~which | (off > reach)] = np.inf
    row = int(off.argmin()) if len(off) else 0
    return row if len(off) and np.isfinite(off[row]) else None


def nearest_on_line(rays: Float, ends: Float) -> Float:
    """(M, 3) the points of a line (2, 3) that come nearest to rays (M, 3) from the camera."""
    direction = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    unit = rays / np.linalg.norm(rays, axis=1)[:, None]
    cosine = unit @ direction
    along = (cosine * (unit @ ends[0]) - ends[0] @ direction) / (1.0 - cosine**2)
    points: Float = ends[0] + along[:, None] * direction
    return points


def measurable(scene: Scene) -> Bool:
    """(N,) whether the length of each line says how long a unit is: where its depth is no guess.

    Where the scene tells probabilities, all components have one scale, and a length is as far off as the depth of its
    line is (docs/decisions/0108); where it tells none, each has a scale of its own, and only component 0 is measured.
    """
    bands = bands_of(scene.lines)
    tells: Bool = scene.lines.component == 0 if bands is None else bands != GUESS
    return tells


def is_measurable(scene: Scene, plane: Plane) -> bool:
    """Whether a plane shows the ground, on which all stands, or half of its lines or more are `measurable`.

    A roof has the lines of the wall that carries it, a pane those of the wall around it. A plane without any is not.
    """
    if plane.shows_ground:
        return True
    wall_of = {opening.id: opening.plane for opening in scene.openings}
    own = {scene.walls_of_roofs.get(plane.id, plane.id)}
    if not plane.lines:
        own |= {wall_of[face.opening] for face in plane.faces if face.opening is not None}
    tells = measurable(scene)[np.isin(scene.lines.id, [line for p in scene.planes if p.id in own for line in p.lines])]
    return bool(len(tells) and 2 * tells.sum() >= len(tells))


def seen_plane(scene: Scene, pixel: tuple[float, float] | Float, normal: int | None) -> Plane | None:
    """The plane whose face is the first that a pixel shows of all with this normal, or of all; None where none is."""
    ray = world_rays(np.array(pixel), scene.camera.matrix, scene.rotation)
    met = [
        (depth, face.id, plane)
        for plane, face in scene.faces
        if normal in (None, plane.axis) and (depth := depth_on_face(ray, plane, face, scene.turns)) is not None
    ]
    return min(met, key=lambda each: each[:2])[2] if met else None


def depth_on_face(ray: Float, plane: Plane, face: Face, turns: Turns) -> float | None:
    """How many times as long a ray (3,) from the camera must be to meet a face; None where it does not meet it."""
    along = float(plane.along_normal(ray, turns))
    if along * plane.offset <= 0:
        return None
    ray = components(ray, turns)
    others = sorted(across(np.array(plane.axis)).tolist())
    shell, *holes = (components(ring, turns)[:, others] for ring in (face.outline, *face.holes))
    polygon = shapely.Polygon(shell, holes)
    depth = plane.offset / along
    return depth if shapely.contains_xy(polygon, *(ray * depth)[others]) else None


def _checked(scene: Scene, units: float, what: str) -> float:
    depth = float(np.median(np.abs(scene.lines.ends @ scene.rotation[2]))) if len(scene.lines) else 1.0
    if not units > SHORTEST * depth:
        raise ScaleError(f"{what} measures nothing: its length in the scene is 0; choose a longer one")
    return units
