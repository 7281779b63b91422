"""The walls, the ground and the ceiling of lines."""

import numpy as np

from linecad.geometry import central_camera
from linecad.model.regions.surfaces import (
    BELOW,
    FIRM_FEET,
    FURTHEST_FIRM,
    FURTHEST_FOOT,
    GROUND_STEP,
    LEVEL_LINES,
    LEVEL_SHARE,
    MOST_LEVELS,
    MOST_SURFACES,
    RELIEF,
    SAME_LEVEL,
    GroundOfFeet,
    against,
    find_surfaces,
    find_walls,
    is_contested,
    level_of_ends,
    likely_grounds,
)  # fmt: skip
from linecad.scene import Camera, Lines, Plane

CAMERA = Camera(1000, 800, central_camera(800.0, 1000, 800), "file")


def upright(*spans, length=100.0, probability=(), component=None):
    """Lines along z, each from a height to another, `length` px long in the photo, with ids from 10 on."""
    count = len(spans)
    ends = np.array([[[x, 5, low], [x, 5, high]] for x, (low, high) in enumerate(spans)], float).reshape(-1, 2, 3)
    segment = np.zeros((count, 2, 2))
    segment[:, 1, 1] = length
    return Lines(
        id=10 + np.arange(count), axis=np.full(count, 2), segment=segment, ends=ends,
        is_boundary=np.zeros(count, bool), component=np.zeros(count, int) if component is None else component,
        confidence=np.full(count, "proven"), probability=probability,
    )  # fmt: skip


def surfaces(planes, lines, feet=None, ceiling=None):
    """What is found, as tuples, on the likeliest ground."""
    walls = find_walls(tuple(planes), lines, CAMERA)
    grounds = likely_grounds(walls, lines, feet)
    found = find_surfaces(walls, grounds[0] if grounds else None, ceiling)
    return [(each.kind, each.axis, each.offset, each.lines.tolist(), each.plane) for each in found]


ABOVE = upright(*[(1, 2)] * 6)
BOTH = upright(*[(-2, 2)] * 6)


def test_planes_are_walls_and_levels_in_the_order_of_the_length_of_their_lines():
    planes = [Plane(0, 2, 1.0, (10,)), Plane(1, 0, 3.0, (11, 12, 13)), Plane(2, 1, 9.0, (14, 15))]
    assert surfaces(planes, ABOVE) == [
        ("wall", 0, 3.0, [1, 2, 3], 1), ("wall", 1, 9.0, [4, 5], 2), ("level", 2, 1.0, [0], 0)
    ]  # fmt: skip


def test_relief_is_one_wall_with_the_plane_of_the_most_lines():
    for factor, count in ((1 - 0.9 * RELIEF, 1), (1 + 0.9 * RELIEF, 1), (1 + 1.1 * RELIEF, 2), (-1, 2)):
        planes = [Plane(0, 0, 3.0 * factor, (10, 11)), Plane(1, 0, 3.0, (12, 13, 14))]
        found = surfaces(planes, ABOVE)
        assert len(found) == count
        assert found[0] == ("wall", 0, 3.0, [0, 1, 2, 3, 4] if count == 1 else [2, 3, 4], 1)
    other_axis = [Plane(0, 1, 3.0, (10, 11)), Plane(1, 0, 3.0, (12, 13, 14))]
    assert len(surfaces(other_axis, ABOVE)) == 2


def test_short_lines_make_no_surface_and_there_are_so_many_at_most():
    assert surfaces([Plane(0, 0, 3.0, (10,))], upright(*[(1, 2)] * 3, length=19)) == []
    assert len(surfaces([Plane(0, 0, 3.0, (10,))], upright(*[(1, 2)] * 3, length=21))) == 1
    many = [Plane(number, 0, 1.0 + number, (10 + number,)) for number in range(MOST_SURFACES + 5)]
    assert len(surfaces(many, upright(*[(1, 2)] * len(many)))) == MOST_SURFACES


def test_the_ground_is_where_nearly_all_lines_end():
    assert level_of_ends(BOTH, above=False) == 2
    assert level_of_ends(BOTH, above=True) == 2
    # One of thirty, which reaches too far down, does not put it there; two of them do.
    assert level_of_ends(upright(*[(-2, 2)] * 29, (-7, 2)), above=False) == 2
    assert level_of_ends(upright(*[(-2, 2)] * 28, *[(-7, 2)] * 2), above=False) == 7
    assert surfaces([], BOTH) == [("ground", 2, -2.0, [], None)]


def test_lines_above_the_horizon_have_no_ground():
    assert likely_grounds([], ABOVE, None) == []
    assert likely_grounds([], upright((-2, 2), (-2, 2), *[(1, 2)] * 4), None) == []
    assert surfaces([], ABOVE, GroundOfFeet(1.5, 9.0)) == []


def test_lines_whose_place_is_unsure_say_less_about_the_ground():
    spans = [(-2, 2)] * 28 + [(-7, 2)] * 2
    sure = [1.0] * 28 + [0.1] * 2
    assert level_of_ends(upright(*spans, probability=sure), above=False) == 2
    assert level_of_ends(upright(*spans, component=[0] * 28 + [1] * 2), above=False) == 2


