"""Crossings of lines of two frames, made exact by the least moves of planes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from linecad.directions import components, directions_of
from linecad.geometry import project
from linecad.model.clean.sight import Sight
from linecad.model.frame_crossings import FARTHEST, clean_and_cross, inexact_crossings, with_exact_crossings
from linecad.model.frames import FramedLines, in_frame
from linecad.scene import Scene, SolveReport

TURNS = (0.5,)
X, Y, Z = range(3)
DEPTH = 10.0


@pytest.fixture
def sight(camera, rotation):
    return Sight.of(camera, rotation, None)


def framed_of(lines, rows, frames):
    """Rows (axis, start, end), each in the axes of its frame."""
    return FramedLines(lines(rows), np.array(frames), TURNS)


def beam(z, wall=DEPTH):
    return (X, (-1, wall, z), (1, wall, z))


def post_at(foot, low=-1.0):
    return (Z, (*foot, low), (*foot, 2))


def on_turned_wall(along, off):
    """The foot, in the main frame, of a post on the wall y = DEPTH of the turned frame, `off` behind it."""
    return np.array([along, DEPTH + off]) @ directions_of(TURNS)[3:, :2]


def test_level_lines_of_two_frames_become_equally_high_by_their_weight(lines, crossings, sight):
    rows = [beam(1.0), beam(1.02)]
    found = with_exact_crossings(framed_of(lines, rows, [0, 1]), crossings([(0, 1)]), sight).lines
    assert found.ends[0, 0, Z] == pytest.approx(found.ends[1, 0, Z], abs=1e-12)
    assert 1.0 < found.ends[0, 0, Z] < 1.02
    # Both are seen as long; the turned one is nearer, so that its height is known better.
    nearer = np.cos(TURNS[0])
    assert found.ends[0, 0, Z] == pytest.approx(np.average([1.0, 1.02], weights=[nearer**2, 1.0]))


@pytest.mark.parametrize(("off", "meets"), [(0.03, True), (3 * FARTHEST * DEPTH, False)])
def test_a_post_moves_into_the_turned_wall_that_it_nearly_stands_in(lines, crossings, sight, off, meets):
    foot = on_turned_wall(0.4, off)
    before = framed_of(lines, [beam(0.5), post_at(foot)], [1, 0])
    after = with_exact_crossings(before, crossings([(0, 1)]), sight)
    place = components(after.in_world().ends[1, 0], TURNS)[4]
    assert (abs(place - after.lines.ends[0, 0, Y]) < 1e-9) == meets
    if not meets:
        np.testing.assert_array_equal(after.lines.ends, before.lines.ends)
    assert after.lines.ends[1, 0, :2].tolist() == after.lines.ends[1, 1, :2].tolist()


def test_what_meets_within_a_frame_still_meets(lines, crossings, sight):
    foot = on_turned_wall(0.4, 0.03)
    level = (X, (foot[0], foot[1], 1.5), (foot[0] + 1, foot[1], 1.5))
    before = framed_of(lines, [beam(0.5), post_at(foot), level], [1, 0, 0])
    after = with_exact_crossings(before, crossings([(0, 1), (1, 2)]), sight).lines
    assert after.ends[1, 0, Y] == after.ends[2, 0, Y] != foot[1]
    assert after.ends[2, 0, X] == after.ends[1, 0, X]  # its end lay on the post's plane, and goes with it


def test_conditions_that_contradict_each_other_lose_the_worst(lines, crossings, sight):
    one, other = beam(1.0), beam(1.001)
    rows = [one, other, beam(1.0), beam(1.02)]
    links = (X, (-1, DEPTH, 1.0), (1, DEPTH, 1.0))
    found = with_exact_crossings(
        framed_of(lines, [*rows, links], [0, 1, 0, 1, 1]), crossings([(0, 1), (2, 3), (2, 1), (0, 4)]), sight
    ).lines
    height = found.ends[:, 0, Z]
    assert np.ptp(height[[0, 1, 2, 4]]) < 1e-12
    far = [(X, (-1, DEPTH, z), (1, DEPTH, z)) for z in (0.0, 0.07, 0.14)]
    chained = with_exact_crossings(framed_of(lines, far, [0, 1, 0]), crossings([(0, 1), (1, 2)]), sight).lines
    gaps = np.abs(np.diff(chained.ends[:, 0, Z]))
    assert sorted(gaps < 1e-12) == [False, True]


def test_ends_that_miss_meet_where_no_crossing_has_to_go_for_it(lines, crossings, sight):
    rows = [beam(1.0), beam(1.03), beam(1.0), beam(1.085), beam(2.0), beam(2.03)]
    before = framed_of(lines, rows, [0, 1, 0, 1, 0, 1])
    pairs = crossings([(0, 1)])
    missed = np.array([(2, 3), (5, 4)])
    after = with_exact_crossings(before, pairs, sight, missed).lines.ends[:, 0, Z]
    assert after[0] == pytest.approx(after[1], abs=1e-12)  # beams 0 and 2 are one plane, which cannot reach both
    assert abs(after[2] - after[3]) > 1e-3
    assert after[4] == pytest.approx(after[5], abs=1e-12)
    real = with_exact_crossings(before, pairs, sight).lines.ends[:, 0, Z]
    assert abs(real[4] - real[5]) > 1e-3


def test_planes_of_a_frame_that_meet_one_of_another_are_one_to_the_last_digit(lines, crossings, sight):
    rows = [beam(0.3 + 1 / 3), beam(0.64), beam(0.65), beam(0.66)]
    found = with_exact_crossings(framed_of(lines, rows, [0, 1, 0, 0]), crossings([(0, 1), (1, 2), (1, 3)]), sight).lines
    assert len(set(found.ends[[0, 2, 3], 0, Z].tolist())) == 1


def test_crossings_that_are_not_real_move_nothing(lines, crossings, sight):
    before = framed_of(lines, [beam(1.0), beam(1.02)], [0, 1])
    after = with_exact_crossings(before, crossings([(0, 1)], real=False), sight)
    np.testing.assert_array_equal(after.lines.ends, before.lines.ends)


def test_one_frame_is_as_it_was(lines, crossings, sight):
    only = FramedLines(lines([beam(1.0), beam(1.02)]), np.zeros(2, int), ())
    assert with_exact_crossings(only, crossings([(0, 1)]), sight) is only


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=25, deadline=None)
@given(offs=st.lists(st.floats(-0.02, 0.02), min_size=2, max_size=4), rise=st.floats(-0.02, 0.02))
def test_no_smaller_moves_meet_the_same_crossings(lines, crossings, sight, offs, rise):
    """Against a general minimiser over the offsets, by the moves' squares in units of what the offsets are known by."""
    posts = [post_at(on_turned_wall(place, off)) for place, off in zip((-1.2, -0.4, 0.4, 1.2), offs, strict=False)]
    rows = [beam(0.5), beam(0.5 + rise), *posts]
    pairs = [(0, 1), *((0, 2 + number) for number in range(len(posts)))]
    before = framed_of(lines, rows, [1, *[0] * (1 + len(posts))])
    after = with_exact_crossings(before, crossings(pairs), sight).lines
    start, weights = _variables(before.lines, len(posts))
    normal = directions_of(TURNS)[4, :2]

    def gaps(values):
        feet = values[4:].reshape(-1, 2)
        return np.r_[values[1] - values[3], feet @ normal - values[0]]

    best = minimize(
        lambda values: float((((values - start) / weights) ** 2).sum()), start, method="SLSQP",
        constraints={"type": "eq", "fun": gaps}, options={"ftol": 1e-14, "maxiter": 500},
    ).x  # fmt: skip
    found = _variables(after, len(posts))[0]
    assert np.abs(gaps(found)).max() < 1e-9
    cost = [float((((each - start) / weights) ** 2).sum()) for each in (found, best)]
    assert cost[0] <= cost[1] * (1 + 1e-4) + 1e-9


