"""Windows and doors of the walls of a scene, found in the photo and put where its lines are.

Each wall is looked at straight on (`raster`). Rectangles that edges close (`rectangles`) and those that rows and
columns ask for (`lattice`) are judged (`pool`) by what the photo shows in and around them (`evidence`) and by how they
lie to the others (`neighbours`). The best set of which no two overlap is taken (`choice`), and gaps in its rows and
columns are filled (`gaps`). That tells where the photo shows which walls (`shown`), before anything else is known of
it. Once faces are, the best set is taken anew, of those where no face of another axis is, and made regular (`regular`);
then windows of one size tell together how deep their panes are (`recess`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.depth.normals import UNTOLD
from linecad.directions import frame_axes
from linecad.model.openings.choice import Choice, choose, not_overlapping
from linecad.model.openings.gaps import are_beside_clearer, are_odd, find_gaps, may_be
from linecad.model.openings.homes import axes_shown
from linecad.model.openings.odds import LEAST_LOG_ODDS
from linecad.model.openings.pool import Pool, build_pool
from linecad.model.openings.raster import Raster, build_raster, look
from linecad.model.openings.recess import depth_ratios
from linecad.model.openings.regular import Seen, make_regular
from linecad.model.openings.shown import WallShown, walls_shown
from linecad.model.openings.walls import Wall, find_walls
from linecad.scene import Camera, Lines, Opening, Plane

PLACES = ((0.5, 0.5), (0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75))  # in a rectangle, where faces are asked
SEEN_COVER = 1.2  # of the four sides in sum: with less, an opening was not seen


@dataclass(frozen=True, eq=False)
class FrameView:
    """What is seen along the axes of one frame, in which its walls stand along x and y."""

    planes: tuple[Plane, ...]
    lines: Lines
    rotation: Float  # (3, 3) frame to camera
    frame: int  # its number


@dataclass(frozen=True, eq=False)
class _Likely:
    """Rectangles of a wall that are likely openings."""

    wall: Wall
    view: FrameView  # of the wall
    raster: Raster
    box: Int  # (N, 4)
    log_odds: Float  # (N,)
    evidence: Float  # (N, F)
    pool: Pool

    def chosen(self, which: Bool | Int) -> "_Likely":
        """The same with those of its rectangles alone."""
        return replace(self, box=self.box[which], log_odds=self.log_odds[which], evidence=self.evidence[which])

    @property
    def axis(self) -> int:
        """The direction along which the wall faces."""
        return frame_axes(self.view.frame)[self.wall.plane.axis]

    def shapes(self) -> list[shapely.Polygon]:
        """The rectangles in the photo."""
        return shapes_of(self.wall, self.raster, self.box)


@dataclass(frozen=True, eq=False)
class _Taken:
    """The best set of likely rectangles, wall by wall."""

    walls: list[_Likely]
    notes: tuple[str, ...]  # for people


@dataclass(frozen=True, eq=False)
class SeenWalls:
    """The walls of a scene, looked at straight on, with the rectangles that are likely openings."""

    likely: tuple[_Likely, ...] = ()
    taken: _Taken = field(default_factory=lambda: _Taken([], ()))  # as seen from outdoors, wherever faces are
    looked_at: frozenset[int] = frozenset()  # ids of the planes in which they were seen

    @property
    def shown(self) -> tuple[WallShown, ...]:
        """Where the photo shows which walls, by their openings."""
        return tuple(
            shown
            for own in self.taken.walls
            for shown in walls_shown(own.axis, own.raster, own.box, partial(shapes_of, own.wall))
        )


@dataclass(frozen=True, eq=False)
class Found:
    """The openings of a scene."""

    openings: tuple[Opening, ...] = ()
    notes: tuple[str, ...] = ()  # for people


def shapes_of(wall: Wall, raster: Raster, box: Int) -> list[shapely.Polygon]:
    """Rectangles (N, 4) of a wall in the photo."""
    u, v = raster.u[box[:, :2]], raster.v[box[:, 2:]]
    corners = np.stack([np.column_stack([u[:, i], v[:, j]]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))], axis=1)
    return list(shapely.polygons(wall.pixels(corners)))


def look_at_walls(
    frames: Sequence[FrameView], camera: Camera, pixels: NDArray[np.uint8] | None, before: SeenWalls | None = None
) -> SeenWalls:
    """The vertical planes, frame by frame in the order of their planes, and what may be openings in them.

    `frames` has one of them at least, the main one first; without pixels (H, W, 3) of the photo nothing is seen. Planes
    that were looked at `before` are not looked at again.
    """
    before = before or SeenWalls()
    if pixels is None:
        return before
    walls = [
        (wall, view)
        for view in frames
        for wall in find_walls(view.planes, view.lines, camera, view.rotation)
        if wall.plane.id not in before.looked_at
    ]
    if not walls:
        return before
    sight, likely = look(pixels), list(before.likely)
    for wall, view in walls:
        raster = build_raster(wall, sight)
        one = None if raster is None else _likely(wall, view, raster)
        if one is not None and may_be(one.log_odds, one.evidence, is_inside=False).any():
            likely.append(one)
    looked_at = before.looked_at | {wall.plane.id for wall, _ in walls}
    return SeenWalls(tuple(likely), _take(likely, is_inside=False), looked_at)


def find_openings(seen: SeenWalls, planes: tuple[Plane, ...], camera: Camera, rotation: Float) -> Found:
    """The openings of walls, in the axes of their frames, where no face of the `planes` faces another way.

    `rotation` (3, 3) takes world to camera.
    """
    is_inside = any(face.kind == "ceiling" for plane in planes for face in plane.faces)
    taken = _take(seen.likely, is_inside, partial(_at_home, axes_at=axes_shown(planes, camera, rotation)))
    ground = _ground_height(planes)
    openings: list[Opening] = []
    for likely in taken.walls:
        if len(likely.box):
            box = likely.box
            about = Seen(
                np.column_stack([likely.raster.u[box[:, :2]], likely.raster.v[box[:, 2:]]]),
                np.column_stack(
                    [
                        np.diff(likely.raster.u)[box[:, 0].clip(max=len(likely.raster.u) - 2)],
                        np.full(len(box), likely.raster.v[1] - likely.raster.v[0]),
                    ]
                ),
                likely.pool.edges.cover(box).sum(axis=1) < SEEN_COVER,
            )
            regular = make_regular(likely.wall, likely.view.lines, about, len(openings), ground)
            openings += _with_recess(regular, likely)
    return Found(tuple(openings), taken.notes or seen.taken.notes)


def _everywhere(likely: _Likely) -> _Likely:
    return likely


def _at_home(likely: _Likely, axes_at: Callable[[Float], Int]) -> _Likely:
    """Those on which the photo shows no wall of another axis: else they compete with the openings that are there."""
    box, raster = likely.box, likely.raster
    (u0, u1), (v0, v1) = raster.u[box[:, :2]].T, raster.v[box[:, 2:]].T
    points = np.stack([np.column_stack([u0 + u * (u1 - u0), v0 + v * (v1 - v0)]) for u, v in PLACES], axis=1)
    axis = axes_at(likely.wall.pixels(points).reshape(-1, 2)).reshape(points.shape[:2])
    elsewhere = (axis != UNTOLD) & (axis != likely.axis)
    return likely.chosen(elsewhere.mean(axis=1) <= 1 / 2)


def _take(every: Sequence[_Likely], is_inside: bool, those: Callable[[_Likely], _Likely] = _everywhere) -> _Taken:
    """The best set of `those` of the rectangles; seen from inside, that light comes through."""
    found = [those(one.chosen(may_be(one.log_odds, one.evidence, is_inside))) for one in every]
    found = [one for one in found if len(one.box)]
    if not found:
        return _Taken([], ())
    taken, choice = _choice(found)
    taken, more = _filled(taken, is_inside, those)
    return _Taken(taken, max((choice, more), key=lambda each: each.gap).notes)


def _choice(found: list[_Likely]) -> tuple[list[_Likely], Choice]:
    """Of the rectangles of all walls the best set of which no two overlap in the photo, wall by wall."""
    choice = choose(
        [shape for likely in found for shape in likely.shapes()],
        np.concatenate([likely.log_odds for likely in found]) - LEAST_LOG_ODDS,
    )
    starts = np.cumsum([0, *(len(likely.box) for likely in found)])
    chosen = []
    for likely, start, end in zip(found, starts[:-1].tolist(), starts[1:].tolist(), strict=True):
        own = choice.taken[(choice.taken >= start) & (choice.taken < end)] - start
        chosen.append(likely.chosen(own))
    return chosen, choice


def _filled(taken: list[_Likely], is_inside: bool, those: Callable[[_Likely], _Likely]) -> tuple[list[_Likely], Choice]:
    """What was taken of each wall without odd ones, and what fills gaps in its rows and columns."""
    taken = [likely.chosen(~are_odd(likely.raster, likely.box)) for likely in taken]
    before = [shape for likely in taken for shape in likely.shapes()]
    gaps = []
    for likely in taken:
        box, log_odds, evidence = find_gaps(likely.pool, likely.box, likely.log_odds, likely.evidence, is_inside)
        gap = those(replace(likely, box=box, log_odds=log_odds, evidence=evidence))
        gaps.append(gap.chosen(not_overlapping(gap.shapes(), before)))
    more, choice = _choice(gaps)
    filled = []
    for one, other in zip(taken, more, strict=True):
        both = replace(
            one,
            box=np.concatenate([one.box, other.box]),
            log_odds=np.concatenate([one.log_odds, other.log_odds]),
            evidence=np.concatenate([one.evidence, other.evidence]),
        )
        filled.append(both.chosen(~are_beside_clearer(both.box, both.evidence)))
    return filled, choice


def _ground_height(planes: tuple[Plane, ...]) -> float | None:
    """The height of the ground that walls stand on, the highest beside a road; None where no face is part of it."""
    return max((plane.offset for plane in planes if plane.shows_ground), default=None)


def _with_recess(openings: list[Opening], likely: _Likely) -> list[Opening]:
    """The openings of a wall, with how deep they are where the photo tells it."""
    offset = {plane.id: plane.offset for plane in likely.wall.planes}
    box = np.array([[each.u0, each.u1, each.v0, each.v1] for each in openings])
    own = np.array([offset[each.plane] for each in openings])
    # On the plane that the wall is looked at in, which the rays of the photo meet elsewhere.
    ratios = depth_ratios(likely.raster, box * (likely.wall.plane.offset / own)[:, None])
    pairs = zip(openings, own.tolist(), ratios.tolist(), strict=True)
    return [
        each if np.isnan(ratio) else replace(each, recess=ratio * abs(place), panel=(1 + ratio) * place)
        for each, place, ratio in pairs
    ]


def _likely(wall: Wall, view: FrameView, raster: Raster) -> _Likely:
    """The rectangles of one wall, with how likely each is an opening."""
    pool = build_pool(raster)
    return _Likely(wall, view, raster, pool.box, pool.log_odds(), pool.evidence, pool)
