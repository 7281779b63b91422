"""Rooms, drawn at random: walls with windows and doors, skirting boards, shelves, tables, cupboards and pictures."""

import numpy as np
from numpy.random import Generator

from linecad.arrays import Float
from linecad.dataset.facades import DOORS
from linecad.dataset.modelling import UP, Interval, Material, Model, Point, Wall, X, Y

WALL_COLOURS: tuple[Point, ...] = ((0.87, 0.85, 0.80), (0.80, 0.83, 0.82), (0.86, 0.78, 0.68), (0.75, 0.80, 0.74))
WOODS: tuple[Point, ...] = ((0.62, 0.46, 0.30), (0.44, 0.31, 0.21), (0.74, 0.62, 0.45))
BOOKS: tuple[Point, ...] = (
    (0.42, 0.18, 0.16), (0.20, 0.29, 0.42), (0.24, 0.36, 0.26), (0.62, 0.54, 0.38),
    (0.30, 0.27, 0.26), (0.68, 0.64, 0.58), (0.55, 0.35, 0.20), (0.36, 0.24, 0.38),
)  # fmt: skip
WHITE = Material("plain", (0.88, 0.87, 0.84))
CEILING = Material("plain", (0.90, 0.90, 0.88))
EYE_LEVEL = (1.5, 2.0)  # m


def build_room(rng: Generator) -> tuple[Model, Float, float]:
    """A furnished room, the eye in it, and the side (-1 left, 1 right) to which it looks."""
    model = Model()
    model.start_body("building")
    side = float(rng.choice([-1.0, 1.0]))
    half, deep, high = float(rng.uniform(2.4, 3.4)), float(rng.uniform(5.5, 8.0)), float(rng.uniform(2.6, 3.2))
    paint = Material("plain", WALL_COLOURS[rng.integers(len(WALL_COLOURS))])
    wood = Material("plain", WOODS[rng.integers(len(WOODS))])
    corner = np.array([-half, -2.0, 0.0])
    model.quad(corner, 2 * half * X, (deep + 2) * Y, Material("slabs", WOODS[rng.integers(len(WOODS))]))
    model.quad(corner + high * UP, 2 * half * X, (deep + 2) * Y, CEILING)
    left = Wall(model, np.array([-half, -2.0, 0.0]), Y, X)
    right = Wall(model, np.array([half, deep, 0.0]), -Y, -X)
    back = Wall(model, np.array([-half, deep, 0.0]), X, -Y)
    behind = Wall(model, np.array([half, -2.0, 0.0]), -X, Y)
    lit, other = (left, right) if side > 0 else (right, left)
    _add_windows(lit, deep + 2, high, rng)
    from_corner = float(rng.uniform(0.2, 0.6)) * half
    _add_door(back, from_corner if side > 0 else 2 * half - from_corner - 0.9, rng)
    for wall, length in ((left, deep + 2), (right, deep + 2), (back, 2 * half), (behind, 2 * half)):
        for up in ((0.0, 0.1), (high - 0.09, high)):
            wall.box((0.0, length), up, (0.0, 0.018 if up[0] == 0 else 0.07), WHITE, "-c -b" if up[0] == 0 else "-c +b")
        wall.build((0.0, length), (0.0, high), paint)
        model.edge(wall.at(0.0, 0.0), wall.at(0.0, high))
    _add_pictures(other, deep + 2, side, rng)
    _add_shelf(other, (_along(float(rng.uniform(0.5, 0.55)) * (deep + 2), 1.9, deep + 2, side), 1.9), high, wood, rng)
    _add_shelf(back, (2 * half - 1.5 if side > 0 else 0.15, 1.35), high, wood, rng)
    _add_tables(model, side, half, deep, wood, rng)
    eye = np.array([-side * rng.uniform(0.1, 0.5) * half, -1.5, rng.uniform(*EYE_LEVEL)])
    return model, eye, side


def _along(start: float, width: float, length: float, side: float) -> float:
    """Where a thing of `width` that starts so far from the near end of a side wall starts in the wall's frame."""
    return start if side < 0 else length - start - width


def _add_windows(wall: Wall, length: float, high: float, rng: Generator) -> None:
    count = int(rng.integers(2, 4))
    width, deep = float(rng.uniform(1.0, 1.4)), float(rng.uniform(0.12, 0.25))
    columns, rows = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    for index in range(count):
        middle = length * (index + 0.5) / count
        along: Interval = (middle - width / 2, middle + width / 2)
        up: Interval = (0.85, high - 0.35)
        wall.opening(along, up, deep, WHITE)
        wall.box((along[0] - 0.08, along[1] + 0.08), (0.81, 0.85), (0.0, 0.16), WHITE)
        for column in range(columns + 1):
            start = along[0] + (width - 0.07) * column / columns
            wall.box((start, start + 0.07), up, (-deep, -deep + 0.06), WHITE, "-b +b")
        for row in range(rows + 1):
            start = up[0] + (up[1] - up[0] - 0.07) * row / rows
            wall.box(along, (start, start + 0.07), (-deep, -deep + 0.052), WHITE, "-a +a")


