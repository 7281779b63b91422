"""Parts of bodies that a map has elsewhere: of one body that was made of two walls, one of which stands wrong."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties.depth_kind import DepthReading
from linecad.ties.depth_parts import (
    LEAST_LINES,
    LEAST_OFF,
    LOG_ODDS,
    MOST_KNOWN,
    WIDEST,
    Part,
    find_parts,
    hear_lines,
    is_map_likelier,
    right_by_map,
)
from linecad.ties.depth_samples import WallVotes

FALSE = 0.3  # log scale by which the second wall stands too far
SCALE = np.log(5.0)  # of the map's unit
READING = DepthReading("z", 0.0, 0.0, 0.0, np.zeros(0), WallVotes(np.zeros(0, int), np.zeros(0), np.zeros(0)))


@pytest.fixture(scope="module")
def bent(avenue_walls, build_setting):
    """The first two walls as one body, the second of which stands wrong; the third is a body of its own."""
    seen, _ = avenue_walls
    whole = build_setting(seen, (0.0, FALSE))
    return replace(whole, bodies=build_setting(seen, body=np.array([0, 0, 1])[seen.part]).bodies)


@pytest.fixture(scope="module")
def words(avenue_walls, build_depth_map, bent):
    seen, surfaces = avenue_walls
    return hear_lines(bent, build_depth_map(seen.sight, surfaces, scale=5.0), READING)


def parts(setting, words, known=0.3, log_scale=(0.0, 0.0)):
    return find_parts(setting, words, np.array(log_scale), SCALE, np.full(len(setting.log_depth), known))


def test_an_exact_map_asks_each_line_for_its_scale(avenue_walls, words):
    seen, _ = avenue_walls
    np.testing.assert_allclose(words, SCALE - np.array([0.0, FALSE, 0.0])[seen.part], atol=5e-3)


def test_lines_of_no_body_and_beside_no_depth_are_told_nothing(avenue_walls, bent, build_setting, build_depth_map):
    seen, surfaces = avenue_walls
    depth = build_depth_map(seen.sight, surfaces[:2])
    loose = replace(bent, bodies=build_setting(seen, body=np.array([0, -1, 1])[seen.part]).bodies)
    told = np.isfinite(hear_lines(loose, depth, READING))
    assert told[seen.part == 0].all()
    assert not told[seen.part != 0].any()


def test_the_part_that_stands_wrong_is_found_as_a_whole(avenue_walls, bent, words):
    seen, _ = avenue_walls
    (found,) = parts(bent, words)
    assert sorted(found.lines.tolist()) == np.flatnonzero(seen.part == 1).tolist()
    assert found.move == pytest.approx(-FALSE, abs=3e-3)
    assert found.known == pytest.approx(0.3)


def test_a_part_that_stands_where_the_map_has_it_is_none(bent, words):
    near = words + np.where(np.isclose(words, SCALE, atol=0.1), 0.0, FALSE)
    assert parts(bent, near) == []
    assert [part.move for part in parts(bent, near, log_scale=(2 * LEAST_OFF, 0.0))] == pytest.approx(
        [-2 * LEAST_OFF], abs=3e-3
    )


def test_few_lines_are_no_part(bent):
    one = np.full(len(bent.log_depth), SCALE)
    own = bent.lines[0][: LEAST_LINES - 1]
    one[own] += 0.5
    assert parts(bent, one) == []


@pytest.mark.parametrize("kind", ["distance", "inverse", "affine-inverse"])
def test_every_kind_of_map_is_read(avenue_walls, build_depth_map, bent, kind):
    seen, surfaces = avenue_walls
    scale = 5.0 if kind == "distance" else 1.0
    depth = build_depth_map(seen.sight, surfaces, kind, scale, shift=0.2 if kind == "affine-inverse" else 0.0)
    shift = -depth.values[depth.valid].max() * 0.2 / 1.2 if kind == "affine-inverse" else 0.0
    asked = hear_lines(bent, depth, replace(READING, kind=kind, shift=shift))
    np.testing.assert_allclose(asked, np.log(scale) - np.array([0.0, FALSE, 0.0])[seen.part], atol=5e-3)


def test_with_the_main_part_goes_what_the_map_is_mute_about(bent, words):
    """And a smaller part that stands where the map has it stays by itself."""
    asked = words.copy()
    own = bent.lines[0]
    mute, other = own[:3], own[3 : 3 + LEAST_LINES]
    asked[own] = SCALE + 0.4
    asked[mute], asked[other] = np.nan, SCALE
    (found,) = parts(bent, asked)
    assert sorted(found.lines.tolist()) == own[3 + LEAST_LINES :].tolist()
    assert found.also.tolist() == mute.tolist()
    assert found.asked == pytest.approx(SCALE + 0.4)


def test_the_map_is_believed_where_little_is_known_and_it_is_far_off():
    """By the fitted log-odds, of which each has its sign; and not from MOST_KNOWN and WIDEST on."""

    def moved(known=0.45, move=0.06, width=0.8 * WIDEST):
        return Part(np.arange(LEAST_LINES), 0.0, move, known, np.zeros(0, int)).is_moved(width)

    assert LOG_ODDS["known"] < 0 < LOG_ODDS["off"]
    assert LOG_ODDS["width"] < 0
    assert moved(known=0.05, move=-0.6, width=0.012)
    assert not moved(known=MOST_KNOWN, move=0.6, width=0.012)
    assert not moved(known=0.05, move=0.6, width=WIDEST)


def test_single_lines_are_judged_as_parts_are_but_for_their_limits():
    known, move = np.array([0.05, 0.45, 0.45, 0.99]), np.array([-0.6, 0.06, 0.6, 0.15])
    for width in (0.012, 0.019, 0.03):
        told = is_map_likelier(known, width, move).tolist()
        assert told == [bool(is_map_likelier(one, width, other)) for one, other in zip(known, move, strict=True)]
        parts = [Part(np.arange(LEAST_LINES), 0.0, by, p, np.zeros(0, int)) for p, by in zip(known, move, strict=True)]
        limited = [part.is_moved(width) for part in parts]
        assert limited == [likely and width < WIDEST and p < MOST_KNOWN for likely, p in zip(told, known, strict=True)]
    assert is_map_likelier(known, 0.012, move).tolist() == [True, True, True, False]


def test_a_wider_map_is_less_often_right():
    assert 1 > right_by_map(0.01) > right_by_map(0.03) > 0
