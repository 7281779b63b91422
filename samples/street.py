"""A street between houses, closed by a building across its end."""

import numpy as np

from modelling import Model, Surface, WallFrame
from surfaces import blocks, boards, glass, ground, plain, plaster

PAVEMENT = 0.14  # m above the road


def build() -> Model:
    """The faces of the street."""
    model = Model()
    _road(model)
    _brick_house(WallFrame(model, 0, -1, 6.0))
    _ochre_house(model, WallFrame(model, 0, -1, 5.2))
    _end_building(WallFrame(model, 1, -1, 25.0))
    _left_row(WallFrame(model, 0, 1, -4.2))
    _furniture(model)
    return model


def _road(model: Model) -> None:
    asphalt, kerb = ground("#5d5c5b", 1), blocks("#a9a59d", "#4a4844", (1.0, 9.0), 2, swap=True)
    slabs = blocks("#a39d92", "#8a847a", (0.6, 0.6), 3, gap=0.01, bond=0.5, spread=0.06)
    model.face(2, 1, 0.0, (-40, 40), (-6, 70), asphalt)
    for kerb_x, walk_x in (((3.3, 3.5), (3.5, 6.6)), ((-2.4, -2.2), (-4.2, -2.4))):
        model.box(kerb_x, (-4, 22.6), (0, PAVEMENT), kerb, "-z")
        model.face(2, 1, PAVEMENT, walk_x, (-4, 25), slabs)
    model.box((-2.4, 3.5), (22.6, 22.8), (0, PAVEMENT), kerb, "-z")
    model.face(2, 1, PAVEMENT, (-2.4, 3.5), (22.8, 25), slabs)
    paint = ground("#c9c7c0", 9)
    for stripe in range(6):
        model.box((0.2, 0.32), (3.6 + 3.0 * stripe, 5.2 + 3.0 * stripe), (0, 0.004), paint, "-z")
    for x in np.arange(-1.9, 3.0, 0.95):
        model.box((x, x + 0.5), (8.6, 11.0), (0, 0.004), paint, "-z")
    iron = plain("#4a4947", 8)
    model.box((1.3, 2.0), (6.6, 7.3), (0, 0.006), iron, "-z")


def _brick_house(wall: WallFrame) -> None:
    bricks = blocks("#8f5645", "#88664f", (0.25, 0.078), 11, gap=0.011, spread=0.09)
    stone, white = plain("#c4b79f", 12, 0.06), plain("#e6e2d8", 13)
    dark, reveal = plain("#29382f", 14), plaster("#cfc6b4", 15)
    bays = [4.4 + 2.25 * index for index in range(4)]
    for index, start in enumerate(bays):
        along = (start, start + 1.1)
        if index == 1:
            _door(wall, along, reveal, dark, stone)
        else:
            shop = (start - 0.25, start + 1.35)
            wall.window(shop, (0.85, 2.75), reveal, dark, glass(40 + index, False), panes=(2, 1), deep=0.22, bar=0.08)
            wall.sill(shop, 0.85, stone, out=0.16)
            wall.box((shop[0] - 0.1, shop[1] + 0.1), (2.75, 3.05), (0, 0.08), dark)
        for bottom, top in ((3.95, 5.65), (6.6, 8.1)):
            wall.window(along, (bottom, top), reveal, white, glass(50 + index, index % 2 == 0), panes=(2, 1))
            wall.sill(along, bottom, stone)
            wall.box((along[0] - 0.12, along[1] + 0.12), (top, top + 0.2), (0, 0.05), stone)
    wall.box((3.0, 4.2), (PAVEMENT, 0.6), (0, 0.07), stone)
    wall.box((3.0, 13.0), (3.3, 3.55), (0, 0.12), stone)
    wall.box((3.0, 13.0), (6.05, 6.17), (0, 0.05), stone)
    wall.box((3.0, 13.0), (8.5, 8.7), (0, 0.16), stone)
    wall.box((3.0, 13.0), (8.7, 8.95), (0, 0.34), stone)
    wall.box((12.72, 12.84), (PAVEMENT, 8.5), (0.03, 0.14), plain("#59605f", 18), skip_back=False)
    wall.wall((3.0, 13.0), (0, 9.2), bricks)


