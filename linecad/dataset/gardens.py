"""Streets of houses in gardens and on squares: what lies before a wall, stands before it and hides its foot.

Elsewhere a pavement of one kind lies before every wall. Photos show lawns, beds, gravel and paving of all colours,
whose borders run along the walls as the walls' feet do, and hedges, low walls, railings and steps before them.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from linecad.arrays import Float
from linecad.dataset.facades import IRON, WALLS, draw_style
from linecad.dataset.furniture import LEAVES, add_bush, add_hedge, add_traffic
from linecad.dataset.houses import X, Y, add_building
from linecad.dataset.modelling import UP, Interval, Material, Model, Pattern, Point, Wall

CAMERA_HEIGHT = (1.5, 2.2)  # m above the road
BEHIND = -30.0  # m, where the ground begins behind the camera
LAYER = 0.006  # m, by which one ground lies above another
GAP = (1.5, 7.0)  # m between houses
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
BEDS: tuple[Point, ...] = ((0.28, 0.22, 0.17), (0.35, 0.29, 0.22))


@dataclass(frozen=True, eq=False)
class Forecourt:
    """The ground between a wall and the street, in the frame of that wall."""

    wall: Wall
    length: float  # m, along the wall
    deep: float  # m, from the wall to the street
    level: float  # m, of its ground

    def lie(self, along: Interval, out: Interval, layer: int, material: Material) -> None:
        """Lay ground of another kind, above what has a lower layer."""
        corner = self.wall.at(along[0], self.level + layer * LAYER, out[0])
        self.wall.model.outline(
            corner, (along[1] - along[0]) * self.wall.along, (out[1] - out[0]) * self.wall.out, material
        )

    def stand(self, along: Interval, up: Interval, out: Interval, material: Material) -> None:
        """Put a box on the ground; heights count from there."""
        self.wall.box(along, (self.level + up[0], self.level + up[1]), out, material, "")


def build_gardens(rng: Generator) -> tuple[Model, Float, float]:
    """A street between gardens; the eye in it, and the side (-1 left, 1 right) to which it looks."""
    model = Model()
    side = float(rng.choice([-1.0, 1.0]))
    road, walk = float(rng.uniform(2.8, 6.0)), float(rng.uniform(1.2, 3.5))
    kerb = float(rng.choice([0.0, 0.04, 0.1, 0.15]))
    eye = np.array([rng.uniform(-0.6, 0.6) * road, 0.0, rng.uniform(*CAMERA_HEIGHT)])
    end = float(rng.uniform(30, 70))
    _add_street(model, (road, walk, kerb, end), rng)
    for sign in (-1.0, 1.0):
        y = float(rng.uniform(-18, -8))
        while y < end:
            width = float(rng.uniform(8, 24))
            _add_plot(model, sign, (road + walk, kerb), (y, y + width), rng)
            y += width + (float(rng.uniform(*GAP)) if rng.random() < 0.6 else 0.0)
    if rng.random() < 0.6:
        start = -float(rng.uniform(20, 30))
        while start < 30:
            width = float(rng.uniform(10, 24))
            add_building(model, (start, start + width), (end + 9, end + 20), float(rng.uniform(6, 18)), {"-y"}, rng)
            start += width + (float(rng.uniform(*GAP)) if rng.random() < 0.4 else 0.0)
    add_traffic(model, road, rng)
    return model, eye, side


def _add_street(model: Model, measures: tuple[float, float, float, float], rng: Generator) -> None:
    """The road, its kerbs and pavements, and what all plots lie on; road, pavement, kerb and end in m."""
    road, walk, kerb, end = measures
    model.start_body("ground")
    start, length = BEHIND * Y, (end + 90) * Y
    model.quad(-road * X + start, 2 * road * X, length, _paving(rng, *PAVINGS[-2:]))
    pavement, beyond = _paving(rng), _soil(rng)
    for sign in (-1.0, 1.0):
        edge = sign * road * X + start
        if kerb:
            stone = _paving(rng, ("plain", (0.64, 0.62, 0.59)))
            model.quad(edge, length, kerb * UP, stone)
            model.quad(edge + kerb * UP, 0.15 * sign * X, length, stone)
            model.edge(edge + kerb * UP + 0.15 * sign * X, edge + kerb * UP + 0.15 * sign * X + length)
        inner = edge + kerb * UP + (0.15 * sign * X if kerb else 0 * X)
        outer = sign * (road + walk) * X + start + kerb * UP
        model.quad(inner, outer - inner, length, pavement)
        model.quad(outer, 60 * sign * X, length, beyond)
        for line in (edge, edge + kerb * UP, outer):
            model.edge(line, line + length)


def _add_plot(model: Model, sign: float, street: tuple[float, float], y: Interval, rng: Generator) -> None:
    """A house with what lies before it; where the pavement ends and how high it lies, m."""
    edge, level = street
    deep = float(rng.choice([0.0, rng.uniform(0.3, 1.2), *rng.uniform(1.5, 5.0, 2), rng.uniform(3.0, 9.0)]))
    front, back = sign * (edge + deep), float(rng.uniform(8, 13))
    across = (min(front, front + sign * back), max(front, front + sign * back))
    style = replace(draw_style(rng), plinth=float(rng.choice([0.0, 0.0, 0.25, 0.5, 0.9])))
    names = {"+x" if sign < 0 else "-x"} | ({"-y"} if rng.random() < 0.6 else set())
    facades = add_building(model, across, y, float(rng.uniform(3.8, 15)), names, rng, style)
    facade = max(facades, key=lambda wall: abs(float(wall.out[0])))
    model.start_body("ground")
    forecourt = Forecourt(facade, y[1] - y[0], deep, level)
    doors = [along for along, up in facade.openings if up[0] == 0]
    door = doors[0] if doors else (0.4 * forecourt.length, 0.5 * forecourt.length)
    _lay_grounds(forecourt, door, rng)
    if deep > 1.0 and rng.random() < 0.6:
        _add_boundary(forecourt, door, rng)
    if deep > 0.25:
        _add_before_wall(forecourt, door, rng)
    if deep > 1.2 and rng.random() < 0.6:
        _add_steps(forecourt, door, rng)


def _lay_grounds(forecourt: Forecourt, door: Interval, rng: Generator) -> None:
    """A lawn, gravel or paving, a strip along the wall of another kind, a path to the door."""
    if forecourt.deep == 0:
        return
    whole, out = (0.0, forecourt.length), (0.0, forecourt.deep)
    forecourt.lie(whole, out, 1, _soil(rng) if rng.random() < 0.6 else _paving(rng))
    if rng.random() < 0.5:
        strip = min(forecourt.deep, float(rng.uniform(0.2, 1.2)))
        forecourt.lie(whole, (0.0, strip), 2, _soil(rng) if rng.random() < 0.6 else _paving(rng))
        if rng.random() < 0.5:
            stone = _paving(rng, ("plain", (0.6, 0.58, 0.55)))
            forecourt.stand(whole, (0.0, float(rng.uniform(0.03, 0.12))), (strip, strip + 0.08), stone)
    if forecourt.deep > 1.2:
        forecourt.lie((door[0] - 0.3, door[1] + 0.3), out, 3, _paving(rng))


def _add_boundary(forecourt: Forecourt, door: Interval, rng: Generator) -> None:
    """A hedge, a low wall or a railing along the street, but for a gate."""
    model, what = forecourt.wall.model, rng.random()
    out = (forecourt.deep - float(rng.uniform(0.25, 0.7)), forecourt.deep - 0.05)
    height, stone = float(rng.uniform(0.35, 1.3)), _paving(rng, *WALLS)
    leaves = LEAVES[rng.integers(len(LEAVES))]
    for along in ((0.0, door[0] - 0.5), (door[1] + 0.5, forecourt.length)):
        if along[1] - along[0] < 0.5:
            continue
        if what < 0.4:
            model.start_body("tree")
            corner = forecourt.wall.at(along[0], forecourt.level, out[0])
            add_hedge(model, corner, _sides(forecourt.wall, along, height, out), leaves, rng)
            continue
        model.start_body("furniture")
        if what < 0.7:
            forecourt.stand(along, (0.0, height), (out[1] - 0.25, out[1]), stone)
            forecourt.stand(along, (height, height + 0.06), (out[1] - 0.3, out[1] + 0.04), _paving(rng))
        else:
            _add_railing(forecourt, along, height, out[1])


def _add_railing(forecourt: Forecourt, along: Interval, height: float, out: float) -> None:
    """Upright bars between two rails."""
    for up in (0.1, height):
        forecourt.stand(along, (up, up + 0.04), (out - 0.04, out), IRON)
    count = max(1, int((along[1] - along[0]) / 0.16))
    for place in np.linspace(along[0], along[1] - 0.03, count + 1).tolist():
        forecourt.stand((place, place + 0.03), (0.0, height), (out - 0.03, out - 0.01), IRON)


def _add_before_wall(forecourt: Forecourt, door: Interval, rng: Generator) -> None:
    """Hedges, bushes, planters and bins that hide a part of the wall's foot."""
    model, deep = forecourt.wall.model, forecourt.deep
    start = float(rng.uniform(0.0, 2.0))
    while start < forecourt.length - 1.0:
        along = (start, min(forecourt.length, start + float(rng.uniform(0.6, 4.0))))
        start = along[1] + float(rng.uniform(0.5, 6.0))
        if along[0] < door[1] + 0.4 and along[1] > door[0] - 0.4:
            continue
        thick, near, what = min(deep - 0.05, float(rng.uniform(0.2, 0.8))), 0.08, rng.random()
        colour, height = LEAVES[rng.integers(len(LEAVES))], float(rng.uniform(0.3, 1.1))
        if what < 0.3:
            model.start_body("tree")
            corner = forecourt.wall.at(along[0], forecourt.level, near)
            add_hedge(model, corner, _sides(forecourt.wall, along, height, (near, near + thick)), colour, rng)
        elif what < 0.6:
            model.start_body("tree")
            half = np.array([0.3, 0.3, 0.5]) * rng.uniform(0.6, 1.6)
            add_bush(model, forecourt.wall.at(along[0] + 0.4, forecourt.level, near + 0.3), half, colour, rng)
        elif what < 0.8:
            model.start_body("furniture")
            box = (along[0], min(along[1], along[0] + 1.4))
            forecourt.stand(box, (0.0, height), (near, near + thick), _paving(rng, *WALLS))


