"""The yard of an old town house: three wings around paving, a basin, stairs and planters."""

from modelling import Model, Surface, WallFrame
from surfaces import blocks, glass, ground, plain, plaster

BACK, LEFT, RIGHT = 15.0, -8.0, 5.2  # m, where the wings stand
TOP = 9.6  # m


def build() -> Model:
    """The faces of the courtyard."""
    model = Model()
    slabs = blocks("#b3a994", "#a2987f", (1.1, 1.1), 1, gap=0.014, bond=0.0, spread=0.05)
    model.face(2, 1, 0.0, (LEFT, RIGHT), (-6, BACK), slabs)
    model.face(2, 1, -0.02, (-60, 60), (-20, 80), ground("#8f887a", 2))
    stone = plain("#d6cbb3", 3, 0.05)
    wings = (
        (WallFrame(model, 0, 1, LEFT), -1.0, BACK, 3.2, 10),
        (WallFrame(model, 1, -1, BACK), LEFT, RIGHT, 3.3, 30),
        (WallFrame(model, 0, -1, RIGHT), -1.0, BACK, 3.2, 50),
    )
    for number, (wall, start, end, spacing, seed) in enumerate(wings):
        _wing(wall, start, end, spacing, seed, stone, has_stairs=number == 1)
    _basin(model, stone)
    _drain(model)
    _things(model)
    return model


def _wing(
    wall: WallFrame, start: float, end: float, spacing: float, seed: int, stone: Surface, has_stairs: bool
) -> None:
    """One wing: an arcade of rectangular openings, two upper floors between pilasters, string courses, a cornice."""
    pale, base = plaster("#e4d3ae", seed), blocks("#cfc3aa", "#bfb39b", (0.95, 0.42), seed + 1, gap=0.016, spread=0.05)
    frame, reveal = plain("#4c5a50", seed + 2), plaster("#e9dfca", seed + 3)
    count = round((end - start) / spacing)
    for index in range(count):
        left = start + index * spacing
        middle = left + spacing / 2
        opening = (middle - 0.62, middle + 0.62)
        if has_stairs and index == 2:
            _portal(wall, middle, reveal, stone)
        elif index % 2 == 0:
            wall.window(opening, (1.05, 2.75), reveal, frame, glass(seed + index), panes=(2, 1), deep=0.25)
            wall.sill(opening, 1.05, stone)
        else:
            wall.hole(opening, (0.0, 2.75), 0.35, reveal, sill=False)
            wall.panel(opening, (0.0, 2.75), -0.35, blocks("#5c452f", "#34261a", (9.0, 0.17), seed + 4, gap=0.01))
            wall.box((middle - 0.03, middle + 0.03), (0.0, 2.2), (-0.35, -0.32), plain("#3d2d1e", seed + 5))
            wall.box(opening, (2.2, 2.3), (-0.35, -0.27), plain("#3d2d1e", seed + 5))
        for bottom, top in ((4.2, 6.0), (7.0, 8.4)):
            along = (middle - 0.55, middle + 0.55)
            wall.window(along, (bottom, top), reveal, frame, glass(seed + index, index % 2 == 1), panes=(1, 2))
            wall.surround(along, (bottom, top), stone, width=0.15)
            if bottom < 5:
                wall.box((along[0] - 0.3, along[1] + 0.3), (top + 0.3, top + 0.42), (0, 0.22), stone)
        if index > 0:
            wall.box((left - 0.17, left + 0.17), (3.6, 8.9), (0, 0.09), stone)
    for low, high, out in ((3.3, 3.6, 0.13), (6.45, 6.57, 0.06), (8.9, 9.1, 0.14), (9.1, 9.35, 0.42)):
        wall.box((start, end), (low, high), (0, out), stone)
    wall.wall((start, end), (0, 3.3), base)
    wall.wall((start, end), (3.3, TOP), pale)


