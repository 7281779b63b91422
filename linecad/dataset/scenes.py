"""Scenes of all kinds, drawn at random: streets and courtyards, and the view of each."""

from collections.abc import Callable
from typing import Literal, get_args

import numpy as np
from numpy.random import Generator

from linecad.arrays import Float
from linecad.dataset.facades import draw_style
from linecad.dataset.furniture import add_car, add_traffic, add_tree
from linecad.dataset.gardens import build_gardens
from linecad.dataset.houses import add_building
from linecad.dataset.interior import build_room
from linecad.dataset.modelling import UP, Material, Model, X, Y
from linecad.dataset.towns import build_town
from linecad.dataset.view import View

SceneKind = Literal["street", "courtyard", "room", "town", "garden"]
SCENE_KINDS: tuple[SceneKind, ...] = get_args(SceneKind)
OF_TEN: tuple[SceneKind, ...] = (*("street",) * 8, "courtyard", "room")  # the kinds of scenes 0 to 9, 10 to 19 ...

CAMERA_HEIGHT = (1.5, 2.0)  # m above the road, as in a car
YAW = (0.15, 0.6)  # rad, to the left or right
PITCH = (0.0, 0.12)  # rad, upwards
ROLL = 0.012  # rad, one standard deviation
FOCAL = (0.64, 0.68)  # of the photo's width
OFF_CENTRE = 0.006  # of the width, one standard deviation of the principal point
KERB = 0.14  # m

ASPHALT = Material("asphalt", (0.36, 0.36, 0.37))
SLABS = Material("slabs", (0.62, 0.60, 0.57))
STONE = Material("plain", (0.66, 0.64, 0.60))
PAINT = Material("plain", (0.86, 0.86, 0.84))


def scene_kind(index: int) -> SceneKind:
    """Of every ten scenes eight are streets, one is a courtyard and one a room."""
    return OF_TEN[index % len(OF_TEN)]


def draw_scene(kind: SceneKind, rng: Generator) -> tuple[Model, View]:
    """A scene of a kind and the view of it; the same numbers from `rng` give the same scene."""
    build: Callable[[Generator], tuple[Model, Float, float]]
    build = {
        "street": _street, "courtyard": _courtyard, "room": build_room, "town": build_town, "garden": build_gardens,
    }[kind]  # fmt: skip
    model, eye, side = build(rng)
    view = View(
        eye=eye,
        yaw=side * float(rng.uniform(*YAW)),
        pitch=float(rng.uniform(*PITCH)) * (0.3 if kind == "room" else 1.0),
        roll=float(rng.normal(0, ROLL)),
        focal=float(rng.uniform(*FOCAL)),
        off_centre=(float(rng.normal(0, OFF_CENTRE)), float(rng.normal(0, OFF_CENTRE))),
    )
    return model, view


def _street(rng: Generator) -> tuple[Model, Float, float]:
    """A street of houses on both sides, most often with a side street, closed by houses far away."""
    model = Model()
    side = float(rng.choice([-1.0, 1.0]))
    road, walk = float(rng.uniform(4.5, 7.0)), float(rng.uniform(2.0, 3.5))
    eye = np.array([rng.uniform(-0.4, 0.4) * road, 0.0, rng.uniform(*CAMERA_HEIGHT)])
    end = float(rng.uniform(40, 80))
    for sign in (-1.0, 1.0):
        crossing = float(rng.uniform(22, 55))
        y = float(rng.uniform(-18, -10))
        while y < end:
            width, height = float(rng.uniform(10, 22)), float(rng.uniform(8.5, 21))
            setback = float(rng.choice([0.0, 0.0, 0.4, 0.9, 1.8, 3.5]))
            front, deep = sign * (road + walk + setback), float(rng.uniform(9, 14))
            across = (min(front, front + sign * deep), max(front, front + sign * deep))
            add_building(model, across, (y, y + width), (0.0, height), {"+x" if sign < 0 else "-x", "-y"}, rng)
            y += width
            if y > crossing:
                y += float(rng.uniform(7, 12))
                crossing = np.inf
            elif rng.random() < 0.25:
                y += float(rng.uniform(1.5, 5))
    start = -float(rng.uniform(25, 35))
    while start < 35:
        width, height = float(rng.uniform(12, 24)), float(rng.uniform(10, 22))
        add_building(model, (start, start + width), (end + 12, end + 24), (0.0, height), {"-y"}, rng)
        start += width
    _add_road(model, road, end + 12)
    add_traffic(model, road, rng)
    return model, eye, side