def _variables(lines, posts):
    """Offsets y, z of both beams and x, y of all posts; and how well each is known: depth over root of its length."""
    length = np.linalg.norm(lines.segment[:, 1] - lines.segment[:, 0], axis=1)
    depth = np.abs(lines.ends.mean(axis=1)[:, Y]) * [np.cos(TURNS[0]), *[1.0] * (1 + posts)]
    values = [*lines.ends[0, 0, 1:], *lines.ends[1, 0, 1:], *lines.ends[2:, 0, :2].ravel()]
    known = depth / np.sqrt(length)
    return np.array(values), np.array([*known[[0, 0, 1, 1]], *np.repeat(known[2 : 2 + posts], 2)])


def test_what_stays_apart_is_counted(lines, crossings, camera, rotation):
    framed = framed_of(lines, [beam(1.0), beam(1.02), beam(1.0)], [0, 1, 1])
    scene = Scene(
        photo="street.jpg", camera=camera, rotation=rotation, lines=framed.in_world(),
        intersections=crossings([(0, 1), (0, 2)]), planes=(), turns=TURNS,
        solve=SolveReport("SCIP 10.0", "bodies", "optimal", 0, 0, 0),
    )  # fmt: skip
    assert inexact_crossings(scene).startswith("1 of 2 real crossings join lines of two frames that stay apart")
    assert "at most 0.2% of the depth" in inexact_crossings(scene)
    assert inexact_crossings(replace(scene, intersections=crossings([(0, 2)]))) == ""