def _add_door(wall: Wall, start: float, rng: Generator) -> None:
    """A closed door with panels in a frame."""
    leaf = Material("plain", DOORS[rng.integers(len(DOORS))]) if rng.random() < 0.4 else WHITE
    along, top = (start, start + 0.9), 2.05
    wall.panel(along, (0.0, top), 0.02, leaf)
    wall.name_opening(along, (0.0, top), is_door=True)
    for low, high in ((along[0] - 0.1, along[0]), (along[1], along[1] + 0.1)):
        wall.box((low, high), (0.0, top), (0.0, 0.05), WHITE, "-c -b")
    wall.box((along[0] - 0.1, along[1] + 0.1), (top, top + 0.12), (0.0, 0.055), WHITE)
    for bottom, upper in ((0.2, 0.85), (1.0, 1.9)):
        for low, high in ((along[0] + 0.12, start + 0.4), (start + 0.5, along[1] - 0.12)):
            wall.box((low, high), (bottom, upper), (0.02, 0.04), leaf)


def _add_pictures(wall: Wall, length: float, side: float, rng: Generator) -> None:
    for share in (0.25, 0.42):
        width = float(rng.uniform(0.5, 1.0))
        start = _along(share * length, width, length, side)
        along = (start, start + width)
        up = (1.35, 1.35 + float(rng.uniform(0.4, 0.8)))
        wall.box(along, up, (0.0, 0.03), Material("plain", WOODS[rng.integers(len(WOODS))]))
        inner = ((along[0] + 0.05, along[1] - 0.05), (up[0] + 0.05, up[1] - 0.05))
        wall.panel(*inner, 0.032, Material("paint", tuple(rng.uniform(0.2, 0.7, 3).round(3).tolist())))
        for start, end in zip(inner[0], inner[0], strict=True):
            wall.model.edge(wall.at(start, inner[1][0], 0.032), wall.at(end, inner[1][1], 0.032))
        for level in inner[1]:
            wall.model.edge(wall.at(inner[0][0], level, 0.032), wall.at(inner[0][1], level, 0.032))


def _add_shelf(wall: Wall, place: tuple[float, float], high: float, wood: Material, rng: Generator) -> None:
    """A bookcase; `place` is where it starts along the wall and its width."""
    wall.model.start_body("furniture")
    start, width = place
    top, out = min(high - 0.3, 2.1), 0.34
    levels = int(rng.integers(4, 6))
    for side in (start, start + width / 2 - 0.015, start + width - 0.03):
        wall.box((side, side + 0.03), (0.0, top), (0.0, out), wood, "-c -b")
    for level in range(levels + 1):
        up = 0.06 + (top - 0.09) * level / levels
        wall.box((start + 0.03, start + width - 0.03), (up, up + 0.03), (0.0, out - 0.01), wood, "-c -a +a")
        along = start + 0.04
        while level < levels and along < start + width - 0.15:
            thick, tall = float(rng.uniform(0.02, 0.06)), float(rng.uniform(0.5, 0.9)) * (top - 0.09) / levels
            colour = BOOKS[rng.integers(len(BOOKS))]
            if rng.random() < 0.8 and not start + width / 2 - 0.1 < along < start + width / 2 + 0.02:
                box = ((along, along + thick), (up + 0.03, up + 0.03 + tall))
                wall.box(*box, (0.02, out - float(rng.uniform(0.05, 0.12))), Material("plain", colour), "-c -b")
            along += thick + 0.002


def _add_tables(model: Model, side: float, half: float, deep: float, wood: Material, rng: Generator) -> None:
    """A table with legs and a low chest of drawers."""

    def box(low: tuple[float, float, float], size: tuple[float, float, float], material: Material, skip: str) -> None:
        model.box(np.array(low), (size[0] * X, size[1] * Y, size[2] * UP), material, skip)

    model.start_body("furniture")
    x, y = float(rng.uniform(-0.5, 0.1)) * half, float(rng.uniform(0.3, 0.45)) * deep
    wide, long = float(rng.uniform(0.8, 1.1)), float(rng.uniform(1.2, 1.8))
    box((x, y, 0.70), (wide, long, 0.04), wood, "")
    for leg_x in (x + 0.04, x + wide - 0.1):
        for leg_y in (y + 0.04, y + long - 0.1):
            box((leg_x, leg_y, 0.0), (0.06, 0.06, 0.70), wood, "-c +c")
    model.start_body("furniture")
    wall = half if side > 0 else -half + 0.5
    y = 0.8 * deep
    box((wall - 0.5, y, 0.0), (0.5, 1.1, 0.85), wood, "-c")
    for level in range(3):
        front = wall - 0.52 if side > 0 else wall
        box((front, y + 0.04, 0.06 + 0.26 * level), (0.02, 1.02, 0.23), WHITE, "+a" if side > 0 else "-a")