def _add_road(model: Model, road: float, end: float) -> None:
    """The road with its kerbs, pavements and markings, from behind the camera to the end of the street."""
    model.start_body("ground")
    start, length = -30 * Y, (end + 60) * Y
    model.quad(-road * X + start, 2 * road * X, length, ASPHALT)
    for sign in (-1.0, 1.0):
        edge = sign * road * X + start
        model.quad(edge, length, KERB * UP, STONE)
        model.quad(edge + KERB * UP, 0.25 * sign * X, length, STONE)
        model.quad(edge + KERB * UP + 0.25 * sign * X, 60 * sign * X, length, SLABS)
        for line in (edge, edge + KERB * UP, edge + KERB * UP + 0.25 * sign * X):
            model.edge(line, line + length)
    for index in range(-2, int(end / 6)):
        model.outline((6.0 * index) * Y - 0.07 * X + 0.004 * UP, 0.14 * X, 3.0 * Y, PAINT)


def _courtyard(rng: Generator) -> tuple[Model, Float, float]:
    """A paved court between four wings, with a porch before the far one, steps, a tree and perhaps a car."""
    model = Model()
    side = float(rng.choice([-1.0, 1.0]))
    half, deep = float(rng.uniform(8, 13)), float(rng.uniform(18, 28))
    height = float(rng.uniform(9, 16))
    main = draw_style(rng)
    for sign in (-1.0, 1.0):
        x = (half, half + 9) if sign > 0 else (-half - 9, -half)
        wing = main if rng.random() < 0.5 else None
        tall = height + float(rng.uniform(-2, 2))
        add_building(model, x, (-8.0, deep), (0.0, tall), {"-x" if sign > 0 else "+x"}, rng, wing)
    add_building(model, (-half - 9, half + 9), (deep, deep + 10), (0.0, height + 3), {"-y"}, rng, main)
    add_building(model, (-half - 9, half + 9), (-18, -8), (0.0, height), {"+y"}, rng, main)
    middle = float(rng.uniform(-0.35, 0.35)) * half
    low, out = float(rng.uniform(5.5, 7.5)), float(rng.uniform(2.5, 4.0))
    add_building(model, (middle - 3.4, middle + 3.4), (deep - out, deep), (0.0, low), {"-x", "+x", "-y"}, rng)
    model.start_body("ground")
    model.quad(np.array([-half - 10, -20.0, 0.0]), (2 * half + 20) * X, (deep + 32) * Y, SLABS)
    for step in range(3):
        corner = np.array([middle - 2.0 + 0.3 * step, deep - out - 1.4 + 0.35 * step, 0.13 * step])
        model.box(corner, ((4 - 0.6 * step) * X, (1.4 - 0.35 * step) * Y, 0.13 * UP), STONE, "-c +b")
    add_tree(model, -side * 0.5 * half, 0.45 * deep, float(rng.uniform(5, 7)), 1100, rng)
    if rng.random() < 0.6:
        add_car(model, side * 0.6 * half, 0.5 * deep, float(rng.normal(0, 0.05)), rng)
    eye = np.array([-side * rng.uniform(0.1, 0.4) * half, rng.uniform(-6, -3), rng.uniform(*CAMERA_HEIGHT)])
    return model, eye, side