def _add_steps(forecourt: Forecourt, door: Interval, rng: Generator) -> None:
    """Steps that rise to the door."""
    count, tread = int(rng.integers(1, 4)), float(rng.uniform(0.28, 0.36))
    stone, over = _paving(rng), float(rng.uniform(0.25, 0.8))
    forecourt.wall.model.start_body("furniture")
    for step in range(count):
        out = 0.5 + (count - step) * tread
        sides = (door[0] - over, door[1] + over)
        forecourt.stand(sides, (0.15 * step, 0.15 * (step + 1)), (0.0, min(out, forecourt.deep)), stone)


def _sides(wall: Wall, along: Interval, height: float, out: Interval) -> tuple[Float, Float, Float]:
    return (along[1] - along[0]) * wall.along, height * UP, (out[1] - out[0]) * wall.out


def _paving(rng: Generator, *among: tuple[Pattern, Point]) -> Material:
    among = among or PAVINGS
    pattern, colour = among[rng.integers(len(among))]
    return Material(pattern, _tinted(colour, rng))


def _soil(rng: Generator) -> Material:
    """Grass, gravel or earth."""
    what = rng.random()
    kinds = LAWNS if what < 0.5 else GRAVELS if what < 0.8 else BEDS
    return Material("asphalt", _tinted(kinds[rng.integers(len(kinds))], rng))


def _tinted(colour: Point, rng: Generator) -> Point:
    red, green, blue = np.clip(np.array(colour) * rng.normal(1, 0.12) + rng.normal(0, 0.008, 3), 0.05, 0.95).round(3)
    return float(red), float(green), float(blue)
