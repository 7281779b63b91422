"""Planes of placed components that are nearly one become one exactly, by moves of whole components along their rays."""

import numpy as np
import pytest

from linecad.model.coplanar import SAME, TOLD, join_planes
from linecad.model.lifting import Lifted

LINES = 6  # of a wall, half of them upright


def walls(*places, normal=0):
    """Components of one wall each, at these places along their normal, and a line that stands before each."""
    count = (LINES + 1) * len(places)
    axis, component = np.zeros(count, int), np.repeat(np.arange(len(places)), LINES + 1)
    offset, shared = np.full((count, 3), np.nan), np.full((count, 3), -1)
    ends = np.zeros((count, 2, 3))
    other = 1 - normal
    for part, place in enumerate(places):
        for number in range(LINES + 1):
            line = part * (LINES + 1) + number
            axis[line] = 2 if number % 2 else other
            across = other if axis[line] == 2 else 2
            offset[line, [normal, across]] = place, 1.0 + number + part
            shared[line, [normal, across]] = part * 1000, part * 1000 + 1 + number
            ends[line] = 1.0
            ends[line, :, normal], ends[line, :, across] = place, 1.0 + number + part
            ends[line, 1, axis[line]] = 2.0
        alone = part * (LINES + 1) + LINES
        offset[alone, normal] = ends[alone, :, normal] = 0.5 * place
        shared[alone, normal] = part * 1000 + 999
    lifted = Lifted(ends, offset, shared, np.zeros(0), np.zeros(count))
    return lifted, component, axis


def wall_of(found, component, part, normal=0):
    return found.offset[component == part, normal][:LINES]


@pytest.mark.parametrize("normal", [0, 1])
def test_walls_that_are_nearly_one_become_one(normal):
    lifted, component, axis = walls(4.0, 4.01, normal=normal)
    found = join_planes(lifted, component, axis)
    assert set(wall_of(found, component, 1, normal).tolist()) == {4.0}
    assert len(np.unique(found.shared[:, normal])) == 3, "one wall, and two lines before it"
    own = component == 1
    assert (found.ends[own][:LINES, :, normal] == 4.0).all()
    # The whole component moved along its rays by as little.
    np.testing.assert_allclose(found.ends[own], lifted.ends[own] * 4.0 / 4.01, rtol=1e-12)
    np.testing.assert_allclose(found.offset[own], lifted.offset[own] * 4.0 / 4.01, rtol=1e-12)


def test_the_first_component_stays():
    lifted, component, axis = walls(4.0, 4.01)
    found = join_planes(lifted, component, axis)
    assert found.ends[component == 0].tobytes() == lifted.ends[component == 0].tobytes()


@pytest.mark.parametrize("places", [(4.0, 4.0 * np.exp(1.5 * SAME)), (4.0, -4.0), (4.0, 4.0 * np.exp(-1.5 * SAME))])
def test_walls_apart_stay_as_they_are(places):
    lifted, component, axis = walls(*places)
    found = join_planes(lifted, component, axis)
    assert found.ends.tobytes() == lifted.ends.tobytes()
    assert (found.shared == lifted.shared).all()


def test_walls_of_many_components_become_one():
    places = (4.0, 4.008, 3.99, 4.016)
    lifted, component, axis = walls(*places)
    found = join_planes(lifted, component, axis)
    assert {place for part in range(4) for place in wall_of(found, component, part).tolist()} == {4.0}
    assert len({found.shared[component == part][0, 0] for part in range(4)}) == 1


def test_no_component_moves_farther_than_that():
    """A chain of walls, each within reach of the next: the last is not drawn to the first."""
    lifted, component, axis = walls(*(4.0 * np.exp(0.8 * SAME * np.arange(4))))
    found = join_planes(lifted, component, axis)
    moved = [np.log(wall_of(found, component, part)[0] / wall_of(lifted, component, part)[0]) for part in range(4)]
    assert np.abs(moved).max() <= SAME + 1e-12
    assert len({wall_of(found, component, part)[0] for part in range(4)}) < 4


def test_a_row_of_lines_of_one_direction_is_no_plane():
    lifted, component, axis = walls(4.0, 4.01)
    upright = np.full(len(axis), 2)
    found = join_planes(lifted, component, upright)
    assert found.ends.tobytes() == lifted.ends.tobytes()


def test_lines_of_no_component_stay():
    lifted, component, axis = walls(4.0, 4.01, 4.005)
    component = np.where(component == 2, -1, component)
    found = join_planes(lifted, component, axis)
    assert found.ends[component < 0].tobytes() == lifted.ends[component < 0].tobytes()


def test_lines_that_a_person_told_to_be_in_one_plane_are_so_before_all_others():
    """The single line before the second wall is at the first one's place; the walls themselves would be joined else."""
    lifted, component, axis = walls(4.0, 4.0 * np.exp(0.5 * SAME))
    lifted.ends[component == 1] *= 1.02
    offset = lifted.offset.copy()
    offset[component == 1] *= 1.02
    alone = np.flatnonzero(component == 1)[-1]
    offset[alone, 0] = lifted.ends[alone, :, 0] = 4.05
    far = type(lifted)(lifted.ends, offset, lifted.shared, lifted.residual, lifted.shift)
    found = join_planes(far, component, axis, [(0, int(alone), 0)])
    assert found.offset[alone, 0] == found.offset[0, 0] == 4.0
    assert found.shared[alone, 0] == found.shared[0, 0]
    np.testing.assert_allclose(found.ends[component == 1], far.ends[component == 1] * 4.0 / 4.05, rtol=1e-12)
    assert join_planes(far, component, axis).offset[alone, 0] == 4.05


@pytest.mark.parametrize("factor", [np.exp(1.5 * TOLD), -1.0])
def test_what_a_person_told_moves_nothing_far(factor):
    lifted, component, axis = walls(4.0, 4.0 * factor)
    second = int(np.flatnonzero(component == 1)[0])
    found = join_planes(lifted, component, axis, [(0, second, 0)])
    assert found.ends.tobytes() == lifted.ends.tobytes()