def heights(lines, feet, planes=()):
    """Of the ground that is likeliest by lines and feet, and of its rivals."""
    return [ground.height for ground in likely_grounds(find_walls(planes, lines, CAMERA), lines, feet)]


def test_feet_put_the_ground_where_no_line_contradicts_them():
    # All lines end above the feet: the ground is lower than each of them.
    assert heights(BOTH, GroundOfFeet(2.5, 1.0)) == [2.5, 2]
    assert heights(BOTH, GroundOfFeet(2.0 / BELOW * 1.001, 0.1))[0] == 2.0 / BELOW * 1.001
    # Feet far below all lines are no feet of theirs.
    far = FURTHEST_FOOT * 2 * 1.01
    assert heights(BOTH, GroundOfFeet(far, 99.0)) == [2]
    # Unless they are firm and in the open: below shop windows there is no line.
    assert heights(BOTH, GroundOfFeet(far, FIRM_FEET, is_open=True)) == [far, 2]
    assert heights(BOTH, GroundOfFeet(far, 0.99 * FIRM_FEET, is_open=True)) == [2]
    assert heights(BOTH, GroundOfFeet(FURTHEST_FIRM * 2 * 1.01, 99.0, is_open=True)) == [2]


def test_lines_that_reach_below_the_feet_contest_the_ground():
    # All do, so the feet need log-odds of more than 20.
    assert (against(BOTH, 1.0), against(BOTH, 2.0), against(ABOVE, 1.0)) == (20, 0, 0)
    lowest, trodden = likely_grounds([], BOTH, GroundOfFeet(1.0, 19.0, is_open=True))
    assert (lowest.height, lowest.reach, lowest.of_feet, lowest.is_by_feet) == (2, GROUND_STEP, 0, False)
    assert (trodden.height, trodden.reach, trodden.of_feet, trodden.is_by_feet) == (1, SAME_LEVEL, 19, True)
    assert is_contested([lowest, trodden])
    grounds = likely_grounds([], BOTH, GroundOfFeet(1.0, 21.0))
    assert [(ground.height, ground.is_by_feet) for ground in grounds] == [(1, True), (2, False)]
    assert not is_contested(grounds)
    assert not is_contested(likely_grounds([], BOTH, None))
    assert heights(BOTH, GroundOfFeet(1.0, 19.0)) == [2], "plants hide them"


def test_a_level_of_many_lines_may_be_the_ground():
    lines = upright(*[(-2, 2)] * 100)
    count = max(LEVEL_LINES, round(LEVEL_SHARE * 100))
    level = Plane(0, 2, -1.5, tuple(range(10, 10 + count)))
    assert heights(lines, None, (level,)) == [2, 1.5]
    assert heights(lines, GroundOfFeet(2.5, 1.0), (level,)) == [2.5, 2, 1.5]
    assert heights(lines, None, (Plane(0, 2, 1.5, level.lines),)) == [2]  # above the camera
    assert heights(lines, None, (Plane(0, 0, -1.5, level.lines),)) == [2]  # upright
    assert heights(lines, None, (Plane(0, 2, -1.5, level.lines[: LEVEL_LINES - 1]),)) == [2]
    assert count < LEVEL_SHARE * 1000
    assert heights(upright(*[(-2, 2)] * 1000), None, (level,)) == [2]


def test_of_many_levels_those_of_the_most_lines_may_be_the_ground():
    spans, first, levels = [(-2, 2)] * 60, 10, []
    for offset, count in ((-1.0, 9), (-1.2, 12), (-1.4, 10)):
        levels.append(Plane(len(levels), 2, offset, tuple(range(first, first + count))))
        first += count
    assert len(levels) > MOST_LEVELS
    assert heights(upright(*spans), None, tuple(levels)) == [2, 1.2, 1.4]


def test_levels_near_the_ground_become_it_and_kerbs_join_it():
    kerb = -2 * np.exp(-0.9 * GROUND_STEP)
    planes = [Plane(0, 2, -2.0, (10, 11)), Plane(1, 2, kerb, (12,)), Plane(2, 2, 2.0, (13,))]
    assert surfaces(planes, BOTH) == [("level", 2, 2.0, [3], 2), ("ground", 2, -2.0, [0, 1, 2], 0)]
    far = -2 * np.exp(-1.1 * GROUND_STEP)
    assert surfaces([Plane(1, 2, far, (12,))], BOTH) == [("level", 2, far, [2], 1), ("ground", 2, -2.0, [], None)]


def test_a_ceiling_is_at_its_height_or_at_the_level_that_is_nearly_there():
    assert surfaces([], BOTH, ceiling=3.0) == [("ground", 2, -2.0, [], None), ("ceiling", 2, 3.0, [], None)]
    assert surfaces([Plane(4, 2, 2.0, (10,))], ABOVE, ceiling=2.05) == [("ceiling", 2, 2.0, [0], 4)]
