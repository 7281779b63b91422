"""Where a roof ends beside its ridge, and what that tells of its slope."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, directions_of
from linecad.geometry import angles_to, directions_to, lengths, project, vanishing_points
from linecad.model.regions.bearings import Bearing
from linecad.model.regions.columns import BESIDE, BLURRED, FOOT
from linecad.model.regions.profiles import Profile, Shown
from linecad.model.regions.slopes import UNSURE, USUAL, Edge, End, Slope, slopes_by

LEAST_PIECE = 0.008  # of the photo's width, of a segment on the end of a roof
AT_RIDGE, AT_EAVE = 0.025, 0.06  # of the photo's width, from the ends of ridge and wall to where such a line meets them
HIDDEN_EAVE = 0.2  # the same beyond the end of a wall where something else is seen beside it and hides the eave
AT_CORNER = 0.05  # of a wall's offset, from the foot of a valley to where the next wall meets it
COVERED = 0.5  # of such a line, by segments
ON_LINE = 2.0  # px at a width of NORMAL_WIDTH; a segment so near to a line is on it
ASTRAY = np.sin(np.radians(4.0))  # of a segment on it
LEAST_TURN = np.sin(np.radians(7.0))  # in the photo, between it and the eave
ALONG = np.sin(np.radians(3.0))  # of a segment, against the axes across the eave: edges of walls are no ends of roofs
LEAST_SEEN = 0.3  # of such a line, before which nothing stands
STEPS = 100  # in which coverage is counted
AT_BORDER = 3  # columns from the border of the photo, where what it shows goes on
BEYOND = 0.1  # of the photo's width, by which it does at least
OUTSIDE = 4  # columns beyond the end of a ridge, where the sky may be seen
UPPER, FREE = 1 / 3, 0.5  # part of the end of a roof, and share of that beside which the sky is seen
MOST_BESIDE = 0.02  # of the photo's width, from the end of a ridge to where that of a usual roof would be


@dataclass(frozen=True, eq=False)
class RoofEnd:
    """One end of a roof in the photo."""

    foot: Float  # (2,) px, at the eave
    top: Float  # (2,) px, at the ridge
    up: Float  # (2,) unit, upright in the photo at its foot
    slopes: list[Slope]  # that it tells
    is_upright: bool = False  # before the sky, where the end of no usual roof would be: that of a wall


def find_end(profile: Profile, raw: Float, shown: Shown, end: int, bearing: Bearing) -> RoofEnd:
    """The left (0) or the right (1) end of the roof of a profile, by segments `raw` (N, 2, 2) px of any direction."""
    place = profile.ends[end]
    wall = (profile.first, profile.last)[end]
    foot, top = _line(profile, raw, shown, end)
    points = vanishing_points(shown.view.camera.matrix, shown.view.rotation)
    if foot is not None and top is not None:
        inwards = _along(profile, shown, 1 - end) - _along(profile, shown, end)
        way, likely = float(np.sign(inwards)), _may_be(profile, shown, end, foot)
        edge = Edge(foot, top, way, bearing, _is_free(profile, shown, (foot, top), end))
        # Where it is no valley, what is beside it stands before it.
        told = slopes_by(edge, profile.wall, shown, likely) or slopes_by(edge, profile.wall, shown, ("verge", "hip"))
        if told:
            return RoofEnd(foot, top, _up(foot, points), [slope for slope in told if slope.error < UNSURE])
    column = max(place, wall) if end == 0 else min(place, wall)
    foot, top = profile.eave[column], profile.ridge[column]
    if not AT_BORDER <= column < len(profile.eave) - AT_BORDER:  # it goes on beyond the photo
        foot, top = (line[column] + BEYOND * (line[-end] - line[end - 1]) for line in (profile.eave, profile.ridge))
    return RoofEnd(foot, top, _up(foot, points), [], _is_upright(profile, shown, end))


def _up(pixel: Float, points: Float) -> Float:
    """(2,) unit, upright in the photo at a pixel."""
    up = directions_to(pixel, points[UP])
    return up * (-1.0 if up[1] > 0 else 1.0)


def _along(profile: Profile, shown: Shown, end: int) -> float:
    """The place along the wall of the left or right end of what is seen of it."""
    ray = shown.rays(profile.eave[(profile.first, profile.last)[end]])
    return float(profile.wall.along_of(ray))


def _line(profile: Profile, raw: Float, shown: Shown, end: int) -> tuple[Float | None, Float | None]:
    """Foot and top (2,) px of the line that ends a roof; None where there is none."""
    width = shown.view.camera.width
    place = profile.ends[end]
    wall = (profile.first, profile.last)[end]
    eave, ridge = profile.eave[[0, -1]], profile.ridge[[0, -1]]
    axes = shown.view.rotation @ np.array([np.eye(3)[UP], profile.wall.normal]).T
    length = lengths(raw[:, 1] - raw[:, 0])
    sine = angles_to(raw, vanishing_points(shown.view.camera.matrix, axes)).min(axis=0)
    along = (eave[1] - eave[0]) / lengths(eave[1] - eave[0])
    turn = np.abs(_cross(along, raw[:, 1] - raw[:, 0])) / np.maximum(length, 1e-9)
    chosen = raw[(length >= LEAST_PIECE * width) & (sine > ALONG) & (turn > LEAST_TURN)]
    if len(chosen) == 0:
        return None, None
    feet, tops = _meets(chosen, eave), _meets(chosen, ridge)
    near = lengths(tops - profile.ridge[place]) <= AT_RIDGE * width
    outwards = along * (1 if end else -1)
    # A hip begins at the end of the wall, a verge below the end of the ridge: a wall may go on there as that of a house
    # beside it.
    beyond = (feet - profile.eave[place]) @ outwards
    last = max(float((profile.eave[wall] - profile.eave[place]) @ outwards), 0.0)
    outside = HIDDEN_EAVE if _is_hidden(profile, shown, end) else AT_EAVE
    near &= (beyond >= -AT_EAVE * width) & (beyond <= last + outside * width)
    best, covered = None, COVERED
    for row in np.flatnonzero(near).tolist():
        seen = _seen(profile, shown, _may_be(profile, shown, end, feet[row]))
        share, own = _covered(np.stack([feet[row], tops[row]]), raw, length, shown, seen)
        if share > covered:
            best, covered = _fitted(raw[own]), share
    return (None, None) if best is None else (_meets(best[None], eave)[0], _meets(best[None], ridge)[0])


def _fitted(segments: Float) -> Float:
    """Two points (2, 2) px of the line that runs best through the ends of segments (N, 2, 2), as these are long."""
    weight = np.repeat(lengths(segments[:, 1] - segments[:, 0]), 2)
    points = segments.reshape(-1, 2)
    middle = weight @ points / weight.sum()
    along = np.linalg.svd((points - middle) * np.sqrt(weight)[:, None])[2][0]
    return np.stack([middle, middle + along])


def _meets(segments: Float, line: Float) -> Float:
    """(N, 2) px, where segments (N, 2, 2), drawn out, meet a line (2, 2)."""
    step, along = segments[:, 1] - segments[:, 0], line[1] - line[0]
    share = _cross(segments[:, 0] - line[0], step) / _cross(along, step)
    return np.asarray(line[0] + share[:, None] * along)


def _seen(profile: Profile, shown: Shown, likely: tuple[End, ...]) -> Int:
    """Labels that do not hide such an end: beyond a valley the next wall's roof is seen."""
    surfaces, wall = shown.labels.surfaces, profile.wall
    beyond = [k for k, surface in enumerate(surfaces) if surface.axis == wall.along and likely == ("valley",)]
    return np.array([*wall.numbers, *beyond, shown.labels.sky, shown.labels.clutter])


