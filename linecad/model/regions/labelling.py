"""One label for every cell of the photo: a surface, the sky or clutter.

Labels are found by lines and edges first, then with the colours that this gives each label. A surface that wins less
than it costs to have one more is left out. Then lines are taken away that only cut off steps. For the cells that are
left the labels are proven cheapest, or replaced by cheaper ones, or it is told how far from the cheapest they may be.
"""

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.model.regions import partition
from linecad.model.regions.below import with_feet
from linecad.model.regions.corners import Known, Side, find_ends, find_sides, with_sides
from linecad.model.regions.cuts import Borders, energy, expand
from linecad.model.regions.evidence import CLUTTER, SKY, colour_costs, direction_costs, sample_costs, sums
from linecad.model.regions.heaven import Heaven
from linecad.model.regions.labels import UNIT, Labels
from linecad.model.regions.outlines import Outlined, simplest
from linecad.model.regions.proof import Program, prove
from linecad.model.regions.raster import Raster
from linecad.model.regions.segments import Meets, View, find_meets, find_segments, limit_of_depth
from linecad.model.regions.skyline import cut_at, find_plants, find_sky, near_outline
from linecad.model.regions.surfaces import Surface
from linecad.model.regions.told import NOTHING, Told
from linecad.scene import Lines

BORDER = 12.0  # cost of a border of one sample without a line or a change of colour
ON_LINE, ALIKE = 0.25, 0.25  # what is left of it on a line, and where colours differ much
COLOUR_STEP = 12.0  # CIE L*a*b*, by which the rest of it falls to 1 / e
SURFACE = 0.006  # cost of one more surface, in samples of all
DOUBTFUL = 3.0  # times that; surfaces that win more are kept without a question
FEWEST_WINS = 6  # surfaces asked in one turn
LEAST_SHOWN = 0.5  # share of where a side may be, that must show it


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

    def draw(used: Int) -> Outlined:
        inside = int((used < count).sum())
        border, rows = partition.extended(every[used], camera.width, camera.height, raster.step, inside)
        found = _labels(cells_of(border, steps), forced, drawn, surfaces, raster)
        return Outlined(found, border, np.append(used, -1)[rows])  # a border of the photo has the last row, -1

    best = _proven(simplest(Outlined(answer, border, rows), draw, count), raster)
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