def _portal(wall: WallFrame, middle: float, reveal: Surface, stone: Surface) -> None:
    """A door with a heavy frame at the top of four steps."""
    along = (middle - 0.75, middle + 0.75)
    leaf = plain("#3f5348", 71)
    wall.hole(along, (0.6, 3.0), 0.4, reveal, sill=False)
    wall.panel(along, (0.6, 3.0), -0.4, leaf)
    for left, right in ((along[0] + 0.12, middle - 0.06), (middle + 0.06, along[1] - 0.12)):
        for bottom, top in ((0.8, 1.35), (1.5, 2.7)):
            wall.box((left, right), (bottom, top), (-0.4, -0.36), leaf)
    wall.surround(along, (0.6, 2.98), stone, width=0.24, out=0.1)
    for step in range(4):
        wall.box(
            (middle - 1.15 - 0.12 * (3 - step), middle + 1.15 + 0.12 * (3 - step)),
            (0.15 * step, 0.15 * (step + 1)),
            (0, 0.6 + 0.34 * (3 - step)),
            stone,
        )


def _basin(model: Model, stone: Surface) -> None:
    x0, x1, y0, y1 = -3.3, -0.3, 6.6, 9.2
    water = plain("#33474b", 81, 0.02, mirror=0.6)
    for x, y in (((x0, x1), (y0, y0 + 0.3)), ((x0, x1), (y1 - 0.3, y1))):
        model.box(x, y, (0, 0.55), stone, "-z")
    for x, y in (((x0, x0 + 0.3), (y0 + 0.3, y1 - 0.3)), ((x1 - 0.3, x1), (y0 + 0.3, y1 - 0.3))):
        model.box(x, y, (0, 0.55), stone, "-z-y+y")
    model.face(2, 1, 0.4, (x0 + 0.3, x1 - 0.3), (y0 + 0.3, y1 - 0.3), water)
    model.box((-2.1, -1.5), (7.6, 8.2), (0.4, 1.35), stone, "-z")
    model.box((-2.35, -1.25), (7.35, 8.45), (1.35, 1.5), stone)
    model.box((-1.95, -1.65), (7.75, 8.05), (1.5, 2.1), stone, "-z")
    model.box((-2.05, -1.55), (7.65, 8.15), (2.1, 2.22), stone)


def _drain(model: Model) -> None:
    dark = blocks("#8a8272", "#6f6858", (0.3, 0.3), 85, gap=0.012, bond=0.0, spread=0.06)
    model.box((-5.6, -5.3), (-4, 13.6), (0, 0.012), dark, "-z")
    model.box((2.6, 2.9), (-4, 13.6), (0, 0.012), dark, "-z")


def _things(model: Model) -> None:
    wood, dark = blocks("#8d6d48", "#5b452c", (2.0, 0.13), 91, gap=0.012), plain("#2f3233", 92)
    hedge, pot = ground("#4c6136", 93), plain("#a8643f", 94, 0.06)
    for x, y in ((1.2, 9.6), (1.2, 11.9), (-6.9, 7.0), (-6.9, 9.7)):
        model.box((x, x + 0.7), (y, y + 0.7), (0, 0.6), pot, "-z")
        model.box((x - 0.04, x + 0.74), (y - 0.04, y + 0.74), (0.6, 0.68), pot, "")
        model.box((x + 0.05, x + 0.65), (y + 0.05, y + 0.65), (0.68, 1.55), hedge, "-z")
    model.box((-7.3, -6.85), (11.2, 13.0), (0.42, 0.48), wood)
    for y in (11.35, 12.75):
        model.box((-7.25, -6.9), (y, y + 0.1), (0, 0.42), dark, "-z+z")
    for x, y, size, low in ((1.75, 14.0, 0.8, 0.0), (-1.75, 14.1, 0.75, 0.0), (1.85, 14.1, 0.6, 0.8)):
        model.box((x, x + size), (y, y + size), (low, low + size), wood, "-z")
        model.box((x - 0.02, x + size + 0.02), (y - 0.02, y), (low, low + 0.1), wood)
        model.box((x - 0.02, x + size + 0.02), (y - 0.02, y), (low + size - 0.1, low + size), wood)
    pipe = plain("#6b706d", 95)
    model.box((LEFT + 0.03, LEFT + 0.14), (14.7, 14.81), (0, 8.9), pipe, "-z+z")
    model.box((RIGHT - 0.14, RIGHT - 0.03), (14.7, 14.81), (0, 8.9), pipe, "-z+z")
