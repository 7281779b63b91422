"""Streets with front gardens: what lies before a wall, stands before it and hides its foot.

Before the walls of other made streets lies a pavement of one kind. Photos show lawns, flower beds, gravel and paving of
all colours, whose borders run along the walls as the walls' feet do, and hedges, low walls, railings and planters
before them.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from linecad.arrays import Float
from linecad.dataset.facades import CORNICE, IRON, PARAPET, WALLS, Style, draw_style
from linecad.dataset.furniture import LEAVES, add_bush, add_hedge, add_traffic
from linecad.dataset.houses import add_building
from linecad.dataset.modelling import SAME, UP, Interval, Material, Model, Pattern, Point, Wall, X, Y, tinted

CAMERA_HEIGHT = (1.5, 2.2)  # m above the road
BEHIND = -30.0  # m, where the ground begins behind the camera
GAP = (1.5, 7.0)  # m between houses
BELOW = 0.03  # m, by which the ground between the plots lies below the pavement, and roads without a kerb too
EDGING = 0.08  # m, width of the stones along a strip
ASIDE = 0.9  # m, that is free on either side of a door
LEAST_LANDED = 1.2  # m; forecourts deeper than that have a path to the door and may have a landing
FAR = 84.0  # m, where the houses that end a street stand at the nearest: beyond its traffic
PAVINGS: tuple[tuple[Pattern, Point], ...] = (
    ("slabs", (0.62, 0.60, 0.57)),
    ("slabs", (0.50, 0.49, 0.47)),
    ("panel", (0.64, 0.63, 0.60)),
    ("brick", (0.52, 0.34, 0.28)),
    ("brick", (0.50, 0.47, 0.44)),
    ("ashlar", (0.55, 0.53, 0.50)),
    ("plain", (0.60, 0.59, 0.56)),
    ("asphalt", (0.36, 0.36, 0.37)),
    ("asphalt", (0.46, 0.45, 0.44)),
)
LAWNS: tuple[Point, ...] = ((0.30, 0.40, 0.16), (0.38, 0.45, 0.22), (0.25, 0.34, 0.15))
GRAVELS: tuple[Point, ...] = ((0.62, 0.58, 0.50), (0.48, 0.46, 0.43), (0.70, 0.68, 0.63))
SOILS: tuple[Point, ...] = ((0.28, 0.22, 0.17), (0.35, 0.29, 0.22))


@dataclass(frozen=True, eq=False)
class Forecourt:
    """The ground between a wall and the street, in the frame of that wall."""

    wall: Wall
    length: float  # m, along the wall
    deep: float  # m, from the wall to the street
    level: float  # m above the wall's foot, of its ground
    door: Interval  # m along the wall
    path: Interval  # m along the wall, of the path to the door

    def lay(self, along: Interval, out: Interval, material: Material) -> None:
        """Lay ground of one kind, without edges."""
        corner = self.wall.at(along[0], self.level, out[0])
        self.wall.model.quad(
            corner, (along[1] - along[0]) * self.wall.along, (out[1] - out[0]) * self.wall.out, material
        )

    def border(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Add an edge between two points (along, out) of the ground."""
        self.wall.model.edge(self.wall.at(start[0], self.level, start[1]), self.wall.at(end[0], self.level, end[1]))

    def put(self, along: Interval, up: Interval, out: Interval, material: Material) -> None:
        """Put a box on the ground, or against the wall; heights count from the ground."""
        hidden = f"{'' if up[0] else '-b'} {'' if out[0] else '-c'}"
        self.wall.box(along, (self.level + up[0], self.level + up[1]), out, material, hidden)

    def beside_door(self, free: float) -> list[Interval]:
        """What lies along the wall on either side of the door, `free` m away from it."""
        sides = ((0.0, self.door[0] - free), (self.door[1] + free, self.length))
        return [side for side in sides if side[1] - side[0] > 0.5]


def build_gardens(rng: Generator) -> tuple[Model, Float, float]:
    """A street with front gardens; the eye in it, and the side (-1 left, 1 right) to which it looks."""
    model = Model()
    side = float(rng.choice([-1.0, 1.0]))
    road, walk = float(rng.uniform(2.8, 6.0)), float(rng.uniform(1.2, 3.5))
    kerb = float(rng.choice([BELOW, 0.06, 0.1, 0.15]))
    eye = np.array([rng.uniform(-0.6, 0.6) * road, 0.0, rng.uniform(*CAMERA_HEIGHT)])
    end = float(rng.uniform(30, 70))
    far = max(end + 24, FAR)  # beyond the last plots, wherever these end
    _add_street(model, (road, walk, kerb, far), rng)
    for sign in (-1.0, 1.0):
        y, shared = float(rng.uniform(-18, -8)), None
        while y < end:
            width = float(rng.uniform(8, 24))
            deep = _add_plot(model, sign, (road + walk, kerb), (y, y + width), shared, rng)
            gap = float(rng.uniform(*GAP)) if rng.random() < 0.6 else 0.0
            y, shared = y + width + gap, None if gap else deep
    if rng.random() < 0.6:
        start = -float(rng.uniform(20, 30))
        while start < 30:
            width, style = float(rng.uniform(10, 24)), draw_style(rng)
            z = (0.0, _height(style, rng))  # the road runs up to them
            add_building(model, (start, start + width), (far, far + 11), z, {"-y"}, rng, style)
            start += width + (float(rng.uniform(*GAP)) if rng.random() < 0.4 else 0.0)
    add_traffic(model, road, rng)
    return model, eye, side