def _covered(line: Float, raw: Float, length: Float, shown: Shown, seen: Int) -> tuple[float, Bool]:
    """Share of what is seen of a line (2, 2), foot and top, on which segments lie, and which they are (N,)."""
    foot, top = line
    width = shown.view.camera.width
    size = float(lengths(top - foot))
    if size < LEAST_PIECE * width:
        return 0.0, np.zeros(len(raw), bool)
    along = (top - foot) / size
    beside = _cross(along, raw - foot)
    reach = ON_LINE * shown.pixel
    own = (np.abs(beside) < reach).all(axis=1) & (np.abs(beside[:, 1] - beside[:, 0]) < ASTRAY * length)
    places = np.sort((raw[own] - foot) @ along / size, axis=1)
    own[own] = (places[:, 1] > 0) & (places[:, 0] < 1)
    steps = (np.arange(STEPS) + 0.5) / STEPS
    covered: Bool = np.asarray(((places[:, :1] <= steps) & (steps <= places[:, 1:])).any(axis=0))
    pixels = foot + steps[:, None] * (top - foot)
    hidden = ~np.isin(shown.at(shown.label, pixels), seen)
    size_of_photo = [width, shown.view.camera.height]
    hidden |= ((pixels < 0) | (pixels > size_of_photo)).any(axis=1)
    share = (covered & ~hidden).sum() / max((~hidden).sum(), 1)
    return float(share if (~hidden).mean() >= LEAST_SEEN else 0.0), own