def _door(wall: WallFrame, along: tuple[float, float], reveal: Surface, leaf: Surface, stone: Surface) -> None:
    """A door with a light above it, two rows of panels, two steps before it."""
    wall.hole(along, (PAVEMENT, 2.95), 0.3, reveal, sill=False)
    wall.panel(along, (PAVEMENT, 2.95), -0.3, leaf)
    middle = (along[0] + along[1]) / 2
    for left, right in ((along[0] + 0.09, middle - 0.05), (middle + 0.05, along[1] - 0.09)):
        for bottom, top in ((0.35, 1.0), (1.12, 2.2)):
            wall.box((left, right), (bottom, top), (-0.3, -0.265), leaf)
    wall.box(along, (2.35, 2.43), (-0.3, -0.22), leaf)
    wall.surround(along, (PAVEMENT, 2.95), stone)
    wall.box((along[0] - 0.25, along[1] + 0.25), (PAVEMENT, PAVEMENT + 0.13), (0, 0.55), stone)
    wall.box((along[0] - 0.1, along[1] + 0.1), (PAVEMENT + 0.13, PAVEMENT + 0.26), (0, 0.28), stone)


def _ochre_house(model: Model, wall: WallFrame) -> None:
    ochre, stone = plaster("#cdb07a", 21), plain("#d9d2c3", 22, 0.05)
    base = blocks("#b9ad97", "#a39780", (0.8, 0.4), 23, gap=0.02, spread=0.05)
    white, reveal = plain("#f0eee8", 24), plaster("#e5dfd1", 25)
    start, end, top = 13.0, 21.4, 10.3
    bays = [start + 0.85 + 2.45 * index for index in range(3)]
    for index, left in enumerate(bays):
        along = (left + 0.12, left + 1.2)
        if index == 1:
            _door(wall, along, reveal, plain("#5b2f22", 26), stone)
        else:
            wall.window(along, (1.1, 2.7), reveal, white, glass(60 + index), panes=(1, 1))
            wall.sill(along, 1.1, stone)
        for bottom, upper in ((3.9, 5.9), (7.0, 8.7)):
            wall.window(along, (bottom, upper), reveal, white, glass(70 + index, index % 2 == 1), panes=(1, 1))
            if bottom > 5 or index != 1:
                wall.sill(along, bottom, stone)
    wall.box((bays[1] - 0.6, bays[1] + 1.9), (3.62, 3.8), (0, 0.95), stone)
    parapet = plain("#3b4044", 27)
    wall.box((bays[1] - 0.6, bays[1] + 1.9), (3.8, 4.6), (0.84, 0.9), parapet, skip_back=False)
    wall.box((bays[1] - 0.64, bays[1] + 1.94), (4.6, 4.68), (0.8, 0.94), stone, skip_back=False)
    for left in (start, end - 0.5):
        wall.box((left, left + 0.5), (3.55, 9.6), (0, 0.07), stone)
    wall.box((start, end), (3.3, 3.55), (0, 0.1), stone)
    wall.box((start, end), (6.4, 6.55), (0, 0.08), stone)
    wall.box((start, end), (9.6, 9.85), (0, 0.14), stone)
    wall.box((start, end), (9.85, 10.1), (0, 0.38), stone)
    wall.wall((start, end), (0, 3.3), base)
    wall.wall((start, end), (3.3, top), ochre)
    model.face(1, -1, start, (5.2, 14), (0, top), ochre)
    corner = WallFrame(model, 0, -1, 6.5)
    for left in (21.9, 23.4):
        for bottom in (1.0, 4.0):
            corner.window((left, left + 0.9), (bottom, bottom + 1.6), reveal, white, glass(80), panes=(2, 1))
            corner.sill((left, left + 0.9), bottom, stone)
    corner.box((21.4, 25), (3.2, 3.4), (0, 0.1), stone)
    corner.box((21.4, 25), (6.7, 7.0), (0, 0.3), stone)
    corner.wall((21.4, 25), (0, 7.3), plaster("#b9c3b4", 28))


