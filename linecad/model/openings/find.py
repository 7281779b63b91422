"""Windows and doors of the walls of a scene, found in the photo and put where its lines are.

Each wall is looked at straight on (`raster`). Rectangles that edges close (`rectangles`) and those that rows and
columns ask for (`lattice`) are judged (`pool`) by what the photo shows in and around them (`evidence`) and by how they
lie to the others (`neighbours`). The best set of which no two overlap is taken (`choice`), gaps in its rows and columns
are filled (`gaps`), and all are made regular (`regular`); then windows of one size tell together how deep their panes
are (`recess`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.model.openings.choice import Choice, choose, not_overlapping
from linecad.model.openings.gaps import are_beside_clearer, are_odd, find_gaps, may_be
from linecad.model.openings.odds import LEAST_LOG_ODDS
from linecad.model.openings.pool import Pool, build_pool
from linecad.model.openings.raster import Raster, build_raster, look
from linecad.model.openings.recess import depth_ratios
from linecad.model.openings.regular import Seen, make_regular
from linecad.model.openings.walls import Wall, find_walls
from linecad.scene import Camera, Lines, Opening, Plane

SEEN_COVER = 1.2  # of the four sides in sum: with less, an opening was not seen


@dataclass(frozen=True, eq=False)
class FrameView:
    """What is seen along the axes of one frame, in which its walls stand along x and y."""

    planes: tuple[Plane, ...]
    lines: Lines
    rotation: Float  # (3, 3) frame to camera


@dataclass(frozen=True, eq=False)
class _Likely:
    """Rectangles of a wall that are likely openings."""

    wall: Wall
    lines: Lines  # of the frame of the wall
    raster: Raster
    box: Int  # (N, 4)
    log_odds: Float  # (N,)
    evidence: Float  # (N, F)
    pool: Pool

    def chosen(self, which: Bool | Int) -> "_Likely":
        """The same with those of its rectangles alone."""
        return replace(self, box=self.box[which], log_odds=self.log_odds[which], evidence=self.evidence[which])

    def shapes(self) -> list[shapely.Polygon]:
        """The rectangles in the photo."""
        return shapes_of(self.wall, self.raster, self.box)


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


def find_openings(frames: Sequence[FrameView], camera: Camera, pixels: NDArray[np.uint8] | None) -> Found:
    """The openings of the vertical planes, frame by frame in the order of their planes, in the axes of their frames.

    `frames` has one of them at least, the main one first; without pixels (H, W, 3) of the photo there are no openings.
    """
    if pixels is None:
        return Found()
    sight = look(pixels)
    is_inside = any(face.kind == "ceiling" for plane in frames[0].planes for face in plane.faces)
    found = []
    for frame in frames:
        for wall in find_walls(frame.planes, frame.lines, camera, frame.rotation):
            raster = build_raster(wall, sight)
            likely = None if raster is None else _likely(wall, frame.lines, raster, is_inside)
            if likely is not None and len(likely.box):
                found.append(likely)
    if not found:
        return Found()
    taken, choice = _choice(found)
    taken, more = _filled(taken)
    ground = _ground_height(frames[0].planes)
    openings: list[Opening] = []
    for likely in taken:
        if len(likely.box):
            box = likely.box
            seen = Seen(
                np.column_stack([likely.raster.u[box[:, :2]], likely.raster.v[box[:, 2:]]]),
                np.column_stack(
                    [
                        np.diff(likely.raster.u)[box[:, 0].clip(max=len(likely.raster.u) - 2)],
                        np.full(len(box), likely.raster.v[1] - likely.raster.v[0]),
                    ]
                ),
                likely.pool.edges.cover(box).sum(axis=1) < SEEN_COVER,
            )
            openings += _with_recess(make_regular(likely.wall, likely.lines, seen, len(openings), ground), likely)
    return Found(tuple(openings), max((choice, more), key=lambda each: each.gap).notes)


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


def _filled(taken: list[_Likely]) -> tuple[list[_Likely], Choice]:
    """What was taken of each wall without odd ones, and what fills gaps in its rows and columns."""
    taken = [likely.chosen(~are_odd(likely.raster, likely.box)) for likely in taken]
    before = [shape for likely in taken for shape in likely.shapes()]
    gaps = []
    for likely in taken:
        box, log_odds, evidence = find_gaps(likely.pool, likely.box, likely.log_odds, likely.evidence)
        gap = replace(likely, box=box, log_odds=log_odds, evidence=evidence)
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


def _likely(wall: Wall, lines: Lines, raster: Raster, is_inside: bool) -> _Likely:
    """The rectangles of one wall that may be openings; seen from inside, only those that light comes through."""
    pool = build_pool(raster, is_inside)
    log_odds = pool.log_odds()
    every = _Likely(wall, lines, raster, pool.box, log_odds, pool.evidence, pool)
    return every.chosen(may_be(log_odds, pool.evidence, is_inside))
