"""Houses over rectangles, as streets, courtyards and gardens have them."""

import numpy as np
from numpy.random import Generator

from linecad.dataset.facades import Style, build_facade, draw_style
from linecad.dataset.modelling import UP, Interval, Material, Model, Wall, X, Y

DETAIL_REACH = 34.0  # m; facades that begin farther away have plain windows and no courses
ROOF = Material("plain", (0.40, 0.33, 0.30))


def add_building(
    model: Model,
    x: Interval,
    y: Interval,
    z: Interval,
    fronts: set[str],
    rng: Generator,
    style: Style | None = None,
) -> list[Wall]:
    """A house, a box; `fronts` names the sides that have facades, which are returned; the others are bare."""
    model.start_body("building")
    facades: list[Wall] = []
    style = style or draw_style(rng)
    height = z[1] - z[0]
    walls = {
        "+x": (x[1], y[0], Y, X, y[1] - y[0]),
        "-x": (x[0], y[1], -Y, -X, y[1] - y[0]),
        "+y": (x[1], y[1], -X, Y, x[1] - x[0]),
        "-y": (x[0], y[0], X, -Y, x[1] - x[0]),
    }
    for name, (foot_x, foot_y, along, out, width) in walls.items():
        foot = np.array([foot_x, foot_y, z[0]])
        wall = Wall(model, foot, along, out)
        if name in fronts:
            build_facade(wall, width, height, style, rng, detailed=foot_y < DETAIL_REACH)
            facades.append(wall)
        else:
            wall.build((0.0, width), (0.0, height), style.wall)
        model.edge(foot, foot + height * UP)
        model.edge(foot, foot + width * along)
        model.edge(foot + height * UP, foot + height * UP + width * along)
    roof = np.array([x[0], y[0], z[1]])
    model.quad(roof, (x[1] - x[0]) * X, (y[1] - y[0]) * Y, ROOF)
    for _ in range(int(rng.integers(0, 3))):
        corner = roof + rng.uniform(0.1, 0.8) * (x[1] - x[0]) * X + rng.uniform(0.1, 0.8) * (y[1] - y[0]) * Y
        model.box(corner, (0.9 * X, 0.7 * Y, rng.uniform(1.0, 2.2) * UP), style.wall, "-c")
    return facades
