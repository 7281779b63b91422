"""The stages of finding what the photo shows, in order."""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linecad.arrays import Float
from linecad.corrections.edits import FaceEdit
from linecad.depth.normals import Normals
from linecad.directions import Turns
from linecad.model.openings.shown import WallShown
from linecad.model.regions.as_told import uncovered, with_told
from linecad.model.regions.blank_walls import with_blank_walls
from linecad.model.regions.clutter import with_hidden
from linecad.model.regions.feet import on_ground
from linecad.model.regions.filling import Filled, fill
from linecad.model.regions.heaven import Heaven, look_up
from linecad.model.regions.kerbs import STEPS, on_kerbs
from linecad.model.regions.labelling import find_labels, price_per_sample
from linecad.model.regions.labels import Labels
from linecad.model.regions.lower import parts_behind
from linecad.model.regions.mapped import MappedDepths, laid_on, level_of_map, with_mapped
from linecad.model.regions.opened import with_walls_shown
from linecad.model.regions.overgrown import is_in_the_open
from linecad.model.regions.raster import Picture, Raster, take_raster
from linecad.model.regions.roofs import Sketch, find_roofs
from linecad.model.regions.segments import View, find_meets
from linecad.model.regions.skirtings import with_skirtings
from linecad.model.regions.skyline import sure_sky
from linecad.model.regions.surfaces import (
    FIRM_FEET,
    SAME_LEVEL,
    Ground,
    GroundOfFeet,
    Kind,
    Surface,
    against,
    apart,
    find_surfaces,
    find_walls,
    ground_of_feet,
    is_contested,
    level_of_ends,
    likely_grounds,
)
from linecad.model.regions.telling import tell
from linecad.model.regions.told import Before, Told
from linecad.scene import Camera, Lines, Plane

EXACT = 0.03  # log depth, widest errors of parts of bodies by a map that tells a road from a pavement
SEEN = 0.01  # of the photo, that shows the ground at least where it is seen
PER_PHOTO = 240.0  # log-odds for a ground with which each sample of the photo costs 1 less


@dataclass(frozen=True, eq=False)
class Look:
    """What there is to look at beside the lines."""

    photo: Picture | None  # (H, W, 3) RGB, as straight as the lines
    feet: GroundOfFeet | None
    normals: Normals | None  # of a depth map on the photo's pixels
    sketch: Sketch | None = None
    mapped: MappedDepths | None = None  # what a depth map says
    faces: tuple[FaceEdit, ...] = ()  # what a person says
    height_of_ceiling: Callable[[], float | None] | None = None  # above the camera, by the heads of walls
    walls: tuple[WallShown, ...] = ()  # where windows and doors tell of one


@dataclass(frozen=True, eq=False)
class _Sight:
    """What is looked at, and what is known of it before anything is labelled."""

    planes: tuple[Plane, ...]
    walls: list[Surface]  # and levels, of these planes
    lines: Lines
    look: Look
    raster: Raster
    view: View
    heaven: Heaven
    feet: GroundOfFeet | None
    ceiling: float | None  # its height above the camera, where there is one

    def stand_on(self, ground: Ground | None) -> "_Standing":
        """The surfaces where the ground is at a height."""
        lines, look, raster, view = self.lines, self.look, self.raster, self.view
        surfaces = find_surfaces(self.walls, ground, self.ceiling)
        trodden = ground_of_feet(surfaces, ground)
        firm = trodden if self.feet and self.feet.log_odds >= FIRM_FEET else None
        surfaces = with_mapped(surfaces, raster, firm)
        # After the map's: its walls may go on farther, and its floor is where feet stand.
        if self.heaven.is_ceiling:
            surfaces = with_skirtings(surfaces, lines, view.camera, view.turns)
        elif look.sketch is not None:
            surfaces = with_blank_walls(surfaces, look.sketch, lines, raster, self.heaven, view)
        return _Standing(self, ground, surfaces, trodden, firm)

    def label(self, surfaces: list[Surface], firm: Surface | None) -> Labels:
        """What the photo shows of some surfaces, before a person tells."""
        return find_labels(self.lines, surfaces, self.raster, self.heaven, self.view, firm)

    def show(self, found: Labels, surfaces: list[Surface], firm: Surface | None) -> "_Shown":
        """What every part of the photo shows of some surfaces, of which labels were `found`."""
        lines, raster, view, heaven = self.lines, self.raster, self.view, self.heaven
        told, surfaces = tell(self.look.faces, self.planes, lines, surfaces, view, self.feet)
        if told.areas:
            told = replace(told, before=Before(found.surfaces, found.label[found.cell]))
            heaven = told.sky(heaven, raster)
            found = find_labels(lines, surfaces, raster, heaven, view, firm, told)
        meets = find_meets(lines, found.surfaces, view).ends
        length = np.linalg.norm(meets[:, 1] - meets[:, 0], axis=1)
        filled = fill(found, meets[np.argsort(-length, kind="stable")], raster, view, told.shapes("clutter"))
        return _Shown(with_told(on_ground(filled, raster, view), told), surfaces, told, heaven)


@dataclass(frozen=True, eq=False)
class _Shown:
    """What every part of a photo shows, before kerbs and roofs."""

    filled: Filled
    surfaces: list[Surface]  # with those that a person told of
    told: Told
    heaven: Heaven  # as a person has it


