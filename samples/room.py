"""A living room with a window, a door, shelves, a table and chairs."""

import numpy as np

from lighting import Lamp
from modelling import Hits, Model, Surface, WallFrame
from surfaces import blocks, boards, linear, plain, plaster

LEFT, RIGHT, FRONT, BACK, CEILING = -2.5, 2.3, -1.4, 4.1, 2.65  # m
WINDOW = ((1.75, 3.15), (0.9, 2.25))  # m, y and z
AMBIENT = (0.50, 0.48, 0.45)
LAMPS = [
    Lamp(0, 1, LEFT - 0.2, (WINDOW[0][0], WINDOW[1][0]), (WINDOW[0][1], WINDOW[1][1]), (13.0, 13.6, 14.4)),
    # A second window behind the camera, never seen, that lights what faces it
    Lamp(1, 1, FRONT + 0.05, (-1.2, 1.6), (0.8, 2.3), (2.6, 2.6, 2.6)),
]


def build() -> Model:
    """The faces of the room."""
    model = Model()
    wall_paint, white = plaster("#d9d3c3", 1, 0.02, 0.02), plain("#efece4", 2, 0.015)
    model.face(2, 1, 0.0, (LEFT, RIGHT), (FRONT, BACK), boards("#a8794d", 0.19, 3, along_second=True))
    model.face(2, -1, CEILING, (LEFT, RIGHT), (FRONT, BACK), plaster("#f0eee9", 4, 0.01, 0.02))
    left, back = WallFrame(model, 0, 1, LEFT), WallFrame(model, 1, -1, BACK)
    right, front = WallFrame(model, 0, -1, RIGHT), WallFrame(model, 1, 1, FRONT)
    _window(left, white)
    _door(back, white)
    for wall, along in ((left, (FRONT, BACK)), (back, (LEFT, RIGHT)), (right, (FRONT, BACK)), (front, (LEFT, RIGHT))):
        wall.wall(along, (0, CEILING), wall_paint)
    _mouldings(left, back, right, white)
    _shelf(model)
    _sideboard(model)
    _pictures(back)
    _table(model)
    _lamp(model)
    return model


def _outside() -> Surface:
    """What is seen through the window: a bright sky over a hedge."""
    sky_colour, green = linear("#cfe0f2"), linear("#7f9a63")

    def albedo(hits: Hits) -> np.ndarray:
        share = np.clip((hits.v - 1.25) / 0.25, 0, 1)[:, None]
        return green * (1 - share) + sky_colour * share

    return Surface(albedo, glow=1.9, casts=False)


def _window(wall: WallFrame, white: Surface) -> None:
    along, up = WINDOW
    wall.window(along, up, white, white, _outside(), panes=(2, 2), deep=0.2, bar=0.07)
    wall.box((along[0] - 0.1, along[1] + 0.1), (up[0] - 0.05, up[0]), (0, 0.16), white)
    wall.surround(along, up, white, width=0.1, out=0.025)
    radiator = plain("#e9e7e1", 12, 0.01)
    wall.box((along[0] + 0.1, along[1] - 0.1), (0.15, 0.72), (0.04, 0.1), radiator, skip_back=False)
    for left in np.linspace(along[0] + 0.1, along[1] - 0.18, 7):
        wall.box((left, left + 0.08), (0.18, 0.69), (0.1, 0.125), radiator)


def _door(wall: WallFrame, white: Surface) -> None:
    along, up = (0.95, 1.8), (0.0, 2.05)
    wall.hole(along, up, 0.12, white)
    wall.panel(along, up, -0.12, white)
    for bottom, top in ((0.2, 0.85), (1.05, 1.9)):
        for left, right in ((along[0] + 0.1, 1.34), (1.41, along[1] - 0.1)):
            wall.box((left, right), (bottom, top), (-0.12, -0.1), plain("#e2ded3", 13, 0.01))
    wall.surround(along, up, white, width=0.11, out=0.03)
    wall.box((along[0] + 0.04, along[0] + 0.16), (1.0, 1.03), (-0.12, -0.06), plain("#8c8a86", 14))


def _mouldings(left: WallFrame, back: WallFrame, right: WallFrame, white: Surface) -> None:
    """Skirting boards, a rail at the height of a chair back, and a cornice."""
    for wall, pieces in (
        (left, [(FRONT, BACK)]),
        (back, [(LEFT, 0.84), (1.91, RIGHT)]),
        (right, [(FRONT, BACK)]),
    ):
        for piece in pieces:
            wall.box(piece, (0, 0.11), (0, 0.02), white)
        ends = (pieces[0][0], pieces[-1][1])
        wall.box(ends, (CEILING - 0.12, CEILING), (0, 0.05), white)
        wall.box(ends, (CEILING - 0.05, CEILING), (0.05, 0.11), white)


def _shelf(model: Model) -> None:
    """A bookcase in the left corner of the back wall, its boards, and books of many colours."""
    wood = boards("#7b5636", 0.3, 21, along_second=True, length=3.0)
    x0, x1, y0, y1, top = -2.3, -1.0, BACK - 0.34, BACK, 2.12
    for x in (x0, x1 - 0.03):
        model.box((x, x + 0.03), (y0, y1), (0, top), wood, "+y-z")
    levels = np.linspace(0.08, top - 0.03, 6)
    for level in levels:
        model.box((x0 + 0.03, x1 - 0.03), (y0, y1), (level, level + 0.03), wood, "+y-x+x")
    model.face(1, -1, y1 - 0.01, (x0 + 0.03, x1 - 0.03), (0.08, top), plain("#5d4028", 22))
    rng = np.random.default_rng(11)
    colours = ("#7a2f2b", "#2f4a63", "#c9b98d", "#3f5a41", "#a8703a", "#d8d2c4", "#4d3b57", "#8a8f93", "#b3443a")
    for level in levels[:-1]:
        x = x0 + 0.05
        while x < x1 - 0.12 - 0.3 * rng.random():
            width, height, deep = rng.uniform(0.045, 0.1), rng.uniform(0.2, 0.33), rng.uniform(0.16, 0.24)
            paint = plain(colours[rng.integers(len(colours))], int(rng.integers(90)), 0.02)
            model.box(
                (x, x + width), (y1 - deep - 0.02, y1 - 0.01), (level + 0.03, level + 0.03 + height), paint, "+y-z"
            )
            x += width + 0.002


