"""Streets of several horizontal frames: rows of houses that bend, corners that are not square, roofs that slope.

Measured on an inner-city street, neighbours differ by 3.5 degrees in the median and half of the roof area slopes.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.random import Generator

from linecad.arrays import Float
from linecad.dataset.facades import TILES, Style, build_facade, draw_style
from linecad.dataset.furniture import add_lamp, add_tree
from linecad.dataset.modelling import UP, Material, Model, Wall

CAMERA_HEIGHT = (1.5, 2.0)  # m above the ground
MEDIAN_TURN, LARGEST_TURN = np.radians(3.5), np.radians(15.0)  # between neighbours
CURVE = np.radians(0.55)  # per m along the street, at most
STRAY = np.radians(10.0)  # of a house from the curve of its street; beyond it the next one turns back
SKEWED, LARGEST_SKEW = 0.35, np.radians(14.0)  # share of houses without square corners, and how far off
DETAIL_REACH = 34.0  # m; facades that begin farther away have plain windows and no courses
PAVEMENT, KERB = 2.2, 0.14  # m, wide and high
SLAB = 0.16  # m, thickness of a roof
PITCH = (np.radians(25.0), np.radians(55.0))  # of roofs
FLAT, GABLE_TO_STREET = 0.15, 0.2  # shares of the houses; the ridges of the others run along the street

ASPHALT = Material("asphalt", (0.36, 0.36, 0.37))
SLABS = Material("slabs", (0.62, 0.60, 0.57))
FLAT_ROOF = Material("plain", (0.40, 0.33, 0.30))

RoofKind = Literal["flat", "eaves", "gable"]


@dataclass(frozen=True, eq=False)
class Plot:
    """A house over a parallelogram: its front begins at `foot`; both sides are level, and seldom at right angles."""

    foot: Float  # (3,) m
    front: Float  # (3,) m, along the street
    side: Float  # (3,) m, from the front to the back
    height: float  # m, of the eaves


def build_town(rng: Generator) -> tuple[Model, Float, float]:
    """A street between two rows that bend, closed by turned houses; the eye and the side to which it looks."""
    model = Model(has_frames=True)
    look = float(rng.choice([-1.0, 1.0]))
    half = float(rng.uniform(6.5, 9.5))  # m from the middle of the street to its fronts
    eye = np.array([rng.uniform(-0.25, 0.25) * half, 0.0, rng.uniform(*CAMERA_HEIGHT)])
    model.start_body("ground")
    model.quad(np.array([-150.0, -60.0, 0.0]), np.array([300.0, 0, 0]), np.array([0, 300.0, 0]), ASPHALT)
    curve = float(rng.uniform(-1, 1)) * CURVE
    end = float(rng.uniform(45, 75))
    for sign in (-1.0, 1.0):
        _add_row(model, sign, (half, end), curve, rng)
    start = np.array([-40.0, end + 8.0, 0.0])
    while start[0] < 40:
        width, heading = float(rng.uniform(10, 20)), float(rng.normal(0, 0.12))
        front = width * np.array([np.cos(heading), np.sin(heading), 0.0])
        back = 11 * np.array([-np.sin(heading), np.cos(heading), 0.0])
        _add_house(model, Plot(start, front, back, float(rng.uniform(9, 16))), rng)
        start = start + front
    for sign in (-1.0, 1.0):
        y = float(rng.uniform(9, 20))
        while y < 40:
            x = sign * (half - 1.6) - curve * y**2 / 2
            if rng.random() < 0.3:
                add_tree(model, x, y, float(rng.uniform(5, 7)), 900, rng)
            elif rng.random() < 0.4:
                add_lamp(model, x, y, float(rng.uniform(5, 7.5)), 0.0)
            y += float(rng.uniform(9, 16))
    return model, eye, look


def _add_row(model: Model, sign: float, extent: tuple[float, float], curve: float, rng: Generator) -> None:
    """Houses wall to wall along one side; positive turns are to the left."""
    half, end = extent
    foot = np.array([sign * half, float(rng.uniform(-16, -10)), 0.0])
    heading = float(rng.normal(0, 0.03))
    while foot[1] < end:
        width = float(rng.uniform(8, 17))
        along = np.array([-np.sin(heading), np.cos(heading), 0.0])
        away = sign * np.array([np.cos(heading), np.sin(heading), 0.0])
        skew = float(rng.uniform(-1, 1)) * LARGEST_SKEW if rng.random() < SKEWED else 0.0
        side = float(rng.uniform(9, 13)) * (away + np.tan(skew) * along)
        _add_house(model, Plot(foot, width * along, side, float(rng.uniform(8, 15))), rng)
        model.start_body("ground")
        model.box(foot, (width * along, -PAVEMENT * away, KERB * UP), SLABS, "-a +a -b -c")
        foot = foot + width * along
        heading += _turn(heading - curve * float(foot[1]), rng)


def _turn(stray: float, rng: Generator) -> float:
    """The angle, rad, between a house and its neighbour; back to the curve of the street where it strayed too far."""
    size = float(min(rng.exponential(MEDIAN_TURN / np.log(2)), LARGEST_TURN))
    back = -1.0 if stray > 0 else 1.0
    return size * (back if abs(stray) > STRAY or rng.random() < 0.6 else -back)


def _add_house(model: Model, plot: Plot, rng: Generator) -> None:
    """A house with a facade to the street and to its first side, bare walls elsewhere, and a roof."""
    model.start_body("building")
    style = draw_style(rng)
    corner = plot.foot + plot.front + plot.side
    detailed = plot.foot[1] < DETAIL_REACH
    for foot, step, has_facade in (
        (plot.foot, plot.front, True),
        (plot.foot, plot.side, True),
        (corner, -plot.front, False),
        (corner, -plot.side, False),
    ):
        _add_wall(model, foot, step, plot, style, rng if has_facade else None, detailed)
    _add_roof(model, plot, style, rng)


def _add_wall(
    model: Model, foot: Float, step: Float, plot: Plot, style: Style, rng: Generator | None, detailed: bool
) -> None:
    """The wall from `foot` along `step`, with a facade where `rng` is given."""
    width = float(np.linalg.norm(step))
    along = step / width
    out = np.array([along[1], -along[0], 0.0])
    middle = plot.foot + (plot.front + plot.side) / 2
    if (foot + step / 2 - middle) @ out < 0:
        # A wall is seen from where `along` runs to the right.
        foot, along, out = foot + step, -along, -out
    wall = Wall(model, foot, along, out)
    if rng is not None:
        build_facade(wall, width, plot.height, style, rng, detailed)
    else:
        wall.build((0.0, width), (0.0, plot.height), style.wall)
    top = foot + plot.height * UP
    model.edge(foot, top)
    model.edge(foot, foot + width * along)
    model.edge(top, top + width * along)


def _add_roof(model: Model, plot: Plot, style: Style, rng: Generator) -> None:
    """A flat roof, or two slopes with their gables."""
    drawn = float(rng.random())
    kind: RoofKind = "flat" if drawn < FLAT else "gable" if drawn < FLAT + GABLE_TO_STREET else "eaves"
    pitch, eaves, verge = float(rng.uniform(*PITCH)), float(rng.uniform(0.3, 0.6)), float(rng.uniform(0.05, 0.3))
    tiles = Material("tiles", TILES[rng.integers(len(TILES))])
    base = plot.foot + plot.height * UP
    if kind == "flat":
        model.quad(base, plot.front, plot.side, FLAT_ROOF)
        return
    # The ridge runs along `ridge`, the slopes rise along `across`.
    ridge, across = (plot.front, plot.side) if kind == "eaves" else (plot.side, plot.front)
    length = float(np.linalg.norm(ridge))
    run = float(np.linalg.norm(np.cross(ridge / length, across))) / 2  # m, level and square to the ridge
    rise = run * np.tan(pitch)
    more = eaves / run
    for start in (base, base + ridge):
        model.triangle(start, start + across, start + across / 2 + rise * UP, style.wall)
    over = verge * ridge / length
    for low, way in ((base, across / 2), (base + across, -across / 2)):
        slope = way + rise * UP
        corner = low - more * slope - over
        model.box(corner, (ridge + 2 * over, (1 + more) * slope, SLAB * UP), tiles, "+b")
