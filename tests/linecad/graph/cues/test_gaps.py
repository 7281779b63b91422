"""Log-odds of edges by hand: gaps, stems, level lines, and collinear pieces alone and in a crowd."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.graph.build import build_line_graph
from linecad.graph.cues import STEP
from linecad.graph.cues.collinear import ACROSS
from linecad.graph.cues.collinear import AT_ONCE as COLLINEAR
from linecad.graph.cues.gaps import AT_ONCE, BOTH_HORIZONTAL
from linecad.line_graph import ManhattanFrame, Segments
from linecad.options import LONG_REACH
from linecad.scene import Camera

# A frontal camera at the reference width: z lines are vertical in the photo, x lines level.
CAMERA = Camera(3840, 2160, np.array([[2000.0, 0, 1920], [0, 2000, 1080], [0, 0, 1]]), "file")
FRAME = ManhattanFrame(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 0.0, 1.0)


def level(left, right, at):
    return [[left, at], [right, at]], 0


def upright(top, bottom, at):
    return [[at, top], [at, bottom]], 2


def odds_of(*lines, camera=CAMERA, scale=1.0):
    ends = np.array([ends for ends, _ in lines], float) * scale
    graph = build_line_graph(Segments(ends, [axis for _, axis in lines]), camera, FRAME, LONG_REACH, "odds", True)
    return graph.kind.tolist(), graph.weight.tolist()


def rounded(odds):
    return pytest.approx(round(odds / STEP) * STEP)


def test_lines_that_cross_within_both_convince_most():
    assert odds_of(level(400, 800, 500), upright(300, 700, 600)) == (["X"], [rounded(AT_ONCE)])


@given(st.floats(1, 70), st.floats(1, 70))
def test_a_wider_gap_convinces_less(one, other):
    near, far = sorted([one, other])
    (_, [first]), (_, [second]) = (
        odds_of(level(400, 800, 500), upright(500 + gap, 800 + gap, 600)) for gap in (near, far)
    )
    assert AT_ONCE >= first >= second >= STEP


def test_a_longer_stem_convinces_more():
    (_, [short]), (_, [long]) = (odds_of(level(400, 800, 500), upright(540, 540 + length, 600)) for length in (60, 600))
    assert long > short


def test_two_level_lines_convince_less():
    away = np.array([[1320.0, 880], [1620, 980]])  # to the vanishing point in the photo's middle
    _, [weight] = odds_of(level(1000, 1700, 930), (away.tolist(), 1))
    assert weight == rounded(AT_ONCE - BOTH_HORIZONTAL)


def test_odds_do_not_change_with_the_size_of_the_photo():
    half = Camera(1920, 1080, CAMERA.matrix * [[0.5], [0.5], [1]], "file")
    lines = level(400, 800, 500), upright(540, 800, 600), level(830, 1100, 500)
    assert odds_of(*lines, camera=half, scale=0.5)[1] == pytest.approx(odds_of(*lines)[1])


def test_pieces_of_one_line_convince_by_how_nearly_they_lie_on_it():
    _, [exact] = odds_of(level(400, 800, 500), level(860, 1200, 500))
    _, [off] = odds_of(level(400, 800, 500), level(860, 1200, 500 + ACROSS))
    assert exact == rounded(COLLINEAR - 0.5 * 60 / 340)
    assert off == rounded(exact - 0.5)


def test_among_courses_of_brick_a_continuation_convinces_little():
    courses = [level(860, 1200, 500 + step) for step in (-20, -10, 10, 20)]
    kinds, weights = odds_of(level(400, 800, 500), level(860, 1200, 500), *courses)
    assert kinds == ["collinear"]
    _, [alone] = odds_of(level(400, 800, 500), level(860, 1200, 500))
    assert STEP <= weights[0] <= alone - 1


def test_odds_are_whole_steps():
    _, weights = odds_of(level(400, 800, 500), upright(540, 800, 600), level(830, 1100, 500))
    assert weights == [rounded(weight) for weight in weights]
