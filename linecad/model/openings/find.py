"""Windows and doors of the walls of a scene, found in the photo and put where its lines are.

Each wall is looked at straight on (`raster`). Rectangles that edges close (`rectangles`) are judged by what the photo
shows in and around them (`evidence`) and by the rows and columns they stand in (`lattice`, which proposes what edges
missed). The likely ones that do not overlap are taken (`choice`) and made regular (`regular`).
"""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Float, Int
from linecad.model.openings.choice import choose
from linecad.model.openings.evidence import Sums, measure
from linecad.model.openings.lattice import distinct, propose, support
from linecad.model.openings.odds import LEAST_ODDS, first_odds, odds
from linecad.model.openings.raster import Raster, build_raster, look
from linecad.model.openings.rectangles import count_edges, find_rectangles
from linecad.model.openings.regular import Seen, make_regular
from linecad.model.openings.walls import Wall, find_walls
from linecad.scene import Camera, Lines, Opening, Plane

ALMOST_SAME = 0.8  # overlap of rectangles of which one is judged
SEEN_COVER = 1.2  # of the four sides in sum: with less, an opening was not seen


@dataclass(frozen=True, eq=False)
class _Likely:
    """Rectangles of a wall that are likely openings."""

    wall: Wall
    raster: Raster
    box: Int  # (N, 4)
    odds: Float  # (N,) log-odds
    cover: Float  # (N,) of the four sides in sum

    def shapes(self) -> list[shapely.Polygon]:
        """The rectangles in the photo."""
        u, v = self.raster.u[self.box[:, :2]], self.raster.v[self.box[:, 2:]]
        corners = np.stack([np.column_stack([u[:, i], v[:, j]]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))], axis=1)
        return list(shapely.polygons(self.wall.pixels(corners)))


def find_openings(
    planes: tuple[Plane, ...], lines: Lines, camera: Camera, rotation: Float, pixels: NDArray[np.uint8] | None
) -> tuple[Opening, ...]:
    """The openings of the vertical planes, in the order of their planes; none without pixels (H, W, 3) of the photo.

    `rotation` (3, 3) takes world to camera.
    """
    if pixels is None:
        return ()
    sight = look(pixels)
    found = []
    for wall in find_walls(planes, lines, camera, rotation):
        raster = build_raster(wall, sight)
        if raster is not None:
            likely = _likely(wall, raster)
            if len(likely.box):
                found.append(likely)
    if not found:
        return ()
    taken = choose(
        [shape for likely in found for shape in likely.shapes()],
        np.concatenate([likely.odds for likely in found]) - LEAST_ODDS,
    )
    openings: list[Opening] = []
    start = 0
    for likely in found:
        own = taken[(taken >= start) & (taken < start + len(likely.box))] - start
        start += len(likely.box)
        if len(own):
            box = likely.box[own]
            seen = Seen(
                np.column_stack([likely.raster.u[box[:, :2]], likely.raster.v[box[:, 2:]]]),
                np.column_stack(
                    [
                        np.diff(likely.raster.u)[box[:, 0].clip(max=len(likely.raster.u) - 2)],
                        np.full(len(own), likely.raster.v[1] - likely.raster.v[0]),
                    ]
                ),
                likely.cover[own] < SEEN_COVER,
            )
            openings += make_regular(likely.wall, lines, seen, len(openings))
    return tuple(openings)


def _likely(wall: Wall, raster: Raster) -> _Likely:
    """The rectangles of one wall that may be openings."""
    edges = count_edges(raster)
    box = find_rectangles(raster, edges)
    sums = Sums(raster)
    evidence = measure(box, edges, sums, raster)
    first = first_odds(evidence)
    kept = distinct(box, first, ALMOST_SAME)
    box, evidence, first = box[kept], evidence[kept], first[kept]
    core = distinct(box, first)
    others, other_odds = box[core], first[core]
    proposed = propose(others, raster)
    box = np.concatenate([box, proposed])
    evidence = np.concatenate([evidence, measure(proposed, edges, sums, raster)])
    # Once: asked again with what was proposed, rows and columns would support themselves.
    whole = odds(evidence, support(box, raster, others, other_odds))
    likely = whole >= LEAST_ODDS
    cover = edges.cover(box[likely]).sum(axis=1)
    return _Likely(wall, raster, box[likely], whole[likely], cover)