@dataclass(frozen=True, eq=False)
class _Standing:
    """Surfaces where the ground is at a height, before a person tells."""

    sight: _Sight
    ground: Ground | None
    surfaces: list[Surface]
    trodden: Surface | None  # the ground among them, if feet of walls put it there
    firm: Surface | None  # the same where these feet are firm

    @cached_property
    def labels(self) -> Labels:
        """What the photo shows of them."""
        return self.sight.label(self.surfaces, self.firm)

    @property
    def height(self) -> float | None:
        """Of the camera above the ground as it is among the surfaces: that of a level, or as a depth map has it."""
        return next((-surface.offset for surface in self.surfaces if surface.kind == "ground"), None)

    @cached_property
    def log_odds(self) -> float:
        """What feet, lines and labels say of this ground, by one cost of labels: a firm ground costs more."""
        labels = self.labels if self.firm is None else self.sight.label(self.surfaces, None)
        of_feet = self.ground.of_feet if self.ground else 0.0
        lines = against(self.sight.lines, self.height) if self.height is not None else 0.0
        return of_feet - lines - PER_PHOTO * price_per_sample(labels, self.sight.raster)

    def share(self, kind: Kind, heights: Collection[float] | None = None) -> float:
        """Share of the photo that shows surfaces of a kind below the camera, of all or some heights above these."""
        labels = self.labels
        own = [
            number
            for number, surface in enumerate(labels.surfaces)
            if surface.kind == kind and surface.offset < 0 and (heights is None or -surface.offset in heights)
        ]
        return float(np.isin(labels.label[labels.cell], own).mean())


def find_regions(
    planes: tuple[Plane, ...], lines: Lines, camera: Camera, rotation: Float, look: Look, turns: Turns = ()
) -> Filled:
    """What every part of the photo shows. `rotation` (3, 3) takes world to camera; `turns` are of further frames."""
    view = View(camera, rotation, look.photo, turns)
    raster = laid_on(take_raster(lines, camera, rotation, look.photo, look.normals, turns), look.mapped, camera)
    raster = with_walls_shown(raster, look.walls, look.faces)
    heaven = look_up(raster)
    feet = look.feet and replace(look.feet, is_open=is_in_the_open(look.feet, lines, raster, view))
    ceiling = _ceiling(look, lines) if heaven.is_ceiling else None
    walls = find_walls(planes, lines, camera)
    sight = _Sight(planes, walls, lines, look, raster, view, heaven, feet, ceiling)
    standing = _most_likely(sight, likely_grounds(walls, lines, feet))
    surfaces, trodden, firm = standing.surfaces, standing.trodden, standing.firm
    shown = sight.show(standing.labels, surfaces, firm)
    filled = shown.filled
    if trodden is not None and any(surface is trodden for surface in shown.surfaces):
        filled = on_kerbs(filled, planes, raster, view)  # walls stand on the pavement; lines may have found the road
        road = None if filled.drop is not None else _road_of_map(trodden, raster, look.mapped)
        if road is not None and not any(surface.kind == "ceiling" for surface in filled.labels.surfaces):
            surfaces = [road if surface is trodden else surface for surface in surfaces]
            firm = firm and road
            shown = sight.show(sight.label(surfaces, firm), surfaces, firm)
            filled = replace(shown.filled, lowered=float(road.offset / trodden.offset) - 1)
    filled = replace(with_hidden(filled, raster), sky=sure_sky(shown.heaven, raster))
    if look.sketch is not None:
        filled = replace(filled, roofs=find_roofs(look.sketch, filled.labels, shown.heaven, raster, view))
    filled = uncovered(filled, shown.told)
    ending = [area.shows for area in shown.told.areas if isinstance(area.shows, Surface)]
    return replace(filled, behind=parts_behind(filled.labels, view, ending))


def _most_likely(sight: _Sight, grounds: list[Ground]) -> _Standing:
    """The first of the grounds, or where that is in question the likeliest of those that the photo shows.

    It is where lines contradict feet, where the photo hardly shows it, and where it shows more of a rival. Feet and
    lines of misplaced bodies say alike little then, but a floor at the wrong height leaves walls where the photo shows
    floor.
    """
    first = sight.stand_on(grounds[0] if grounds else None)
    rivals = grounds[1:]
    if not rivals:
        return first
    of_rivals = first.share("level", [ground.height for ground in rivals])
    is_hardly_seen = first.share("ground") < max(SEEN, of_rivals)
    if not (is_contested(grounds) or is_hardly_seen):
        return first
    different = [first]
    for ground in rivals:
        rival = sight.stand_on(ground)
        if all(_differ(rival.height, each.height) for each in different):
            different.append(rival)
    shown = [each for each in different if each.share("ground") >= SEEN]
    return max(shown, key=lambda each: each.log_odds, default=first)


def _differ(one: float | None, other: float | None) -> bool:
    """Whether two heights above the ground are those of two grounds."""
    if one is None or other is None:
        return one is not other
    return apart(one, other) >= SAME_LEVEL


def _road_of_map(ground: Surface, raster: Raster, mapped: MappedDepths | None) -> Surface | None:
    """The ground as low as a depth map has it, where that is lower than where walls stand as a road is than a pavement.

    None where the map does not say so, or is not exact enough to, and where the ground is a plane of lines. A kerb that
    the photo shows tells both heights; this is for one that is hidden.
    """
    if mapped is None or mapped.width_of_parts > EXACT or ground.plane is not None:
        return None
    offset = level_of_map(raster)
    if offset is None or not STEPS[0] <= np.log(offset / ground.offset) <= STEPS[1]:
        return None
    return replace(ground, offset=offset)


def _ceiling(look: Look, lines: Lines) -> float | None:
    """The height of the ceiling above the camera: where heads of walls put it, but not below nearly all lines' ends.

    Where a depth map was heard, heads are not asked: it shows the ceiling itself, beside one of lines that is lower.
    """
    by_heads = None
    if look.height_of_ceiling is not None and look.mapped is None:
        by_heads = look.height_of_ceiling()
    return max(filter(None, (by_heads, level_of_ends(lines, above=True))), default=None)