def _end_building(wall: WallFrame) -> None:
    cream, stone = plaster("#e3dac4", 31), plain("#cbbfa6", 32, 0.05)
    base = blocks("#c2b69d", "#ab9f88", (0.9, 0.45), 33, gap=0.02, spread=0.05)
    frame, reveal = plain("#54432f", 34), plaster("#ece6d6", 35)
    bays = [-3.7 + 2.55 * index for index in range(4)]
    for index, left in enumerate(bays):
        along = (left, left + 1.2)
        if index == 2:
            gate = (left - 0.35, left + 1.55)
            wall.hole(gate, (PAVEMENT, 3.0), 0.5, reveal, sill=False)
            wall.panel(gate, (PAVEMENT, 3.0), -0.5, blocks("#4b3a28", "#241a10", (9.0, 0.2), 36, gap=0.012))
            wall.surround(gate, (PAVEMENT, 3.0), stone, width=0.3, out=0.08)
        else:
            wall.window(along, (1.2, 2.9), reveal, frame, glass(90 + index), panes=(1, 2))
            wall.sill(along, 1.2, stone)
        for bottom, top in ((4.2, 6.1), (7.2, 8.7)):
            wall.window(along, (bottom, top), reveal, frame, glass(100 + index, index % 3 == 0), panes=(2, 1))
            wall.surround(along, (bottom, top), stone)
    wall.box((-9, 6.5), (3.55, 3.8), (0, 0.12), stone)
    wall.box((-9, 6.5), (6.7, 6.85), (0, 0.08), stone)
    wall.box((-9, 6.5), (9.2, 9.45), (0, 0.16), stone)
    wall.box((-9, 6.5), (9.45, 9.7), (0, 0.4), stone)
    wall.wall((-9, 6.5), (0, 3.55), base)
    wall.wall((-9, 6.5), (3.55, 10.0), cream)


def _left_row(wall: WallFrame) -> None:
    grey, stone = plaster("#a7aeb5", 41), plain("#d5d2ca", 42, 0.05)
    white, reveal = plain("#eceae4", 43), plaster("#c9ccce", 44)
    for index in range(5):
        left = 6.6 + 3.8 * index
        along = (left, left + 1.5)
        for bottom, top in ((1.0, 2.7), (4.0, 5.8), (6.9, 8.3)):
            wall.window(along, (bottom, top), reveal, white, glass(110 + index, index % 2 == 0), panes=(1, 1))
            wall.sill(along, bottom, stone)
    wall.box((4, 25), (PAVEMENT, 0.55), (0, 0.06), stone)
    wall.box((4, 25), (3.35, 3.55), (0, 0.1), stone)
    wall.box((4, 25), (6.3, 6.42), (0, 0.07), stone)
    wall.box((4, 25), (8.9, 9.2), (0, 0.35), stone)
    wall.wall((4, 25), (0, 9.4), grey)


def _furniture(model: Model) -> None:
    iron, wood = plain("#2c2f31", 51), boards("#8a6a45", 0.1, 52, along_second=True)
    for y in (7.0, 10.6, 14.2, 17.8):
        model.box((3.62, 3.76), (y, y + 0.14), (PAVEMENT, 1.0), iron, "-z")
        model.box((3.6, 3.78), (y - 0.02, y + 0.16), (1.0, 1.06), iron)
    model.box((4.9, 5.3), (8.9, 10.5), (0.55, 0.61), wood)
    for y in (9.05, 10.25):
        model.box((4.95, 5.25), (y, y + 0.1), (PAVEMENT, 0.55), iron, "-z+z")
    model.box((5.3, 5.36), (8.9, 10.5), (0.72, 1.0), wood)
    for y in (9.05, 10.25):
        model.box((5.3, 5.36), (y, y + 0.1), (0.61, 0.72), iron)
    model.box((-2.75, -2.63), (12.0, 12.12), (PAVEMENT, 4.6), iron, "-z")
    model.box((-2.95, -2.43), (11.8, 12.32), (4.6, 4.66), iron)
    model.box((-2.85, -2.53), (11.9, 12.22), (4.66, 5.1), plain("#e9e4cf", 53))
    model.box((-2.95, -2.43), (11.8, 12.32), (5.1, 5.16), iron)