def _may_be(profile: Profile, shown: Shown, end: int, foot: Float) -> tuple[End, ...]:
    """What the end of a roof that begins at `foot` (2,) px may be, by the wall beside the one below it."""
    wall, column = profile.wall, (profile.first - OUTSIDE, profile.last + OUTSIDE)[end]
    if not 0 <= column < len(profile.eave):
        return ("verge", "hip")
    points = vanishing_points(shown.view.camera.matrix, shown.view.rotation)
    down = -_up(profile.eave[column], points) * shown.raster.step
    pixels = profile.eave[column] + np.arange(FOOT.start, 2 * FOOT.stop)[:, None] * down
    beside = np.bincount(shown.at(shown.label, pixels)).argmax()
    surfaces = shown.labels.surfaces
    if beside >= len(surfaces) or surfaces[beside].axis != wall.along:
        return ("verge", "hip")
    ray, at_foot = shown.rays(np.stack([pixels[len(pixels) // 2], foot]))
    corner = surfaces[beside].offset
    beyond = directions_of(shown.view.turns)[surfaces[beside].axis]
    is_here = abs(wall.point(at_foot) @ beyond - corner) < AT_CORNER * abs(wall.offset)
    is_before = abs(corner * (ray @ wall.normal) / (ray @ beyond)) < abs(wall.offset)
    return ("valley",) if is_here and is_before else ("verge", "hip")


def _is_hidden(profile: Profile, shown: Shown, end: int) -> bool:
    """Whether something else than the sky is seen beside the end of a wall, at its eave, or the photo ends there."""
    column = (profile.first - OUTSIDE, profile.last + OUTSIDE)[end]
    if not 0 <= column < len(profile.eave):
        return True
    return not shown.at(shown.sky, profile.eave[column])


def _is_free(profile: Profile, shown: Shown, line: tuple[Float, Float], end: int) -> bool:
    """Whether the sky is seen beside the upper part of the line that ends a roof, foot and top (2,) px.

    Then nothing there cuts the roof off.
    """
    outwards = (1 if end else -1) * (profile.eave[-1] - profile.eave[0])
    outwards = outwards / lengths(outwards) * shown.raster.step
    pixels = line[0] + np.linspace(1 - UPPER, 1, BLURRED)[:, None] * (line[1] - line[0])
    is_sky = shown.at(shown.sky, pixels + (BLURRED + BESIDE) * outwards)
    is_sky |= shown.at(shown.label, pixels + 2 * BESIDE * outwards) == shown.labels.sky
    return bool(is_sky.mean() > FREE)


def _is_upright(profile: Profile, shown: Shown, end: int) -> bool:
    """Whether the sky is seen beside an end of a ridge down to the eave, and a usual roof would not end there."""
    way = 1 if end else -1
    place = profile.ends[end]
    beside: Int = place + way * np.arange(1, OUTSIDE + 1)
    if beside.min() < 0 or beside.max() >= len(profile.eave):
        return False
    share = np.linspace(0, 1, 2 * BLURRED)[BESIDE:-BESIDE, None, None]
    between = profile.eave[beside] + share * (profile.ridge[beside] - profile.eave[beside])
    if shown.at(shown.sky, between).mean() < 1 / 2:
        return False
    wall, view = profile.wall, shown.view
    start = wall.point(shown.rays(profile.eave[place]))
    depth = (profile.high - profile.low) / max(np.tan(USUAL) - profile.high / abs(wall.offset), 1e-9)
    back = np.sign(wall.offset) * wall.normal
    rise = start + depth * (back + np.tan(USUAL) * np.eye(3)[UP])
    usual = project(rise, view.camera.matrix, view.rotation)
    return bool(lengths(usual - profile.ridge[place]) > MOST_BESIDE * view.camera.width)


def _cross(one: Float, other: Float) -> Float:
    """Cross products (...) of vectors (..., 2) of the photo."""
    product: Float = one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
    return product