def test_what_cleaning_and_crossing_moved_is_told(lines, crossings, camera, sight):
    """Two pieces of one beam, one that crosses it in the turned frame, and one there that only ends near it."""
    there = in_frame(np.array([0.0, DEPTH, 0.5]), 1, TURNS)
    along, _, up = np.eye(3)
    rows = [
        (X, (-2, DEPTH, 0.5), (-0.9, DEPTH, 0.5)), (X, (-1, DEPTH, 0.5), (0.02, DEPTH, 0.5)),
        (X, there + 0.03 * up, there + along + 0.03 * up),
        (X, (-2, DEPTH, 1.5), (0, DEPTH, 1.5)), (X, there + 1.04 * up, there + along + 1.04 * up),
    ]  # fmt: skip
    before = framed_of(lines, rows, [0, 0, 1, 0, 1])
    cleaned, after = clean_and_cross(before, crossings([(0, 1), (1, 2)]), sight, camera.width)
    assert len(after.lines) == 4
    assert cleaned.row[0] == cleaned.row[1]
    start, end = after.in_world().ends[cleaned.row[[2, 4]], 0], after.in_world().ends[cleaned.row[[1, 3]], 1]
    np.testing.assert_allclose(start, end, atol=1e-12)
    farthest = np.abs(after.lines.ends[cleaned.row, 0, Z] - before.lines.ends[:, 0, Z]) / DEPTH
    assert cleaned.moved == pytest.approx(farthest.max(), rel=0.2)
    level = cleaned.shared[:, Z]
    assert len(set(level.tolist())) == 4  # a plane of each frame at both heights


def test_a_piece_of_which_a_person_spoke_stays_apart(lines, crossings, camera, sight):
    turns = (0.1,)
    start = np.array([-1.0, DEPTH, 0.0])
    turned = in_frame(np.stack([start, start + 1.5 * directions_of(turns)[3]]), 1, turns)
    rows = [(X, (-2, DEPTH, 0), (2, DEPTH, 0)), (X, *turned), (Z, (-2, DEPTH, -1), (-2, DEPTH, 1))]
    rows = lines(rows)
    seen = project(
        np.stack([rows.ends[0], [start, start + 1.5 * directions_of(turns)[3]]]), camera.matrix, sight.rotation
    )
    rows = replace(rows, segment=np.concatenate([seen, rows.segment[2:]]))
    for reason, left in (("", 2), ("annotated", 3)):
        framed = FramedLines(rows, np.array([0, 1, 0]), turns)
        found = clean_and_cross(framed, crossings([(0, 1), (0, 2)], reason=reason), sight, camera.width)[1]
        assert len(found.lines) == left
