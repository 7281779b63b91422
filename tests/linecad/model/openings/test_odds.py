"""The networks weigh each number by its name, and what they keep is what they were."""

import numpy as np
import pytest

from linecad.model.openings import evidence, neighbours
from linecad.model.openings.odds import Network, log_odds_alone, log_odds_beside, read_networks, write_networks

COUNT = len(evidence.NAMES)


def test_numbers_are_in_the_order_of_the_networks():
    by_itself, beside = read_networks()
    assert by_itself.names == evidence.NAMES
    assert beside.names == (*evidence.NAMES, *neighbours.NAMES)


def test_log_odds_are_those_of_the_networks():
    random = np.random.default_rng(0)
    by_itself, beside = read_networks()
    rows = random.uniform(beside.low, beside.high, (20, len(beside.names)))
    assert log_odds_alone(rows[:, :COUNT]) == pytest.approx(by_itself.log_odds(rows[:, :COUNT]))
    assert log_odds_beside(rows[:, :COUNT], rows[:, COUNT:]) == pytest.approx(beside.log_odds(rows))
    assert log_odds_alone(np.zeros((0, COUNT))).shape == (0,)


def test_the_sum_and_the_layers_with_rectified_units_add_up():
    network = Network(
        ("one", "two"),
        np.array([-1.0, -1.0]),
        np.array([1.0, 1.0]),
        10.0,
        np.array([0.0, 100.0]),
        ((np.array([[1.0, 0.0], [1.0, -2.0]]), np.array([0.5, 0.0])), (np.array([[2.0, 1.0]]), np.array([-1.0]))),
    )
    # 10 + 100 b + 2 * max(0, a + 0.5) + max(0, a - 2 b) - 1, a and b being at most 1 and at least -1.
    given = np.array([[0.5, 0.0], [-1.0, -1.0], [1.0, 1.0], [7.0, -9.0]])
    assert network.log_odds(given) == pytest.approx([11.5, -90.0, 112.0, -85.0])


def test_networks_are_kept(tmp_path):
    one, same = tmp_path / "one.npz", tmp_path / "same.npz"
    write_networks(*read_networks(), one)
    write_networks(*read_networks(one), same)
    assert one.read_bytes() == same.read_bytes()
    for before, after in zip(read_networks(), read_networks(one), strict=True):
        rows = np.linspace(before.low, before.high, 7)
        assert after.names == before.names
        assert np.array_equal(after.log_odds(rows), before.log_odds(rows))


@pytest.mark.parametrize("which", [0, 1])
def test_what_closes_a_rectangle_speaks_for_it(which):
    """All the evidence in the middle of what was fitted to, but for the sides."""
    network = read_networks()[which]
    middle = (network.low + network.high) / 2
    rows = np.stack([middle, middle])
    for name in ("uprights", "weaker upright", "weaker level", "levels"):
        rows[:, network.names.index(name)] = [0.2, 1.0]
    open_one, closed = network.log_odds(rows)
    assert closed > open_one
