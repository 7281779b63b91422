"""Sloped planes: where an eave, a ridge before the sky and the verge between them outline a part of the photo.

The eave is a line of the scene. A roof's verge lies in the upright plane across it, so that the eave's place and the
verge's image give the slope and the height of the ridge, whose own place nothing else tells (docs/method.md).
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from linecad.arrays import Bool, Float, Int
from linecad.directions import UP, Turns, components, directions_of, partner
from linecad.geometry import angles_to, depths_beside, lengths, vanishing_points, world_rays
from linecad.model.regions.evidence import Heaven
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import View
from linecad.scene import Lines

LONGEST_GAP = 0.012  # of the photo's width, between the end of a line and the verge that meets it
LEAST_LINE = 0.03  # of the photo's width, of an eave and of a ridge
LEAST_VERGE, LEAST_PIECE = 0.02, 0.012  # of the photo's width, of a verge and of the longest segment on it
LEAST_AREA = 0.0015  # of the photo, as of other faces
COVERED = 0.6  # of a verge, by segments
UNCOVERED_COST = 2.0  # of a part of a verge without a segment, against one with
BESIDE = 2.0  # px at NORMAL_WIDTH; a segment so near to a verge is on it
NORMAL_WIDTH = 1280.0  # px
ASTRAY = np.sin(np.radians(4.0))  # of a segment on a verge
LEAST_TURN = np.sin(np.radians(7.0))  # in the photo, between a verge and the eave
FLATTEST, STEEPEST = np.radians(10.0), np.radians(75.0)
ABOVE = 0.012  # of the photo's width above a ridge, where the sky is
SKY_ABOVE, SKY_INSIDE = 0.6, 0.2  # shares of what is looked at
ALONG = np.sin(np.radians(3.0))  # of a segment, against the upright
SHIFT, UNSURE = 1.0, np.radians(5.0)  # px at NORMAL_WIDTH by which the end of a verge may err, and what it may change
MOST_LONGER = 3.0  # times the length of the ridge or the eave, of the other
ALIKE = np.radians(30.0)  # largest difference of the slopes by the two verges: 36 degrees for a frame that is 14 off
PLACES = np.linspace(0.1, 0.9, 9)  # along a ridge
STEPS = 100  # in which coverage is counted
MOST_SHARED = 0.1  # of the smaller of two roofs
SAME_ROOF = 0.7  # of the larger of two outlines, that both cover
SURE = ("proven", "supported")  # confidence of an eave that a single verge goes with


@dataclass(frozen=True, eq=False)
class Sketch:
    """What a photo shows beside the lines of the scene."""

    raw: Float  # (N, 2, 2) px, segments along whatever direction
    whole: Float  # (M, 2, 2) px, whole lines along the directions, also those that have no place in space
    axis: Int  # (M,) of these


@dataclass(frozen=True, eq=False)
class Roof:
    """A sloped plane and the part of the photo that shows it."""

    axis: int  # level direction across the eave
    slope: float  # rad, of what rises in it from `axis` towards the upright, 0 to pi
    eave: Float  # (3,) a point of it, world
    outline: Float  # (4, 2) px: verge at the eave, verge at the ridge, other end of the ridge, of the eave
    line: int  # row of its eave among the scene's lines
    score: float  # px of verge on which segments lie, less what they leave free, weighed
    has_both: bool = False  # verges

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

    @property
    def polygon(self) -> shapely.Polygon:
        """The outline, px."""
        return shapely.Polygon(self.outline)


def find_roofs(sketch: Sketch, lines: Lines, heaven: Heaven, raster: Raster, view: View) -> tuple[Roof, ...]:
    """The roofs of a photo, none of which cover another; those of the longest verges come first."""
    if not heaven.is_sky or len(sketch.raw) == 0:
        return ()
    finder = _Finder(sketch, lines, heaven.seed.reshape(raster.shape), raster, view)
    found = [roof for row in np.flatnonzero(lines.axis != UP).tolist() for roof in finder.over(row)]
    sure = [
        roof
        for roof in (*found, *_with_both_verges(found))
        if roof.has_both or str(lines.confidence[roof.line]) in SURE
    ]
    best: list[Roof] = []
    for roof in sorted(sure, key=lambda each: -each.score):
        area = roof.polygon
        others = [each.polygon for each in best]
        if all(area.intersection(each).area < MOST_SHARED * min(area.area, each.area) for each in others):
            best.append(roof)
    return tuple(best)


def _with_both_verges(found: list[Roof]) -> list[Roof]:
    """One roof for each two that the two verges of one eave give; its slope is their mean.

    Along a direction that is turned a little off the house, one verge seems steeper by as much as the other flatter.
    """
    joined = []
    for number, roof in enumerate(found):
        for other in found[:number]:
            one, another = roof.polygon, other.polygon
            shared = one.intersection(another).area / max(one.area, another.area)
            is_same = roof.line == other.line and shared >= SAME_ROOF
            across_it = np.linalg.norm(roof.outline[0] - other.outline[3]) < np.linalg.norm(
                roof.outline[0] - other.outline[0]
            )
            if is_same and across_it and abs(roof.slope - other.slope) < ALIKE:
                slope, score = (roof.slope + other.slope) / 2, roof.score + other.score
                joined.append(replace(max(roof, other, key=_score), slope=slope, score=score, has_both=True))
    return joined


def _score(roof: Roof) -> float:
    return roof.score


@dataclass(frozen=True, eq=False)
class _Straight:
    """A line of the photo with two ends."""

    start: Float  # (2,) px
    along: Float  # (2,) unit
    length: float  # px

    @staticmethod
    def of(ends: Float) -> "_Straight":
        """Through two ends (2, 2) px."""
        length = float(np.linalg.norm(ends[1] - ends[0]))
        return _Straight(ends[0], (ends[1] - ends[0]) / length, length)

    @property
    def ends(self) -> Float:
        """(2, 2) px."""
        return np.stack([self.start, self.start + self.length * self.along])

    def places_of(self, others: Float) -> tuple[Float, Float]:
        """Where lines (N, 2, 2) px meet it, px from its start, NaN of parallel ones; sines (N,) of the angles."""
        step = others[:, 1] - others[:, 0]
        sine = _cross(self.along, step) / lengths(step)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(sine == 0, np.nan, _cross(others[:, 0] - self.start, step) / _cross(self.along, step)), sine

    def end_at(self, places: Float) -> tuple[Int, Float]:
        """The end, 0 or 1, that places (N,) are nearest to, and how far away it is, px."""
        off = np.abs(np.stack([places, places - self.length]))
        return off.argmin(axis=0), np.nan_to_num(off.min(axis=0), nan=np.inf)


@dataclass(frozen=True, eq=False)
class _Meets:
    """Where P segments meet a line."""

    place: Float  # (P,) px from its start
    end: Int  # (P,) that is nearest to it, 0 or 1
    is_met: Bool  # (P,) near to that end, and at an angle


@dataclass(frozen=True, eq=False)
class _Ridge:
    """A level line with the sky above it."""

    axis: int
    line: _Straight
    meets: _Meets


class _Finder:
    """The search in one photo."""

    def __init__(self, sketch: Sketch, lines: Lines, sky: Bool, raster: Raster, view: View) -> None:
        self.lines, self.sky, self.raster, self.view = lines, sky, raster, view
        self.width = view.camera.width
        length = lengths(sketch.whole[:, 1] - sketch.whole[:, 0])
        places = sketch.whole[:, :1] + PLACES[None, :, None] * (sketch.whole[:, 1:] - sketch.whole[:, :1])
        is_top = self._is_sky(places - [0.0, ABOVE * self.width]).mean(axis=1) > SKY_ABOVE
        chosen = (length >= LEAST_LINE * self.width) & is_top & (sketch.axis != UP)
        (sine,) = angles_to(sketch.raw, vanishing_points(view.camera.matrix, view.rotation[:, UP:]))
        self.raw = sketch.raw[sine > ALONG]  # the corner of a wall is no verge
        self.length = lengths(self.raw[:, 1] - self.raw[:, 0])
        self.pieces = self.raw[self.length >= LEAST_PIECE * self.width]
        self.ridges = [
            _Ridge(int(axis), _Straight.of(ends), self._meets(_Straight.of(ends)))
            for axis, ends in zip(sketch.axis[chosen], sketch.whole[chosen], strict=True)
        ]

    def _meets(self, line: _Straight) -> "_Meets":
        """Where the pieces of verges meet a line at one of its ends."""
        place, sine = line.places_of(self.pieces)
        end, off = line.end_at(place)
        return _Meets(place, end, (off <= LONGEST_GAP * self.width) & (np.abs(sine) >= LEAST_TURN))

    def _is_sky(self, pixels: Float) -> Bool:
        """Which pixels (..., 2) are sky for sure; outside the photo that of its border."""
        rows, columns = self.sky.shape
        at = np.rint(self.raster.samples_of(pixels)).astype(np.int64)
        shown: Bool = self.sky[np.clip(at[..., 1], 0, rows - 1), np.clip(at[..., 0], 0, columns - 1)]
        return shown

    def over(self, row: int) -> list[Roof]:
        """The roofs over one line of the scene, a part of which may be the same."""
        axis = int(self.lines.axis[row])
        ridges = [ridge for ridge in self.ridges if ridge.axis == axis]
        ends = self.lines.segment[row]
        if not ridges or np.linalg.norm(ends[1] - ends[0]) < LEAST_LINE * self.width:
            return []
        eave = _Straight.of(ends)
        low = self._meets(eave)
        found = []
        for ridge in ridges:
            for piece in np.flatnonzero(low.is_met & ridge.meets.is_met).tolist():
                foot = eave.start + low.place[piece] * eave.along
                top = ridge.line.start + ridge.meets.place[piece] * ridge.line.along
                far, beyond = eave.ends[1 - low.end[piece]], ridge.line.ends[1 - ridge.meets.end[piece]]
                found.append(self._roof(row, np.stack([foot, top, beyond, far]), self.pieces[piece]))
        return [roof for roof in found if roof is not None]

    def _roof(self, row: int, outline: Float, verge: Float) -> Roof | None:
        """The roof in an outline (4, 2) px, on whose verge a piece (2, 2) px was found; None where none is."""
        foot, top, beyond, far = outline
        size = float(np.linalg.norm(top - foot))
        along = verge[1] - verge[0]
        is_one_side = _cross(along, far - foot) * _cross(along, beyond - top) > 0
        if size < LEAST_VERGE * self.width or top[1] > foot[1] or not is_one_side:
            return None
        polygon = shapely.Polygon(outline)
        if not polygon.is_valid or polygon.area < LEAST_AREA * self.width * self.view.camera.height:
            return None
        covered = self._covered(foot, top)
        inside = (foot + top) / 2 + PLACES[:, None] * ((far + beyond) - (foot + top)) / 2
        if covered < COVERED or self._is_sky(inside).mean() > SKY_INSIDE:
            return None
        return self._placed(row, outline, size * (covered - UNCOVERED_COST * (1 - covered)))

    def _covered(self, foot: Float, top: Float) -> float:
        """Share of a verge on which segments lie."""
        size = float(np.linalg.norm(top - foot))
        along = (top - foot) / size
        beside = _cross(along, self.raw - foot)
        reach = BESIDE * max(self.width / NORMAL_WIDTH, 1.0)
        own = (np.abs(beside) < reach).all(axis=1) & (np.abs(beside[:, 1] - beside[:, 0]) < ASTRAY * self.length)
        places = np.sort((self.raw[own] - foot) @ along / size, axis=1)
        steps = (np.arange(STEPS) + 0.5) / STEPS
        return float(((places[:, :1] <= steps) & (steps <= places[:, 1:])).any(axis=0).mean())

    def _placed(self, row: int, outline: Float, score: float) -> Roof | None:
        """The roof over an eave whose place is known; None where none could be seen so."""
        axis, normal = int(self.lines.axis[row]), int(partner(self.lines.axis[row]))
        turns, rotation = self.raster.turns, self.view.rotation
        rays = world_rays(outline[:1], self.view.camera.matrix, rotation)
        told = components(self.lines.ends[row, :1], turns)
        eave = rays[0] * depths_beside(components(rays, turns), told, np.array([axis]))[0]
        along, level = directions_of(turns)[[axis, normal]]
        reach = SHIFT * max(self.width / NORMAL_WIDTH, 1.0)
        aside = np.array([1.0, -1.0]) * (outline[1] - outline[0])[::-1] / np.linalg.norm(outline[1] - outline[0])
        tops = outline[1] + reach * np.array([[0.0], [-1.0], [1.0]]) * aside
        tops_seen = world_rays(tops, self.view.camera.matrix, rotation)
        # The verge runs in the upright plane across the eave.
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = (along @ eave) / (tops_seen @ along)
            rise = tops_seen * depth[:, None] - eave
        if not ((depth > 0) & np.isfinite(depth)).all():
            return None
        slopes = np.arctan2(rise[:, UP], rise @ level)
        slope = float(slopes[0])
        roof = Roof(normal, slope, eave, outline, row, score)
        if not FLATTEST < min(slope, np.pi - slope) < STEEPEST or np.abs(slopes - slope).max() > UNSURE:
            return None
        return roof if self._is_whole(roof, along) else None

    def _is_whole(self, roof: Roof, along: Float) -> bool:
        """Whether its upper side is seen, and its eave and its ridge are of like lengths."""
        normal = roof.normal(self.raster.turns)
        rays = world_rays(roof.outline, self.view.camera.matrix, self.view.rotation)
        with np.errstate(divide="ignore"):
            depth = (normal @ roof.eave) / (rays @ normal)
        if normal @ roof.eave > 0 or not ((depth > 0) & np.isfinite(depth)).all():
            return False
        foot, top, beyond, far = (rays * depth[:, None]) @ along
        return bool(max(abs(beyond - top), abs(far - foot)) < MOST_LONGER * min(abs(beyond - top), abs(far - foot)))


def _cross(one: Float, other: Float) -> Float:
    """Cross products (...) of vectors (..., 2) of the photo."""
    product: Float = one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
    return product
