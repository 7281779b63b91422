"""A model of buildings that are given as polygons, in materials of our own, on a ground of our own.

Every polygon is cut into triangles, so depth stays exact; its sides are edges, but for those between two pieces of one
surface. What a window is made of follows from its polygons: those with holes are frames, those that fill them glass.
"""

import hashlib
from collections import defaultdict
from functools import cached_property

import numpy as np
import shapely
from numpy.random import Generator

from linecad.arrays import Bool, Float
from linecad.dataset.facades import DOORS, FRAMES, GLASS, IRON, TILES, TRIMS, WALLS
from linecad.dataset.modelling import UP, Material, Model
from linecad.dataset.polygons import Building, Polygon

ROUNDING = 0.001  # m, of the corners in such files
LEAST_AREA = 1e-7  # m2 of a triangle
SMOOTH = np.cos(np.radians(3.0))  # of the angle between two pieces of one surface
PANE = 0.12  # m; narrower parts of windows are frames
LEVEL, UPRIGHT = 0.985, 0.17  # of the vertical part of a unit normal: at least, of floors; at most, of walls
WALL_REACH = 0.6  # m from a window to the plane of its wall
PARALLEL = np.cos(np.radians(8.0))  # of the angle between a window and its wall
DEEPEST = 2.0  # m from the foot of a wall down to the ground
FLAT_FOOT = 0.3  # m between the ends of a wall's foot
GROUND = 400.0  # m, the side of the ground
PAVING = Material("slabs", (0.55, 0.54, 0.52))
FLAT_ROOF = Material("plain", (0.42, 0.41, 0.40))

Key = tuple[tuple[int, ...], tuple[int, ...]]  # both ends of a side, in units of ROUNDING


class Surface:
    """A polygon with what follows from it."""

    def __init__(self, polygon: Polygon) -> None:
        self.polygon = polygon
        outline = polygon.rings[0] - polygon.rings[0][0]
        following = outline[[*range(1, len(outline)), 0]]
        turned = np.cross(outline, following).sum(axis=0)  # Newell's normal
        self.area = float(np.linalg.norm(turned)) / 2  # m2, of the outline
        self.normal: Float = turned / max(2 * self.area, 1e-12)
        self.length = float(np.linalg.norm(following - outline, axis=1).sum())  # m, around

    @cached_property
    def sides(self) -> list[tuple[Key, Float]]:
        """Both ends (2, 3) of each side of the rings, by what is the same for a side and its way back."""
        found = []
        for ring in self.polygon.rings:
            names = [tuple(row) for row in np.rint(ring / ROUNDING).astype(int).tolist()]
            for index, name in enumerate(names):
                before = names[index - 1]
                found.append(((min(before, name), max(before, name)), ring[[index - 1, index]]))
        return found

    @cached_property
    def triangles(self) -> Float:
        """(T, 3, 3) m; its corners are those of the polygon, also where it is not quite flat."""
        rings = self.polygon.rings
        across = np.eye(3)[np.abs(self.normal).argmin()]
        first = np.cross(self.normal, across)
        first /= np.linalg.norm(first)
        second = np.cross(self.normal, first)
        middle = rings[0].mean(axis=0)
        flat = [np.column_stack([(ring - middle) @ first, (ring - middle) @ second]) for ring in rings]
        known = {
            tuple(point): corner
            for points, ring in zip(flat, rings, strict=True)
            for point, corner in zip(points.tolist(), ring, strict=True)
        }
        shape = shapely.Polygon(flat[0], flat[1:])
        parts = shapely.get_parts(shape if shape.is_valid else shapely.make_valid(shape))
        whole = [part for part in parts if isinstance(part, shapely.Polygon) and part.area > LEAST_AREA]
        cut = shapely.get_parts(shapely.constrained_delaunay_triangles(whole))
        corners = [
            [known.get((x, y), middle + x * first + y * second) for x, y in piece.exterior.coords[:3]] for piece in cut
        ]
        found = np.array(corners).reshape(-1, 3, 3)
        size = np.linalg.norm(np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0]), axis=1)
        kept: Float = found[size > 2 * LEAST_AREA]
        return kept


def surfaces_of(building: Building) -> list[Surface]:
    """The polygons of a building that can be seen, each outline once."""
    kept = {
        frozenset(key for key, _ in surface.sides): surface
        for surface in map(Surface, reversed(building.polygons))
        if surface.polygon.kind != "ground" and surface.area > LEAST_AREA
    }
    return list(reversed(kept.values()))


def build_imported(buildings: dict[str, list[Surface]], eye: Float, ground: float, seed: int) -> Model:
    """The model of buildings by their names, on a level ground of height `ground`, m, around the camera at `eye` (3,).

    The materials of a building follow from the seed and its name.
    """
    model = Model(has_frames=True, rounding=ROUNDING)
    model.start_body("ground")
    corner = np.array([eye[0] - GROUND / 2, eye[1] - GROUND / 2, ground])
    model.quad(corner, GROUND * np.eye(3)[0], GROUND * np.eye(3)[1], PAVING)
    for name, surfaces in buildings.items():
        model.start_body("building")
        number = int.from_bytes(hashlib.sha256(name.encode()).digest()[:4])
        paints = Paints(np.random.default_rng([seed, number]))
        _add_building(model, [*surfaces, *_plinths(surfaces, ground)], paints)
        _name_openings(model, surfaces)
    return model


