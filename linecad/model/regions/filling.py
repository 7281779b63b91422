"""What stands behind trees, cars and people: the walls and the ground between their visible parts.

Clutter that surfaces surround is given to them, cut along the lines in which they meet; what the sky or the photo's
border surrounds as well stays clutter, since nothing tells what is behind it. Outdoors no wall goes on behind them
beyond where the photo shows it somewhere; a room is closed. Regions too small for a face go the same way, and what a
wall was said to show beyond a corner that it has with another one.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from linecad.arrays import Bool, Float
from linecad.directions import partner
from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders, expand
from linecad.model.regions.evidence import sums
from linecad.model.regions.labels import UNIT, Labels
from linecad.model.regions.on_roofs import is_on_roof
from linecad.model.regions.proof import Program, prove
from linecad.model.regions.raster import Raster
from linecad.model.regions.roofs import Roof, notes_on
from linecad.model.regions.segments import View
from linecad.model.regions.wall_ends import Ends, ends_of_walls
from linecad.scene import Camera

SURROUNDED = 0.5  # share of the outline of clutter that is along surfaces
ON_ROOF = 0.2  # the same of what stands out against the sky on a building
LEAST_AREA = 0.0015  # of the photo, of a region that becomes a face
NEVER = 10**7  # cost of a label that a cell may not take
LAST = 5 * 10**6  # of clutter, where something hides what is behind it: more than of any surface that is reached
TOUCH = 1e-3  # px
UNREACHED, BEYOND = 10.0, 50.0  # cost a sample, from which on a good part of a cell lies where a surface is not seen
NOWHERE = shapely.Polygon()
SLACK = 0.01  # of its offset, by which samples may be beyond


@dataclass(frozen=True, eq=False)
class Filled:
    """Labels with what is hidden between surfaces, and the clutter that hides it."""

    labels: Labels
    clutter: shapely.Geometry  # px, the union of all clutter that was seen
    roofs: tuple[Roof, ...] = ()  # before whatever the labels say
    drop: float | None = None  # of the road below the pavement, in heights of the camera above this; None: no kerb
    lowered: float | None = None  # by which a depth map has the ground lower than where walls stand, in the same unit
    sky: shapely.Geometry = NOWHERE  # px, what is sky for sure, whatever the labels say
    told: tuple[str, ...] = ()  # what a person said and could not be taken, for people
    behind: Mapping[int, shapely.Geometry] = field(default_factory=dict)  # px, where surfaces go on unseen, by label

    def behind_of(self, number: int) -> shapely.Geometry:
        """Where the surface of a label goes on unseen, px."""
        return self.behind.get(number, NOWHERE)

    @property
    def notes(self) -> tuple[str, ...]:
        """How sure labels and slopes are, and how far the road lies below the pavement, for people."""
        cells = f"faces: what each of the {len(self.labels.costs)} parts of the photo shows"
        proof = f"{cells} may cost up to {self.labels.gap:.1%} more than the best; not proven"
        if self.labels.gap == 0:
            proof = f"{cells} is proven best for its costs"
        steps: tuple[str, ...] = ()
        if self.drop is not None:
            step = f"a kerb puts the road {self.drop:.1%} of the camera's height below the ground that walls stand on"
            steps = (f"faces: {step}",)
        elif self.lowered is not None:
            step = f"the ground is as low as the depth map has it, {self.lowered:.1%} of the camera's height below"
            steps = (f"faces: {step} where walls seem to stand; no kerb is seen",)
        return *self.told, proof, *steps, *notes_on(self.roofs)


def fill(found: Labels, meets: Float, raster: Raster, view: View, named: shapely.Geometry = NOWHERE) -> Filled:
    """Labels of cells that are cut along `meets` (N, 2, 2) px of surfaces too, with clutter between them filled in.

    What a person `named` clutter, px, is no part of a building: it stays what it is before the sky.
    """
    camera = view.camera
    clutter = shapely.union_all([region for number, region in found.regions if number == found.clutter])
    ends = ends_of_walls(found, raster, view)
    between, standing = _to_fill(found, raster, camera)
    on_roofs = [region for region in standing if shapely.intersection(region, named).area == 0]
    open_regions = between + on_roofs + [part for each in ends.values() for part in each.beyond]
    if not open_regions:
        return Filled(found, clutter)
    uprights = [upright for each in ends.values() for upright in each.uprights]
    cuts = np.concatenate([meets, np.array(uprights).reshape(-1, 2, 2)])
    cells = _cut_along(found, cuts, open_regions, camera, raster)
    inside = _inside(cells, open_regions)
    cell = partition.draw(cells, raster.shape, raster.step)
    middle = shapely.point_on_surface(np.array(cells, object))
    tree = shapely.STRtree([region for _, region in found.regions])
    numbers = np.array([number for number, _ in found.regions])
    point, region = tree.query(middle, predicate="within")
    label = np.full(len(cells), found.clutter)
    label[point] = numbers[region]
    own = sums(cell, len(cells), _not_beyond(found, ends, raster))
    whole = np.full(own.shape, NEVER, np.int64)
    whole[np.arange(len(cells)), label] = 0
    count = np.maximum(np.bincount(cell, minlength=len(cells)), 1)[:, None]
    # What a surface does not reach it does not show, however little else there is.
    reached = own[inside] < UNREACHED * count[inside]
    whole[inside] = np.where(reached, np.minimum(np.rint(own[inside] * UNIT), LAST - 1), NEVER)
    if on_roofs:
        whole[_inside(cells, on_roofs), found.sky] = NEVER
    small = inside & (label < found.sky)
    whole[small, label[small]] = NEVER
    whole[inside, found.clutter] = LAST  # where nothing is reached, it stays what it is
    started = np.where(inside, whole.argmin(axis=1), label)
    borders = neighbours(cells)
    label = expand(whole, borders, started, [*range(len(found.surfaces)), found.sky, found.clutter])
    proof = prove(Program(whole, borders, np.zeros(0, np.int64)), label)
    gap = max(found.gap, proof.gap)
    filled = replace(found, cells=cells, cell=cell, label=proof.label, costs=whole, borders=borders, gap=gap)
    return Filled(filled, clutter)


def _not_beyond(found: Labels, ends: dict[int, Ends], raster: Raster) -> Float:
    """Costs (S, K + 2) of samples with those of walls beyond their ends; one that is not shown is nowhere."""
    costs = found.of_samples.copy(order="F")
    for number, surface in enumerate(found.surfaces):
        if surface.kind != "wall" or not ends:
            continue
        low, high = (ends[number].low, ends[number].high) if number in ends else (np.inf, -np.inf)
        with np.errstate(divide="ignore", invalid="ignore"):
            along = surface.offset * raster.rays[:, int(partner(surface.axis))] / raster.rays[:, surface.axis]
        slack = SLACK * abs(surface.offset)
        costs[~((along > low - slack) & (along < high + slack)), number] += BEYOND
    return costs


def _to_fill(found: Labels, raster: Raster, camera: Camera) -> tuple[list[shapely.Polygon], list[shapely.Polygon]]:
    """Clutter that surfaces surround, with regions too small for a face, px; and clutter that stands on a building."""
    surfaces = [region for number, region in found.regions if number < found.sky]
    clutter = [region for number, region in found.regions if number == found.clutter]
    walls, least = shapely.union_all(surfaces).buffer(TOUCH), LEAST_AREA * camera.width * camera.height
    shared = [shapely.intersection(region.exterior, walls).length / region.exterior.length for region in clutter]
    small = [region for region in surfaces if region.area < least]
    surrounded = [region for region, share in zip(clutter, shared, strict=True) if share >= SURROUNDED]
    standing = [region for region, share in zip(clutter, shared, strict=True) if share >= ON_ROOF]
    return small + surrounded, [region for region in standing if is_on_roof(region, found, raster)]


def _cut_along(
    found: Labels, meets: Float, regions: list[shapely.Polygon], camera: Camera, raster: Raster
) -> list[shapely.Polygon]:
    """The cells, those in some regions cut along image lines too."""
    lines = partition.extended(meets, camera.width, camera.height, raster.step)[0][partition.BORDERS :]
    if len(lines) == 0:  # surfaces may meet outside the photo alone
        return found.cells
    inside = _inside(found.cells, regions)
    area = shapely.union_all([cell for cell, own in zip(found.cells, inside, strict=True) if own])
    across = shapely.intersection(shapely.multilinestrings(list(lines)), area)
    outlines = shapely.boundary(np.array(found.cells, object))
    # All of them once more: a cell has a corner where a line ends on its side.
    return partition.cells_between([*outlines, across])


def _inside(cells: list[shapely.Polygon], regions: list[shapely.Polygon]) -> Bool:
    """Which cells lie in one of the regions."""
    middle = shapely.point_on_surface(np.array(cells, object))
    inside = np.zeros(len(cells), bool)
    inside[shapely.STRtree(regions).query(middle, predicate="within")[0]] = True
    return inside


def neighbours(cells: list[shapely.Polygon]) -> Borders:
    """Cells that share a border, at a cost of its length in hundreds of px."""
    one, other = shapely.STRtree(cells).query(cells, predicate="intersects")
    pairs = np.column_stack([one, other])[one < other]
    shapes = np.array(cells, object)
    shared = shapely.length(shapely.intersection(shapes[pairs[:, 0]], shapes[pairs[:, 1]]))
    touching = shared > TOUCH
    return Borders(pairs[touching], np.rint(shared[touching] * 100).astype(np.int64))
