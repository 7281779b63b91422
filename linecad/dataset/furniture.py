"""What stands in streets and hides the houses: cars, trees and lamp posts, all of flat parallelograms."""

import numpy as np
from numpy.random import Generator

from linecad.arrays import Float
from linecad.dataset.modelling import UP, Material, Model, Point

PAINTS = ((0.55, 0.12, 0.12), (0.15, 0.24, 0.42), (0.74, 0.75, 0.76), (0.14, 0.14, 0.15), (0.86, 0.86, 0.84))
LEAVES = ((0.26, 0.36, 0.15), (0.33, 0.43, 0.19), (0.20, 0.29, 0.14))
WINDSCREEN = Material("glass", (0.10, 0.12, 0.13))
RUBBER = Material("plain", (0.09, 0.09, 0.10))
BARK = Material("plain", (0.33, 0.27, 0.22))
IRON = Material("plain", (0.20, 0.21, 0.22))

# Silhouettes of cars seen from the side: metres along and up, from the rear bumper over the roof to the front one.
SALOON = ((0.0, 0.28), (0.05, 0.82), (0.75, 0.95), (1.35, 1.40), (2.65, 1.42), (3.35, 0.98), (4.2, 0.78), (4.3, 0.28))
VAN = ((0.0, 0.30), (0.0, 1.05), (0.12, 1.92), (3.3, 1.95), (3.95, 1.15), (4.6, 0.95), (4.7, 0.30))
WINDOWS = {SALOON: (2, 4), VAN: (1, 3)}  # pieces of the silhouette that are glass
CAR_WIDTH = 1.76  # m
GROUND_CLEARANCE = 0.28  # m, under a car
WHEEL = 0.31  # m, radius
LEAF_SIZE = (0.10, 0.24)  # m
CLIPPED_SIZE, BUSH_LEAVES = (0.05, 0.12), 200  # m, of hedges and bushes
SHADES = (0.75, 1.0, 1.25)  # of leaves; more would each be a material


def add_car(model: Model, x: float, y: float, turn: float, rng: Generator) -> None:
    """A parked car, `turn` rad away from the street's direction."""
    model.start_body("car")
    paint = Material("paint", PAINTS[rng.integers(len(PAINTS))])
    outline = VAN if rng.random() < 0.3 else SALOON
    forward = np.array([np.sin(turn), np.cos(turn), 0.0])
    across = CAR_WIDTH * np.array([np.cos(turn), -np.sin(turn), 0.0])
    corner = np.array([x, y, 0.0]) - across / 2 - outline[-1][0] / 2 * forward
    profile = np.array([corner + along * forward + up * UP for along, up in outline])
    glazed = WINDOWS[outline]
    model.sweep(profile, across, [WINDSCREEN if piece in glazed else paint for piece in range(len(outline) - 1)])
    model.quad(profile[0], profile[-1] - profile[0], across, RUBBER)
    for side in (0.0, 1.0):
        _add_flank(model, corner + side * across, forward, outline, paint)
        off = (2 * side - 1) * 0.012 / CAR_WIDTH * across
        _add_side_windows(model, corner + side * across + off, forward, outline)
        for along in (0.85, outline[-1][0] - 0.85):
            _add_wheel(model, corner + side * across + off + along * forward + WHEEL * UP, forward)


def _add_flank(
    model: Model, corner: Float, forward: Float, outline: tuple[tuple[float, float], ...], paint: Material
) -> None:
    """A side of a car: its silhouette has no parallelograms, so many thin upright ones fill it."""
    along, up = np.array(sorted(outline)).T
    cuts = np.linspace(along[0], along[-1], 66)
    tops = np.maximum(np.interp(cuts, along, up), GROUND_CLEARANCE + 0.1)
    for start, end, top, next_top in zip(cuts[:-1], cuts[1:], tops[:-1], tops[1:], strict=True):
        slope = (end - start) * forward + (next_top - top) * UP
        down = (GROUND_CLEARANCE - min(top, next_top)) * UP
        model.quad(corner + start * forward + top * UP, slope, down, paint)


def _add_side_windows(model: Model, corner: Float, forward: Float, outline: tuple[tuple[float, float], ...]) -> None:
    roof_start, roof_end = (outline[3], outline[4]) if outline is SALOON else (outline[2], outline[3])
    low, high = (0.98, roof_start[1] - 0.07) if outline is SALOON else (1.15, roof_start[1] - 0.14)
    length = roof_end[0] - roof_start[0]
    pieces = 2 if outline is SALOON else 3
    for index in range(pieces):
        start = roof_start[0] + (index + 0.04) * length / pieces
        foot = corner + start * forward + low * UP
        model.outline(foot, 0.92 * length / pieces * forward, (high - low) * UP, WINDSCREEN)


def _add_wheel(model: Model, middle: Float, forward: Float) -> None:
    """A wheel as a fan of rectangles through its middle: together a polygon of sixteen corners, drawn flat."""
    for angle in np.arange(8) * np.pi / 8 + np.pi / 16:
        half = np.cos(angle) * forward + np.sin(angle) * UP
        other = np.cos(angle) * UP - np.sin(angle) * forward
        width = WHEEL * np.tan(np.pi / 16)
        model.quad(middle - WHEEL * half - width * other, 2 * WHEEL * half, 2 * width * other, RUBBER)


