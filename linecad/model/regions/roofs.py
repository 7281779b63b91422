"""Roofs: what the photo shows between the eave of a wall and the sky, where it is another thing than the wall.

An eave is a level line of a wall with another colour above it than below, and nothing but sky above that: the sky
begins at one height, the ridge. Both ends are looked for at the ends of the ridge. A line from there to the eave tells
the slope (`linecad.model.regions.slopes`); where none does, it is the usual one, and the scene says so.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Float, Int
from linecad.directions import UP, Turns, directions_of
from linecad.geometry import angles_to, lengths, vanishing_points
from linecad.model.regions import partition
from linecad.model.regions.bearings import Bearing, bearing_of
from linecad.model.regions.columns import FOOT, look_over
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.labels import Labels
from linecad.model.regions.profiles import Profile, Shown, Wall, walls_of
from linecad.model.regions.raster import Raster
from linecad.model.regions.roof_ends import RoofEnd, find_end
from linecad.model.regions.segments import View
from linecad.model.regions.slopes import USUAL, slope_of

LEAST_LINE = 0.03  # of the photo's width, of an eave
LEVEL = np.sin(np.radians(1.5))  # of a segment, against the direction of a wall: it may be an eave
MOST_LINES = 12  # of one wall that are tried as its eave, the longest
SAME = 0.004  # of a wall's offset; lines whose heights differ by less are one
NEAR = (-9, 5)  # samples above and below the middle of an eave, where its wall is
LEAST_WALL = 0.005  # of the photo
LEAST_RISE, LEAST_SHARE = 6.0, 0.1  # samples from eave to ridge, and the share of that in the wall below
MOST_RISE = 1.5  # times the wall below, as far as that is looked at, from eave to ridge
LEAST_CONTRAST = 0.45  # bits, of the colours of roof and wall
NEARLY = 0.85  # of the most contrast above a wall; lines with so much part it too
LEAST_BEFORE_SKY = 0.7  # bits, of those of roof and sky: roofs have 0.97 and more, clouds taken for walls 0.46
MOST_UPRIGHTS = 0.2  # pixels of upright edges a sample of a roof: dormers have some, storeys of a wall more
MOST_PLANTS = 0.2  # of what is above the eave
LEAST_SEEN = 0.5  # of the columns below a ridge, of those in which nothing hides what is above the wall
SAME_STRETCH = 0.5  # of the narrower of two ridges along one wall, above both of which the other is
LEAST_GUESSED = 0.25  # of the height of the wall below, of what no end tells to be a roof: parapets are less
LEAST_OF_WALL = 0.5  # of the columns of a wall, above which such a ridge is: part of a wall may be of another colour
SEEN_AT = np.tan(np.radians(32.0))  # of a slope that a roof must be seen at up to its ridge, for the usual one
GRAZING = 0.95  # of the tangent of its slope, at which a roof is hardly seen
LEAST_AREA = 0.0015  # of the photo, as of other faces
MOST_SHARED = 0.1  # of the smaller of two roofs
PAST = 0.25  # of a roof's height, below and above the eave, of an upright that goes on above it
BESIDE = (-6, 6)  # samples beside such an upright, on one of which its wall is: borders of labels are no nearer to it
HOOD = 2.0  # times the photo's height, up to where nothing above an eave is its wall


@dataclass(frozen=True, eq=False)
class Sketch:
    """What a photo shows beside the lines of the scene."""

    raw: Float  # (N, 2, 2) px, segments along whatever direction
    whole: Float  # (M, 2, 2) px, whole lines along the directions, also those that have no place in space
    axis: Int  # (M,) of these


@dataclass(frozen=True, eq=False)
class Roof:
    """A sloped plane and the part of the photo that shows it."""

    axis: int  # level axis of its wall, nearest to the direction across the eave
    slope: float  # rad, of what rises in it from `axis` towards the upright, 0 to pi
    eave: Float  # (3,) a point of it, world
    polygon: shapely.Geometry  # px, what the photo shows of it
    hood: shapely.Geometry  # px, where nothing is the wall below it
    walls: tuple[int, ...]  # numbers of the surfaces that are this wall
    is_told: bool  # by its ends; else it is the usual one

    @property
    def tilt(self) -> float:
        """Of its normal, which looks up, rad, as of `linecad.scene.Plane`."""
        return (self.slope + np.pi / 2) % np.pi

    def normal(self, turns: Turns) -> Float:
        """(3,) unit, up, in the world of a scene whose further frames have such turns."""
        upright = np.eye(3)[UP]
        level: Float = directions_of(turns)[self.axis]
        normal: Float = np.cos(self.tilt) * level + np.sin(self.tilt) * upright
        return normal


def find_roofs(sketch: Sketch, labels: Labels, heaven: Heaven, raster: Raster, view: View) -> tuple[Roof, ...]:
    """The roofs of a photo, none of which cover another; those that differ most from their walls come first."""
    if not heaven.is_sky or len(sketch.whole) == 0:
        return ()
    shown = Shown(raster, view, labels, heaven.seed.reshape(raster.shape))
    walls = [wall for wall in walls_of(shown) if wall.is_shown.mean() >= LEAST_WALL]
    profiles = [profile for wall in walls for profile in _profiles(wall, sketch, shown)]
    profiles.sort(key=lambda each: -each[0].contrast)
    found = [_sketched(profile, bearing, sketch, shown) for profile, bearing in profiles]
    best: list[_Sketched] = []
    for each in found:
        if each is not None and all(each.overlaps(other) < MOST_SHARED for other in best):
            best.append(each)
    roofs: list[Roof] = []
    for each in best:
        roofs += _cut_out(each, [other for other in best if other is not each], roofs, sketch, shown)
    return tuple(roofs)


def notes_on(roofs: Iterable[Roof]) -> tuple[str, ...]:
    """How sure the slopes of roofs are, for people."""
    guessed = sum(not roof.is_told for roof in roofs)
    if not guessed:
        return ()
    are = "1 roof is given" if guessed == 1 else f"{guessed} roofs are given"
    usual = f"a usual slope of {np.degrees(USUAL):.0f} degrees"
    return (f"faces: {are} {usual}: the photo shows no end of it that would tell",)


def _profiles(wall: Wall, sketch: Sketch, shown: Shown) -> list[tuple[Profile, Bearing]]:
    """What is above the lines of a wall that may be eaves, as these and their ridges run."""
    lines = _eaves(wall, sketch, shown)
    looks = [(each, pixel) for pixel in lines for each in look_over(wall, pixel, shown) if _may_be_roof(each)]
    looks.sort(key=lambda look: -look[0].contrast)
    found = []
    while looks:
        most = looks[0][0]
        own = [look for look in looks if most.shares(look[0]) > SAME_STRETCH]
        looks = [look for look in looks if most.shares(look[0]) <= SAME_STRETCH]
        # Cornices are unlike both: of lines that part nearly as well, the highest is where the roof begins.
        likely = [look for look in own if look[0].contrast >= NEARLY * most.contrast]
        found.append(_as_it_runs(*max(likely, key=lambda look: look[0].low), sketch, shown))
    return found


def _as_it_runs(profile: Profile, pixel: Float, sketch: Sketch, shown: Shown) -> tuple[Profile, Bearing]:
    """A profile above a line of a wall, turned as this and its ridge run, and how surely they run so."""
    bearing = bearing_of(profile, sketch.raw, shown)
    if bearing.turn:
        again = look_over(profile.wall.turned(bearing.turn, pixel, shown), pixel, shown)
        again = [each for each in again if _may_be_roof(each) and profile.shares(each) > SAME_STRETCH]
        if again:
            profile = max(again, key=lambda each: each.is_ridge.sum())
            bearing = replace(bearing_of(profile, sketch.raw, shown), turn=0.0)
    return profile, bearing


def _eaves(wall: Wall, sketch: Sketch, shown: Shown) -> list[Float]:
    """Pixels (2,) of lines of the photo along a wall, above the camera and at its samples, one of each height."""
    view, width = shown.view, shown.view.camera.width
    points = vanishing_points(view.camera.matrix, (view.rotation @ wall.direction)[:, None])
    (sine,) = angles_to(sketch.raw, points)
    segments = np.concatenate([sketch.whole[sketch.axis == wall.along], sketch.raw[sine < LEVEL]])
    length = lengths(segments[:, 1] - segments[:, 0])
    rows = np.flatnonzero(length >= LEAST_LINE * width)
    segments = segments[rows[np.argsort(-length[rows], kind="stable")]]
    middle = segments.mean(axis=1)
    rays = shown.rays(middle)
    height = wall.heights(rays)
    around = middle[:, None] - np.arange(*NEAR)[:, None] * shown.raster.step * np.array([0.0, 1.0])
    near = shown.at(wall.is_shown, around).any(axis=1)
    before = wall.is_ahead(rays) & (height > 0) & near
    kept: list[int] = []
    for row in np.flatnonzero(before).tolist():
        if all(abs(height[row] - height[other]) > SAME * abs(wall.offset) for other in kept):
            kept.append(row)
    return [middle[row] for row in kept[:MOST_LINES]]


def _may_be_roof(profile: Profile) -> bool:
    """Whether what is above a line is another thing than the wall, and no more storeys."""
    first, last = profile.ends
    above_wall = min(last, profile.last) - max(first, profile.first) + 1
    is_seen = profile.is_open.sum() >= LEAST_SEEN * above_wall
    return bool(
        is_seen
        and max(LEAST_RISE, LEAST_SHARE * profile.depth) <= profile.rise <= MOST_RISE * profile.depth
        and profile.contrast >= LEAST_CONTRAST
        and profile.before_sky >= LEAST_BEFORE_SKY
        and profile.uprights[0] <= MOST_UPRIGHTS
        and profile.plants <= MOST_PLANTS
    )


@dataclass(frozen=True, eq=False)
class _Sketched:
    """A roof before what stands before it in the photo is cut out."""

    profile: Profile
    slope: float  # rad above the level
    is_told: bool
    outline: shapely.Polygon  # px
    hood: shapely.Geometry  # px

    def overlaps(self, other: "_Sketched") -> float:
        """Share of the smaller of two outlines that both cover."""
        one, another = self.outline, other.outline
        return float(shapely.intersection(one, another).area / min(one.area, another.area))


def _sketched(profile: Profile, bearing: Bearing, sketch: Sketch, shown: Shown) -> _Sketched | None:
    """The roof of a profile whose eave has a bearing; None where it could not be seen so."""
    left, right = (find_end(profile, sketch.raw, shown, end, bearing) for end in (0, 1))
    told = slope_of(left.slopes, right.slopes)
    seen_at = profile.high / abs(profile.wall.offset)
    is_low = profile.high - profile.low < LEAST_GUESSED * (profile.low - profile.wall.foot(shown))
    is_unlike = seen_at > SEEN_AT or is_low or profile.of_wall < LEAST_OF_WALL or any(profile.goes_on)
    if left.is_upright or right.is_upright or (told is None and is_unlike):
        return None
    slope = USUAL if told is None else told
    outline = shapely.Polygon(np.array([left.foot, left.top, right.top, right.foot]))
    if seen_at > GRAZING * np.tan(slope) or not outline.is_valid:
        return None
    return _Sketched(profile, slope, told is not None, outline, _hood(left, right, outline, shown))


def _cut_out(own: _Sketched, others: list[_Sketched], before: list[Roof], sketch: Sketch, shown: Shown) -> list[Roof]:
    """The roof without what stands before it: other walls up to their eaves; none where too little is left."""
    wall, labels, camera = own.profile.wall, shown.labels, shown.view.camera
    carrier = _carrier(own.profile, shown)
    rising = _rising(own.profile, sketch, shown) - {carrier}
    numbers = tuple(number for number in wall.numbers if number not in rising)
    hidden = shapely.union_all(
        [region for number, region in labels.regions if number < labels.sky and number not in numbers]
    )
    hidden = shapely.difference(hidden, shapely.union_all([other.hood for other in others]))
    taken = shapely.union_all([hidden, *(roof.polygon for roof in before)])
    pieces = shapely.intersection(shapely.difference(own.outline, taken), _frame(shown))
    kept = partition.polygons_of(pieces, LEAST_AREA * camera.width * camera.height)
    if not kept:
        return []
    slope = own.slope if wall.offset > 0 else np.pi - own.slope
    below, ray = labels.surfaces[carrier], shown.rays(own.profile.eave[own.profile.middle])
    eave = ray * below.offset / (ray @ directions_of(shown.view.turns)[below.axis])
    hood = shapely.difference(own.hood, hidden)
    return [Roof(wall.axis, float(slope), eave, shapely.union_all(kept), hood, numbers, own.is_told)]


def _carrier(profile: Profile, shown: Shown) -> int:
    """The surface of a wall that is seen right below an eave: a cornice may stand before the rest of the wall."""
    first, last = profile.ends
    eave = profile.eave[first : last + 1]
    below = shown.at(shown.label, eave + FOOT.start * shown.raster.step * np.array([0.0, 1.0]))
    count = np.bincount(below, minlength=len(shown.labels.surfaces))
    return max(profile.wall.numbers, key=lambda number: int(count[number]))


def _rising(profile: Profile, sketch: Sketch, shown: Shown) -> set[int]:
    """The surfaces of a wall of which an upright edge goes on above the eave: of a tower a little before it, a gable.

    A lamp or a window before one is no edge of it: the surface is on both sides of that.
    """
    wall, uprights = profile.wall, sketch.whole[sketch.axis == UP]
    rays = shown.rays(uprights)
    heights = wall.heights(rays)
    past = PAST * (profile.high - profile.low)
    crosses = (heights.min(axis=1) < profile.low - past) & (heights.max(axis=1) > profile.low + past)
    crosses &= wall.is_ahead(rays).all(axis=1)
    uprights, rays, heights = uprights[crosses], rays[crosses], heights[crosses]
    above = wall.offset * rays[..., UP] - profile.low * (rays @ wall.normal)  # linear in pixels, 0 at the eave
    share = above[:, 0] / (above[:, 0] - above[:, 1])
    at = uprights[:, 0] + share[:, None] * (uprights[:, 1] - uprights[:, 0])
    top = np.take_along_axis(uprights, heights.argmax(axis=1)[:, None, None], 1)[:, 0]
    places = np.stack([at, (at + top) / 2], axis=1)
    beside = places[:, :, None] + np.array(BESIDE)[:, None] * shown.raster.step * np.array([1.0, 0.0])
    labels = shown.at(shown.label, beside)  # (N, 2 places, 2 sides)
    return {number for number in wall.numbers if ((labels == number).sum(axis=2) == 1).all(axis=1).any()}


def _frame(shown: Shown) -> shapely.Polygon:
    camera = shown.view.camera
    return shapely.box(-0.5, -0.5, camera.width - 0.5, camera.height - 0.5)


def _hood(left: RoofEnd, right: RoofEnd, outline: shapely.Polygon, shown: Shown) -> shapely.Geometry:
    """All that is above an eave and between its ends, px."""
    reach = HOOD * shown.view.camera.height
    corners = [left.foot, left.foot + reach * left.up, right.foot + reach * right.up, right.foot]
    return shapely.union_all([shapely.make_valid(shapely.Polygon(np.array(corners))), outline])
