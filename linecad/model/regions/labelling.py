"""One label for every cell of the photo: a surface, the sky or clutter.

Labels are found by lines and edges first, then with the colours that this gives each label. A surface that wins less
than it costs to have one more is left out. Then lines are taken away that only cut off steps, the shortest first, and
of all answers on the way that one is taken whose labels and corners together cost least. For its cells the labels are
proven cheapest, or replaced by cheaper ones, or it is told how far from the cheapest they may be.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.geometry import unit_normals
from linecad.model.regions import partition
from linecad.model.regions.below import with_feet
from linecad.model.regions.corners import Known, Side, find_ends, find_sides, with_sides
from linecad.model.regions.cuts import Borders, energy, expand
from linecad.model.regions.evidence import CLUTTER, SKY, colour_costs, direction_costs, sample_costs, sums
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.proof import Program, prove
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import Meets, View, find_meets, find_segments, limit_of_depth
from linecad.model.regions.skyline import cut_at, find_plants, find_sky, near_outline
from linecad.model.regions.surfaces import Surface
from linecad.model.regions.told import NOTHING, Told
from linecad.scene import Lines

UNIT = 100  # of whole costs, in one sample
BORDER = 12.0  # cost of a border of one sample without a line or a change of colour
ON_LINE, ALIKE = 0.25, 0.25  # what is left of it on a line, and where colours differ much
COLOUR_STEP = 12.0  # CIE L*a*b*, by which the rest of it falls to 1 / e
SURFACE = 0.006  # cost of one more surface, in samples of all
DOUBTFUL = 3.0  # times that; surfaces that win more are kept without a question
FEWEST_WINS = 6  # surfaces asked in one turn
# Of the photo's width: lines are left out of which no longer piece is a border.
RUNS = (0.02, 0.04, 0.06, 0.08, 0.10, 0.14, 0.20)
CORNER = 0.0025  # cost of one more corner of an outline, in samples of all
LEAST_SHOWN = 0.5  # share of where a side may be, that must show it
ON_BORDER = 1e-3  # px
STRAIGHT = 1e-6  # px; a corner nearer to the straight outline is none


@dataclass(frozen=True, eq=False)
class Labels:
    """C cells of a photo with what they show, one of K surfaces, sky or clutter."""

    surfaces: list[Surface]  # those that are shown
    cells: list[shapely.Polygon]  # px
    cell: Int  # (S,) of each sample
    label: Int  # (C,) from 0: a surface, then the sky, then clutter
    of_samples: Float  # (S, K + 2) costs of each sample by itself
    costs: Int  # (C, K + 2), of the cells as they were labelled: feet of walls cut them further
    borders: Borders  # of the same cells
    gap: float = 1.0  # by which other labels may be cheaper, as a share of what is not cheapest; 1: nothing is known

    @property
    def sky(self) -> int:
        """The label of the sky."""
        return len(self.surfaces)

    @property
    def clutter(self) -> int:
        """The label of what has no plane."""
        return len(self.surfaces) + 1

    def is_side(self, label: int) -> bool:
        """Whether a label is a wall that begins where another one ends: it may be as narrow as that is thick."""
        return label < self.sky and self.surfaces[label].price < 1

    @cached_property
    def regions(self) -> list[tuple[int, shapely.Polygon]]:
        """Every connected union of cells with one label, px, with corners only where its outline turns."""
        return [
            (number, region)
            for number in np.unique(self.label).tolist()
            for region in united([cell for cell, own in zip(self.cells, self.label, strict=True) if own == number])
        ]

    @property
    def price(self) -> float:
        """What labels and corners cost, in samples."""
        corners = sum(len(shapely.get_coordinates(region)) for _, region in self.regions)
        return energy(self.costs, self.borders, self.label) / UNIT + CORNER * corners * len(self.cell)


def find_labels(
    lines: Lines,
    surfaces: list[Surface],
    raster: Raster,
    heaven: Heaven,
    view: View,
    firm: Surface | None = None,
    told: Told = NOTHING,
) -> Labels:
    """What each cell shows, of cells that lines and edges (`find_segments`) cut out of the photo, the strongest first.

    `firm` is the one of the surfaces that walls go down to: a ground whose height is sure. Where a person `told` what
    is shown, nothing else is. The costs of samples that come back know nothing of told clutter, which hides something.
    """
    camera, segments = view.camera, find_segments(lines, surfaces, raster, view)
    sky = find_sky(heaven, raster)

    def cells_of(border: Float, steps: Bool | None = None) -> list[shapely.Polygon]:
        cells = cut_at(told.cut(border), sky, raster)
        return cells if steps is None else cut_at(cells, plants, raster, steps)

    costs = sample_costs(raster, lines, surfaces, heaven, limit_of_depth(raster))
    forced = told.over(costs, surfaces, raster)
    drawn = _drawn(segments, raster) | near_outline(sky, raster)
    border, _ = partition.extended(segments, camera.width, camera.height, raster.step)
    found = _labels(cells_of(border), forced, drawn, surfaces, raster)
    shown = np.unique(found.label[found.label < len(surfaces)])
    costs, surfaces = costs[:, [*shown.tolist(), SKY, CLUTTER]], [surfaces[number] for number in shown.tolist()]
    label = np.searchsorted(shown, found.label) + (found.label == found.clutter)
    known = Known(label[found.cell], surfaces, lines, raster)
    costs = with_feet(costs, known, firm)
    known = known.without_gaps()
    sides = find_sides(find_ends(known), known)
    plants = find_plants(raster) if any(side.is_step for side in sides) else shapely.Polygon()
    while True:
        of_steps = [side.hides for side in sides if side.is_step]
        steps = np.any(of_steps, axis=0) if of_steps else None
        all_costs = with_sides(costs, sides, known)
        surfaces = [*known.surfaces, *(side.surface for side in sides)]
        forced = told.over(all_costs, surfaces, raster)
        meets = _meets_of_neighbours(found, shown, sides, find_meets(lines, surfaces, view))
        every, count = np.concatenate([meets, segments]), len(meets)
        border, rows = partition.extended(every, camera.width, camera.height, raster.step, count)
        answer = _labels(cells_of(border, steps), forced, drawn, surfaces, raster)
        taken = _shown_sides(answer, sides, told.samples("clutter", raster) | raster.plants)
        if len(taken) == len(sides):
            break
        sides = taken
    answers = [answer]
    for run in RUNS:
        used = np.unique(
            rows[_bordering(answers[-1], border, run * camera.width, RUNS[0] * camera.width) & (rows >= 0)]
        )
        every, count = every[used], int((used < count).sum())
        border, rows = partition.extended(every, camera.width, camera.height, raster.step, count)
        answers.append(_labels(cells_of(border, steps), forced, drawn, surfaces, raster))
    best = _proven(min(answers, key=lambda answer: answer.price), raster)
    return replace(best, of_samples=told.over(all_costs, surfaces, raster, with_clutter=False))


def price_per_sample(labels: Labels, raster: Raster) -> float:
    """What labels, their corners and the surfaces that are shown cost, by the number of samples."""
    shown = np.unique(labels.label[labels.label < labels.sky])
    return (labels.price + float(_prices(labels.surfaces, raster)[shown].sum()) / UNIT) / len(labels.cell)


def _shown_sides(found: Labels, sides: list[Side], covered: Bool) -> list[Side]:
    """The sides, last of the surfaces, that the photo shows in most of where they may be.

    What is `covered` (S,) says nothing about what is behind it, nor does the wall that ends there, which may be before
    it, but for steps: their walls are known to end.
    """
    label, shown = found.label[found.cell], []
    for row, side in enumerate(sides, len(found.surfaces) - len(sides)):
        beside = label[side.hides & ~covered & ((label != side.wall) | side.is_step)]
        shown += [side] if (beside == row).sum() > LEAST_SHOWN * len(beside) else []
    return shown


def _proven(found: Labels, raster: Raster) -> Labels:
    """The labels, or cheaper ones of the same cells, with their gap to the cheapest."""
    proof = prove(Program(found.costs, found.borders, _prices(found.surfaces, raster)), found.label)
    if proof.label is found.label:
        return replace(found, gap=proof.gap)
    return replace(found, label=_like_neighbours(found.cells, found.cell, proof.label), gap=proof.gap)


def _meets_of_neighbours(found: Labels, shown: Int, sides: list[Side], meets: Meets) -> Float:
    """The lines (M, 2, 2) px in which surfaces meet that are neighbours in the photo, by surfaces that are `shown`.

    A side, which comes behind these, is a neighbour of the walls that tell of it and of the ground.
    """
    labels = np.sort(found.label[found.borders.cells], axis=1)
    labels = np.searchsorted(shown, labels[labels[:, 1] < len(found.surfaces)])
    beside = {(int(one), int(other)) for one, other in np.unique(labels, axis=0)}
    for number, side in enumerate(sides, len(shown)):
        beside |= {(side.wall, number), (side.behind, number)}
        beside |= {(k, number) for k, each in enumerate(shown.tolist()) if found.surfaces[each].kind != "wall"}
    kept = np.array([tuple(pair) in beside for pair in np.sort(meets.surfaces, axis=1).tolist()], bool)
    ends: Float = meets.ends[kept]
    return ends


def _labels(cells: list[shapely.Polygon], costs: Float, drawn: Bool, surfaces: list[Surface], raster: Raster) -> Labels:
    cell = partition.draw(cells, raster.shape, raster.step)
    count = len(cells)
    own = sums(cell, count, costs) + direction_costs(raster, surfaces, cell, count)
    borders = _borders(cell, drawn, raster)
    label = own.argmin(axis=1)
    candidates = np.unique(label).tolist()
    label = expand(_whole(own), borders, label, candidates)
    whole = _whole(own + colour_costs(raster, cell, label, own.shape[1]))
    label = expand(whole, borders, label, candidates)
    label = _without_doubtful(whole, borders, label, _prices(surfaces, raster))
    return Labels(surfaces, cells, cell, _like_neighbours(cells, cell, label), costs, whole, borders)


def _like_neighbours(cells: list[shapely.Polygon], cell: Int, label: Int) -> Int:
    """The labels, where a cell that is too thin for a sample has that of the neighbour with which it shares most."""
    seen = np.bincount(cell, minlength=len(cells)) > 0
    shapes, label = np.array(cells, object), label.copy()
    thin = np.flatnonzero(~seen)
    number, other = shapely.STRtree(cells).query(shapes[thin], predicate="intersects")
    number, other = number[seen[other]], other[seen[other]]
    shared = shapely.length(shapely.intersection(shapes[thin[number]], shapes[other]))
    order = np.argsort(shared, kind="stable")  # the longest is written last
    label[thin[number[order]]] = label[other[order]]
    return label


def _whole(costs: NDArray[np.floating[Any]]) -> Int:
    """Costs in whole units."""
    whole: Int = np.rint(costs * UNIT).astype(np.int64)
    return whole


def _drawn(segments: Float, raster: Raster) -> Bool:
    """Mask (H, W) of the samples on segments (N, 2, 2) px."""
    image: NDArray[np.uint8] = np.zeros(raster.shape, np.uint8)
    for start, end in np.rint(raster.samples_of(segments)).astype(np.int64).tolist():
        cv2.line(image, start, end, 1, 1)
    return image > 0


def _borders(cell: Int, drawn: Bool, raster: Raster) -> Borders:
    """Neighbouring cells, and what it costs to label them differently."""
    height, width = raster.shape
    image, colour = cell.reshape(raster.shape), raster.colour.astype(np.float64)
    pairs, costs = [], []
    for down, right in ((0, 1), (1, 0)):
        here, there = np.s_[: height - down, : width - right], np.s_[down:, right:]
        apart = image[here] != image[there]
        step = np.linalg.norm(colour[here][apart] - colour[there][apart], axis=1)
        on_line = (drawn[here] | drawn[there])[apart]
        costs.append(np.where(on_line, ON_LINE, 1.0) * (ALIKE + (1 - ALIKE) * np.exp(-step / COLOUR_STEP)))
        pairs.append(np.sort(np.column_stack([image[here][apart], image[there][apart]]), axis=1))
    number = np.concatenate(pairs) @ [raster.size, 1]
    number, index = np.unique(number, return_inverse=True)
    cells = np.column_stack(np.divmod(number, raster.size))
    return Borders(cells, _whole(BORDER * np.bincount(index, np.concatenate(costs), len(cells))))


def _prices(surfaces: list[Surface], raster: Raster) -> Int:
    """(K,) what it costs to show each surface, in whole units."""
    return _whole(SURFACE * raster.size * np.array([surface.price for surface in surfaces], np.float64))


def _without_doubtful(costs: Int, borders: Borders, label: Int, price: Int) -> Int:
    """Labels without the surfaces that are not worth their price (K,), the least worth of them first."""
    costs = costs.copy()
    never = int(costs.max(initial=0)) + 1
    while True:
        worth = []
        shown = np.unique(label)
        for number in shown[shown < len(price)].tolist():
            own = label == number
            others = shown[shown != number]
            if len(others):
                worth.append((int((costs[own][:, others].min(axis=1) - costs[own, number]).sum()), number))
        best = energy(costs, borders, label)
        for gain, number in sorted(worth)[:FEWEST_WINS]:
            if gain > DOUBTFUL * price[number]:
                continue
            without = costs.copy()
            without[:, number] = never
            others = shown[shown != number]
            moved = np.where(label == number, others[without[:, others].argmin(axis=1)], label)
            moved = expand(without, borders, moved, others.tolist())
            if energy(without, borders, moved) < best + price[number]:
                label, costs = moved, without
                break
        else:
            return label


def _bordering(found: Labels, lines: Float, least: float, least_of_sides: float) -> Bool:
    """Which lines (M, 2, 2) have a piece of `least` px or more that separates two labels, or one of a side less."""
    edges = np.concatenate(
        [_edges(region, least_of_sides if found.is_side(n) else least) for n, region in found.regions]
    )
    across = unit_normals(lines[:, 1] - lines[:, 0])
    off = np.abs(((edges[:, None] - lines[None, :, :1]) * across[None, :, None]).sum(axis=3)).max(axis=2)
    return np.asarray((off < ON_BORDER).any(axis=0)) if len(edges) else np.zeros(len(lines), bool)


def _edges(region: shapely.Polygon, least: float) -> Float:
    """(E, 2, 2) the edges of a region, of `least` px or more."""
    rings = [shapely.get_coordinates(ring) for ring in (region.exterior, *region.interiors)]
    edges = np.concatenate([np.stack([corners[:-1], corners[1:]], axis=1) for corners in rings])
    return np.asarray(edges[np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1) >= least])


def united(cells: list[shapely.Polygon]) -> list[shapely.Polygon]:
    """The connected unions of cells, px, with corners only where their outlines turn."""
    union = shapely.simplify(shapely.union_all(np.array(cells, object)), STRAIGHT)
    return partition.polygons_of(union)