class Paints:
    """The materials of a building."""

    def __init__(self, rng: Generator) -> None:
        pattern, colour = WALLS[rng.integers(len(WALLS))]
        shade = float(rng.uniform(0.9, 1.06))
        self.wall = Material(pattern, (colour[0] * shade, colour[1] * shade, colour[2] * shade))
        self.trim = Material("plain", TRIMS[rng.integers(len(TRIMS))])
        self.frame = Material("plain", FRAMES[rng.integers(len(FRAMES))])
        self.door = Material("plain", DOORS[rng.integers(len(DOORS))])
        self.roof = Material("tiles", TILES[rng.integers(len(TILES))])

    def of(self, surface: Surface) -> Material:
        """How a polygon looks."""
        polygon = surface.polygon
        match polygon.kind:
            case "wall" | "closure":
                return self.wall
            case "roof":
                return FLAT_ROOF if abs(surface.normal[2]) >= LEVEL else self.roof
            case "window":
                return self.frame if len(polygon.rings) > 1 or _is_narrow(surface) else GLASS
            case "door":
                return self.frame if len(polygon.rings) > 1 else self.door
            case "installation":
                return IRON if _is_narrow(surface) else self.trim
            case _:
                return self.trim


def _is_narrow(surface: Surface) -> bool:
    return 2 * surface.area < PANE * surface.length


def _plinths(surfaces: list[Surface], ground: float) -> list[Surface]:
    """Walls below walls and doors whose feet stand above the ground: the ground of such files is not level, ours is."""
    feet: dict[Key, list[Float]] = defaultdict(list)
    for surface in surfaces:
        if surface.polygon.kind in ("wall", "door") and abs(surface.normal[2]) <= UPRIGHT:
            lowest = surface.polygon.rings[0][:, 2].min()
            if ground < lowest < ground + DEEPEST:
                for key, ends in surface.sides:
                    if ends[:, 2].max() <= lowest + FLAT_FOOT:
                        feet[key].append(ends)
    down = np.array([1.0, 1.0, 0.0])
    found = [
        Surface(Polygon("wall", None, (np.concatenate([ends[0], (ends[0] * down + ground * UP)[::-1]]),)))
        for ends in feet.values()
        if len(ends) == 1
    ]
    return [surface for surface in found if surface.area > LEAST_AREA]  # not below short upright sides


def _add_building(model: Model, surfaces: list[Surface], paints: Paints) -> None:
    sides: dict[Key, list[tuple[Float, Material]]] = defaultdict(list)
    ends: dict[Key, Float] = {}
    for surface in surfaces:
        material = paints.of(surface)
        for corners in surface.triangles:
            model.triangle(corners[0], corners[1], corners[2], material)
        for key, both in surface.sides:
            sides[key].append((surface.normal, material))
            ends[key] = both
    for key, of in sides.items():
        if not _is_inside(of):
            model.edge(*ends[key])


def _is_inside(of: list[tuple[Float, Material]]) -> bool:
    """Whether what meets at a side is one surface, in which nobody sees the side."""
    normal, material = of[0]
    return len(of) > 1 and all(other == material and abs(float(turned @ normal)) >= SMOOTH for turned, other in of[1:])


def _name_openings(model: Model, surfaces: list[Surface]) -> None:
    """Tell the windows and doors in upright walls: the rectangle around each, in the plane of its wall."""
    walls = [one for one in surfaces if one.polygon.kind == "wall" and abs(one.normal[2]) <= UPRIGHT]
    things: dict[tuple[str, int | None], list[Surface]] = defaultdict(list)
    for number, surface in enumerate(surfaces):
        if surface.polygon.kind in ("window", "door"):
            thing = surface.polygon.thing
            things[surface.polygon.kind, -1 - number if thing is None else thing].append(surface)
    for (kind, _), parts in things.items():
        largest = max(parts, key=lambda part: part.area)
        if abs(largest.normal[2]) > UPRIGHT:
            continue
        points = np.concatenate([part.polygon.rings[0] for part in parts])
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        wall = _wall_of(middle, largest, walls)
        normal, place = (largest if wall is None else wall).normal, (largest if wall is None else wall).polygon.rings[0]
        out = normal * [1.0, 1.0, 0.0] / np.linalg.norm(normal[:2])
        along = np.cross(UP, out)
        offset = float(place.mean(axis=0) @ out)
        left, right = (points @ along).min(), (points @ along).max()
        low, high = points[:, 2].min(), points[:, 2].max()
        corner = offset * out + left * along + low * UP
        model.openings.append(np.array([corner, corner + (right - left) * along, corner + (high - low) * UP]))
        model.opening_is_door.append(kind == "door")
        model.opening_body.append(len(model.kinds) - 1)


def _wall_of(middle: Float, window: Surface, walls: list[Surface]) -> Surface | None:
    """The nearest wall that a window of this middle (3,) is parallel to and lies in the extent of."""
    near = []
    for wall in walls:
        ring = wall.polygon.rings[0]
        away = abs(float((middle - ring[0]) @ wall.normal))
        within: Bool = (ring.min(axis=0) - WALL_REACH <= middle) & (middle <= ring.max(axis=0) + WALL_REACH)
        if away <= WALL_REACH and within.all() and abs(float(wall.normal @ window.normal)) >= PARALLEL:
            near.append((away, wall))
    return min(near, key=lambda one: one[0])[1] if near else None