def _add_street(model: Model, measures: tuple[float, float, float, float], rng: Generator) -> None:
    """The road, its kerbs and pavements, and the ground between the plots; road, pavement, kerb and far end in m."""
    road, walk, kerb, far = measures
    model.start_body("ground")
    start, length = BEHIND * Y, (far + 12 - BEHIND) * Y
    model.quad(-road * X + start, 2 * road * X, length, _paving(rng, *PAVINGS[-2:]))
    pavement, beyond = _paving(rng), _soil(rng)
    for sign in (-1.0, 1.0):
        edge = sign * road * X + start
        inner = edge + kerb * UP
        stone = _paving(rng, ("plain", (0.64, 0.62, 0.59))) if kerb > BELOW else pavement
        model.quad(edge, length, kerb * UP, stone)
        if kerb > BELOW:
            model.quad(inner, 0.15 * sign * X, length, stone)
            model.edge(inner, inner + length)
            inner = inner + 0.15 * sign * X
        outer = sign * (road + walk) * X + start + kerb * UP
        model.quad(inner, outer - inner, length, pavement)
        model.quad(outer, length, -BELOW * UP, pavement)
        model.quad(outer - BELOW * UP, 60 * sign * X, length, beyond)
        for line in (edge, inner, outer):
            model.edge(line, line + length)


def _add_plot(
    model: Model, sign: float, street: tuple[float, float], y: Interval, shared: float | None, rng: Generator
) -> float:
    """A house with what lies before it, and how deep that is, m.

    `street` tells where the pavement ends and how high it lies, `shared` how deep the forecourt of the house is that
    adjoins, m, if one does.
    """
    edge, level = street
    deep = float(rng.choice([0.0, rng.uniform(0.3, 1.2), *rng.uniform(1.5, 5.0, 2), rng.uniform(3.0, 9.0)]))
    front, back = sign * (edge + deep), float(rng.uniform(8, 13))
    across = (min(front, front + sign * back), max(front, front + sign * back))
    style = draw_style(rng)
    style = replace(style, plinth=float(rng.choice([0.0, 0.0, 0.25, 0.5, 0.5 if style.shops else 0.9])))
    names = {"+x" if sign < 0 else "-x"} | ({"-y"} if shared is None and rng.random() < 0.6 else set())
    foot = level - BELOW  # where the ground between the plots lies
    facades = add_building(model, across, y, (foot, foot + _height(style, rng)), names, rng, style)
    facade = max(facades, key=lambda wall: abs(float(wall.out[0])))
    door = next(along for along, up in facade.openings if up[0] == 0)
    model.start_body("ground")
    aside = float(rng.uniform(0.3, ASIDE - 0.1))
    forecourt = Forecourt(facade, y[1] - y[0], deep, BELOW, door, (door[0] - aside, door[1] + aside))
    if deep > 0:
        _lay_grounds(forecourt, shared or 0.0, sign < 0, rng)
    if deep > 1.7 and rng.random() < 0.6:
        _add_boundary(forecourt, rng)
    if deep > 0.4:
        _add_before_wall(forecourt, rng)
    if deep > LEAST_LANDED and rng.random() < 0.6:
        _add_landing(forecourt, rng)
    return deep


def _height(style: Style, rng: Generator) -> float:
    """Of a house, m: as its storeys ask for."""
    storeys = int(rng.integers(1, 4))
    return style.ground + storeys * style.storey + CORNICE + PARAPET + float(rng.uniform(0.05, 0.4))


def _lay_grounds(forecourt: Forecourt, shared: float, along_street: bool, rng: Generator) -> None:
    """A lawn, gravel or paving, a strip along the wall of another kind, a path to the door; each border once.

    The pavement has the border to the street, the forecourt that adjoins, `shared` m deep, the one to it; the wall runs
    `along_street`, or against it.
    """
    length, deep, path = forecourt.length, forecourt.deep, forecourt.path
    main, by_wall, trodden = (_soil(rng) if rng.random() < 0.6 else _paving(rng) for _ in range(3))
    strip = min(deep, float(rng.uniform(0.2, 1.2))) if rng.random() < 0.5 else 0.0
    has_path = deep > LEAST_LANDED
    has_edging = has_path and rng.random() < 0.5 and 0 < strip <= deep - EDGING
    stone, high = _paving(rng, ("plain", (0.6, 0.58, 0.55))), float(rng.uniform(0.03, 0.12))
    parts = [(0.0, length)]
    if has_path:
        parts = [(0.0, path[0]), (path[1], length)]
        forecourt.lay(path, (0.0, deep), trodden)
        for along in path:
            forecourt.border((along, 0.0), (along, deep))
    for part in parts:
        if strip:
            forecourt.lay(part, (0.0, strip), by_wall)
        if strip < deep - SAME:
            forecourt.lay(part, (strip, deep), main)
        if 0 < strip < deep - SAME:
            forecourt.border((part[0], strip), (part[1], strip))
        if has_edging:
            forecourt.put(part, (0.0, high), (strip, strip + EDGING), stone)
    forecourt.border((0.0, 0.0), (length, 0.0))
    near, far = (0.0, length) if along_street else (length, 0.0)
    if deep > shared:
        forecourt.border((near, 0.0), (near, deep - shared))
    forecourt.border((far, 0.0), (far, deep))