def add_tree(model: Model, x: float, y: float, height: float, leaves: int, rng: Generator) -> None:
    """A trunk with six sides under a crown of small leaves that lie in all directions.

    The edges of the trunk are edges of the scene; the outlines of the leaves are too short to be lines and are none.
    """
    model.start_body("tree")
    foot = np.array([x, y, 0.0])
    ring = np.arange(7) * np.pi / 3 + rng.uniform(0, 1)
    trunk = foot + 0.13 * np.column_stack([np.cos(ring), np.sin(ring), np.zeros(7)])
    model.sweep(trunk, 0.6 * height * UP, [BARK] * 6)
    clusters = rng.normal(0, 1, (10, 3)) * (0.17 * height, 0.17 * height, 0.13 * height) + 0.74 * height * UP
    for _ in range(leaves):
        middle = foot + clusters[rng.integers(len(clusters))] + rng.normal(0, 0.08 * height, 3)
        normal, across = rng.normal(0, 1, 3), rng.normal(0, 1, 3)
        first = np.cross(normal, across)
        first /= np.linalg.norm(first)
        second = np.cross(first, normal)
        second /= np.linalg.norm(second)
        size = rng.uniform(*LEAF_SIZE)
        material = Material("leaves", LEAVES[rng.integers(len(LEAVES))])
        model.quad(middle, size * first, 0.6 * size * second, material)


def add_lamp(model: Model, x: float, y: float, height: float, towards: float) -> None:
    """A post with an arm and a lamp; the arm points to x = `towards`."""
    model.start_body("lamp")
    sign = 1.0 if towards > x else -1.0

    def box(low: tuple[float, float, float], size: tuple[float, float, float]) -> None:
        model.box(np.array(low), (size[0] * np.eye(3)[0], size[1] * np.eye(3)[1], size[2] * UP), IRON, "-c")

    box((x - 0.06, y - 0.06, 0.0), (0.12, 0.12, height))
    box((x - 0.14, y - 0.14, 0.0), (0.28, 0.28, 0.7))
    box((min(x, x + 1.4 * sign), y - 0.03, height), (1.4, 0.06, 0.06))
    box((x + 1.1 * sign - 0.25, y - 0.12, height - 0.1), (0.5, 0.24, 0.1))


def add_sign(model: Model, x: float, y: float, size: tuple[float, float], colour: tuple[float, float, float]) -> None:
    """A traffic sign or advertisement on a thin post, facing those who come along the street."""
    model.start_body("lamp")
    x_axis, y_axis = np.eye(3)[0], np.eye(3)[1]
    model.box(np.array([x - 0.03, y, 0.0]), (0.06 * x_axis, 0.06 * y_axis, 2.2 * UP), IRON, "-c")
    corner = np.array([x - size[0] / 2, y - 0.04, 2.2])
    model.box(corner, (size[0] * x_axis, 0.03 * y_axis, size[1] * UP), Material("paint", colour))


def add_traffic(model: Model, road: float, rng: Generator) -> None:
    """Cars along the kerbs, trees, lamp posts and signs on the pavements."""
    for sign in (-1.0, 1.0):
        y = float(rng.uniform(7, 14))
        while y < 70:
            if rng.random() < 0.4:
                add_car(model, sign * (road - 1.15), y, float(rng.normal(0, 0.03)), rng)
            y += float(rng.uniform(5.5, 9))
        y = float(rng.uniform(8, 20))
        while y < 80:
            what = rng.random()
            if what < 0.25:
                x = sign * (road + rng.uniform(0.7, 1.0))
                add_tree(model, float(x), y, float(rng.uniform(5, 8)), 900, rng)
            elif what < 0.45:
                add_lamp(model, sign * (road + 0.5), y, float(rng.uniform(5, 7.5)), 0.0)
            elif what < 0.55:
                add_sign(model, sign * (road + 0.6), y, (float(rng.uniform(0.5, 0.9)), 0.7), (0.2, 0.3, 0.6))
            y += float(rng.uniform(7, 14))


def add_hedge(model: Model, corner: Float, sides: tuple[Float, Float, Float], colour: Point, rng: Generator) -> None:
    """A clipped hedge over a corner and three sides, along, up and outwards: a dark box that bristles with leaves.

    As those of trees, its outlines are no edges: no line of a photo is exactly there.
    """
    along, up, out = sides
    dark = Material("leaves", (0.6 * colour[0], 0.6 * colour[1], 0.6 * colour[2]))
    for place, first, second in (
        (corner, along, up),
        (corner + out, along, up),
        (corner, out, up),
        (corner + along, out, up),
        (corner + up, along, out),
    ):
        model.quad(place, first, second, dark)
        area = float(np.linalg.norm(np.cross(first, second)))
        shares = rng.uniform(0, 1, (min(800, int(80 * area)), 2))
        middles = place + shares[:, :1] * first + shares[:, 1:] * second
        _add_leaves(model, middles + rng.normal(0, 0.03, middles.shape), float(corner[2]), colour, rng)


def add_bush(model: Model, foot: Float, half: Float, colour: Point, rng: Generator) -> None:
    """A loose ball of leaves over a point, with half axes (3,) in m."""
    middles = foot + half[2] * UP + rng.normal(0, 0.5, (BUSH_LEAVES, 3)) * half
    _add_leaves(model, middles, float(foot[2]), colour, rng)


def _add_leaves(model: Model, middles: Float, ground: float, colour: Point, rng: Generator) -> None:
    """Small parallelograms about points (N, 3) that lie in any direction, above the ground: below it none is seen."""
    for middle in middles:
        first, across = rng.normal(0, 1, 3), rng.normal(0, 1, 3)
        second = np.cross(first, across)
        size = rng.uniform(*CLIPPED_SIZE)
        first, second = size * first / np.linalg.norm(first), 0.6 * size * second / np.linalg.norm(second)
        lowest = middle[2] + min(first[2], 0) + min(second[2], 0)
        shade = float(rng.choice(SHADES))
        tone = (round(shade * colour[0], 3), round(shade * colour[1], 3), round(shade * colour[2], 3))
        model.quad(middle + max(0.0, ground - lowest) * UP, first, second, Material("leaves", tone))
