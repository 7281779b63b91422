"""What one wall is: strips, panes and reveals of a facade together, corners and houses apart."""

import numpy as np

from linecad.arrays import Float, Int
from linecad.dataset.furniture import add_car, add_tree
from linecad.dataset.modelling import Material, Model, Wall
from linecad.dataset.walls import walls_of_quads

STONE = Material("plain", (0.6, 0.6, 0.6))
X, Y, Z = np.eye(3)
EYE = np.array([0.0, -6.0, 1.6])


def walls_of(model: Model) -> Int:
    """The walls of a model, seen from EYE; from where does not matter."""
    return walls_of_quads(model.quads(EYE), np.array(model.body, np.int64))


def panel(model: Model, corner: Float, first: Float, second: Float) -> None:
    model.quad(np.array(corner, float), np.array(first, float), np.array(second, float), STONE)


def house() -> Model:
    model = Model()
    model.start_body("building")
    return model


def test_a_facade_with_its_windows_is_one_wall() -> None:
    model = house()
    wall = Wall(model, np.zeros(3), X, -Y)
    for along in (1.0, 3.0):
        wall.opening((along, along + 1.0), (1.0, 2.5), 0.12, STONE)
        wall.panel((along, along + 1.0), (1.0, 2.5), -0.12, STONE)
        wall.box((along - 0.1, along + 1.1), (0.9, 1.0), (0.0, 0.08), STONE)
    wall.build((0.0, 5.0), (0.0, 4.0), STONE)
    assert len(model.body) > 20
    assert set(walls_of(model)) == {0}


def test_sides_of_a_corner_are_two_walls_each_with_its_own_relief() -> None:
    model = house()
    panel(model, (0, 0, 0), 5 * X, 4 * Z)
    panel(model, (0, 0, 0), 6 * Y, 4 * Z)
    panel(model, (2, -0.1, 1), X, 0.1 * Y)  # a sill of the first one
    panel(model, (-0.1, 3, 1), Y, 0.1 * X)  # and of the second one
    assert walls_of(model).tolist() in ([0, 1, 0, 1], [1, 0, 1, 0])


def test_the_side_from_which_a_panel_was_built_does_not_matter() -> None:
    model = house()
    panel(model, (0, 0, 0), X, 4 * Z)
    panel(model, (1, 0, 0), 4 * Z, X)
    assert set(walls_of(model)) == {0}


def test_walls_that_stand_a_metre_apart_are_two() -> None:
    model = house()
    panel(model, (0, 0, 0), 5 * X, 4 * Z)
    panel(model, (5, 1, 0), 5 * X, 4 * Z)
    panel(model, (10, 1.2, 0), 5 * X, 4 * Z)
    assert walls_of(model).tolist() == [0, 1, 1]


def test_houses_in_one_plane_are_two_walls() -> None:
    model = house()
    panel(model, (0, 0, 0), 5 * X, 4 * Z)
    model.start_body("building")
    panel(model, (5, 0, 0), 5 * X, 4 * Z)
    assert walls_of(model).tolist() == [0, 1]


def test_a_tree_is_one_wall_and_the_side_of_a_car_too() -> None:
    model = Model()
    rng = np.random.default_rng(0)
    add_tree(model, 3.0, 4.0, 6.0, 200, rng)
    leaves = len(model.body)
    add_car(model, -2.0, 5.0, 0.05, rng)
    walls = walls_of(model)
    assert len(set(walls[:leaves])) == 1
    normal = np.cross(*(np.array(model.corners)[leaves:, [1, 2]] - np.array(model.corners)[leaves:, :1]).swapaxes(0, 1))
    is_upright = np.abs(normal[:, 2]) < 1e-9 * np.linalg.norm(normal, axis=1)
    is_flank = is_upright & (np.abs(normal[:, 0]) > 10 * np.abs(normal[:, 1]))
    assert is_flank.sum() > 130
    left, right = sorted(np.bincount(walls[leaves:][is_flank]))[-2:]
    assert left + right > 0.95 * is_flank.sum()  # the strips at its ends lie no farther from the bumpers