def _add_boundary(forecourt: Forecourt, rng: Generator) -> None:
    """A hedge, a low wall or a railing along the street, but for a gate."""
    model, what = forecourt.wall.model, rng.random()
    out = (forecourt.deep - float(rng.uniform(0.25, 0.5)), forecourt.deep - 0.05)
    height, stone, coping = float(rng.uniform(0.35, 1.3)), _paving(rng, *WALLS), _paving(rng)
    leaves = LEAVES[rng.integers(len(LEAVES))]
    model.start_body("tree" if what < 0.4 else "furniture")
    for along in forecourt.beside_door(ASIDE):
        if what < 0.4:
            _plant_hedge(forecourt, along, height, out, leaves, rng)
        elif what < 0.7:
            forecourt.put(along, (0.0, height), (out[1] - 0.2, out[1] - 0.02), stone)
            forecourt.put(along, (height, height + 0.06), (out[1] - 0.22, out[1]), coping)
        else:
            _add_railing(forecourt, along, height, out[1])


def _plant_hedge(
    forecourt: Forecourt, along: Interval, height: float, out: Interval, colour: Point, rng: Generator
) -> None:
    wall = forecourt.wall
    sides = (along[1] - along[0]) * wall.along, height * UP, (out[1] - out[0]) * wall.out
    add_hedge(wall.model, wall.at(along[0], forecourt.level, out[0]), sides, colour, rng)


def _add_railing(forecourt: Forecourt, along: Interval, height: float, out: float) -> None:
    """Upright bars between two rails."""
    for up in (0.1, height):
        forecourt.put(along, (up, up + 0.04), (out - 0.04, out), IRON)
    count = max(1, int((along[1] - along[0]) / 0.16))
    for place in np.linspace(along[0], along[1] - 0.03, count + 1).tolist():
        forecourt.put((place, place + 0.03), (0.0, height), (out - 0.03, out - 0.01), IRON)


def _add_before_wall(forecourt: Forecourt, rng: Generator) -> None:
    """Hedges, bushes and stone planters that hide a part of the wall's foot."""
    near = 0.08  # m, as plinths stand off
    most = min(0.8, (forecourt.deep - 0.75 if forecourt.deep > 1.7 else forecourt.deep - 0.05) - near)
    for side in forecourt.beside_door(ASIDE):
        start = side[0] + float(rng.uniform(0.0, 2.0))
        while start < side[1] - 1.0:
            along = (start, min(side[1], start + float(rng.uniform(0.6, 4.0))))
            start = along[1] + float(rng.uniform(0.5, 6.0))
            out, what = (near, near + float(rng.uniform(0.25, 1.0)) * most), rng.random()
            colour, height = LEAVES[rng.integers(len(LEAVES))], float(rng.uniform(0.3, 1.1))
            forecourt.wall.model.start_body("tree" if what < 0.6 else "furniture")
            if what < 0.3:
                _plant_hedge(forecourt, along, height, out, colour, rng)
            elif what < 0.6 and most > 0.6:
                half = np.array([most / 2, most / 2, 0.5]) * rng.uniform(0.6, 1.0)
                foot = forecourt.wall.at(along[0] + 0.4, forecourt.level, near + most / 2)
                add_bush(forecourt.wall.model, foot, half, colour, rng)
            elif 0.6 <= what < 0.8:
                box = (along[0], min(along[1], along[0] + 1.4))
                forecourt.put(box, (0.0, height), out, _paving(rng, *WALLS))


def _add_landing(forecourt: Forecourt, rng: Generator) -> None:
    """A step as broad as the path before the door, over the door's own."""
    out = (0.0, float(rng.uniform(0.7, LEAST_LANDED - 0.05)))
    forecourt.wall.model.start_body("furniture")
    forecourt.put(forecourt.path, (0.0, float(rng.uniform(0.06, 0.16))), out, _paving(rng))


def _paving(rng: Generator, *among: tuple[Pattern, Point]) -> Material:
    among = among or PAVINGS
    pattern, colour = among[rng.integers(len(among))]
    return Material(pattern, _varied(colour, rng))


def _soil(rng: Generator) -> Material:
    """Grass, gravel or soil."""
    what = rng.random()
    kinds = LAWNS if what < 0.5 else GRAVELS if what < 0.8 else SOILS
    return Material("asphalt", _varied(kinds[rng.integers(len(kinds))], rng))


def _varied(colour: Point, rng: Generator) -> Point:
    return tinted(colour, rng.normal(1, 0.12), rng.normal(0, 0.008, 3))