def _sideboard(model: Model) -> None:
    body, handle = plain("#b9b2a2", 31, 0.02), plain("#4b4a48", 32)
    x0, x1, y0 = -0.75, 0.7, BACK - 0.45
    model.box((x0, x1), (y0, BACK), (0.12, 0.82), body, "+y")
    model.box(
        (x0 - 0.02, x1 + 0.02), (y0 - 0.02, BACK), (0.82, 0.86), boards("#8a6540", 0.4, 33, along_second=False), "+y"
    )
    for x in (x0 + 0.05, x1 - 0.1):
        model.box((x, x + 0.05), (y0 + 0.03, y0 + 0.08), (0, 0.12), handle, "-z+z")
    third = (x1 - x0) / 3
    for index in range(3):
        left = x0 + index * third
        for bottom, top in ((0.15, 0.56), (0.58, 0.8)):
            model.box((left + 0.015, left + third - 0.015), (y0 - 0.018, y0), (bottom, top), body, "+y")
            model.box(
                (left + third / 2 - 0.06, left + third / 2 + 0.06),
                (y0 - 0.04, y0 - 0.018),
                (top - 0.06, top - 0.04),
                handle,
            )
    model.box((-0.6, -0.42), (3.8, 3.98), (0.86, 1.16), plain("#3e6470", 34), "-z")
    model.box((0.25, 0.6), (3.78, 4.0), (0.86, 0.9), plain("#7a2f2b", 35), "-z")
    model.box((0.28, 0.58), (3.8, 3.99), (0.9, 0.935), plain("#c9b98d", 36), "-z")


def _pictures(wall: WallFrame) -> None:
    frame, mat = plain("#2d2722", 41), plain("#efece3", 42, 0.01)
    prints = (plain("#8aa0a8", 43, 0.5), plain("#b58d5b", 44, 0.5), plain("#6d7d55", 45, 0.5))
    for left, bottom, width, height, paint in (
        (-0.7, 1.32, 0.42, 0.56, prints[0]),
        (-0.16, 1.32, 0.62, 0.42, prints[1]),
        (-0.16, 1.8, 0.3, 0.3, prints[2]),
    ):
        right, top = left + width, bottom + height
        wall.box((left, right), (bottom, top), (0, 0.025), frame)
        wall.panel((left + 0.025, right - 0.025), (bottom + 0.025, top - 0.025), 0.0251, mat)
        wall.panel((left + 0.09, right - 0.09), (bottom + 0.09, top - 0.09), 0.0252, paint)


def _table(model: Model) -> None:
    oak = boards("#9c7346", 0.22, 51, along_second=False, length=2.4)
    leg = plain("#8f673d", 55, 0.06)
    rug = blocks("#8c4f45", "#c8b391", (0.7, 0.7), 52, gap=0.05, bond=0.0, spread=0.05)
    model.box((-1.75, 0.35), (1.2, 3.1), (0, 0.012), rug, "-z")
    x0, x1, y0, y1 = -1.3, 0.0, 1.75, 2.55
    model.box((x0, x1), (y0, y1), (0.71, 0.75), oak)
    model.box((x0 + 0.06, x1 - 0.06), (y0 + 0.06, y1 - 0.06), (0.62, 0.71), leg, "+z")
    for x in (x0 + 0.05, x1 - 0.12):
        for y in (y0 + 0.05, y1 - 0.12):
            model.box((x, x + 0.07), (y, y + 0.07), (0.012, 0.71), leg, "-z+z")
    _chair(model, -0.35, 2.62, 1)
    _chair(model, -1.15, 2.62, 1)
    _chair(model, -0.62, 1.22, -1)
    model.box((-0.95, -0.55), (2.05, 2.33), (0.75, 0.775), plain("#d7d2c6", 53), "-z")
    model.box((-0.35, -0.19), (2.2, 2.36), (0.75, 0.98), plain("#ccd6d4", 54), "-z")


def _chair(model: Model, x: float, y: float, side: int) -> None:
    """A chair whose back is on the far side (1) or on the near side (-1)."""
    wood = plain("#6a4a2f", 61, 0.05)
    size, seat = 0.42, 0.45
    model.box((x, x + size), (y, y + size), (seat, seat + 0.035), wood)
    back = y + size - 0.035 if side > 0 else y
    for left in (x, x + size - 0.035):
        for near in (y, y + size - 0.035):
            model.box((left, left + 0.035), (near, near + 0.035), (0, seat), wood, "-z+z")
        model.box((left, left + 0.035), (back, back + 0.035), (seat + 0.035, 0.92), wood, "-z")
    for low in (0.62, 0.82):
        model.box((x + 0.035, x + size - 0.035), (back + 0.006, back + 0.026), (low, low + 0.08), wood, "-x+x")


def _lamp(model: Model) -> None:
    shade, cord = plain("#e8dfc8", 71, 0.01), plain("#333333", 72)
    glowing = Surface(shade.albedo, glow=0.5)
    model.box((-0.66, -0.65), (2.14, 2.15), (1.98, CEILING), cord, "-z+z")
    model.box((-0.86, -0.44), (1.94, 2.36), (1.74, 1.98), glowing)
