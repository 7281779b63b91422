"""Feet of walls: read off probabilities, brought together body by body, and found in made photos of a street."""

from dataclasses import replace
from itertools import chain, islice

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import linecad.ties.feet
from linecad.ties.feet import (
    AT_ONCE,
    HALF,
    LEAST_PROBABILITY,
    MOST_FEET,
    NETWORK,
    PEAKS,
    SAME,
    FootReader,
    find_feet,
    foot_probabilities,
    peaks,
)
from linecad.ties.walls import COLUMNS, ROW, ROWS, Strip, StripDrawer, find_walls

MOST_BYTES = 1_000_000  # of the network
FOUND = 0.03  # log height


def feet_of(setting):
    return find_feet(setting, FootReader(setting))


def noise(count, seed=0):
    """Strips that show nothing in particular."""
    return np.random.default_rng(seed).normal(0, 1, (count, 6, ROWS, COLUMNS)).astype(np.float32)


def by_hand(rows):
    """What `peaks` finds, window by window."""
    rows, found = list(rows), []
    for _ in range(PEAKS):
        windows = [range(max(0, at - HALF), min(len(rows), at + HALF + 1)) for at in range(len(rows))]
        sums = [sum(rows[row] for row in window) for window in windows]
        middle = sums.index(max(sums))
        if sums[middle] < LEAST_PROBABILITY:
            break
        found.append((sum(row * rows[row] for row in windows[middle]) / sums[middle], sums[middle]))
        for row in range(len(rows)):
            if abs(row - middle) <= 2 * HALF + 1:
                rows[row] = 0.0
    return found


# Sixty-fourths add up without an error, so that windows that are equal are so in any order of adding.
@given(st.lists(st.integers(0, 16).map(lambda part: part / 64), min_size=2 * HALF + 1, max_size=24))
def test_peaks_are_those_that_a_look_at_all_windows_finds(rows):
    before = np.array(rows)
    found = peaks(given_rows := before.copy())
    assert found == [(pytest.approx(row), pytest.approx(share)) for row, share in by_hand(rows)]
    assert given_rows.tolist() == before.tolist(), "the probabilities stay as they are"


def test_a_peak_is_between_the_rows_that_share_it():
    rows = np.zeros(40)
    rows[[10, 11, 12]], rows[[30, 31]] = [0.1, 0.2, 0.1], [0.3, 0.1]
    assert peaks(rows) == [pytest.approx((11.0, 0.4)), pytest.approx((30.25, 0.4))]


def test_what_is_beside_a_peak_is_no_other_peak():
    rows = np.zeros(60)
    rows[18:23], rows[20 + 2 * HALF + 1], rows[40] = (0.05, 0.1, 0.2, 0.1, 0.05), 0.2, 0.1
    assert [row for row, _ in peaks(rows)] == pytest.approx([20.0, 40.0])


@pytest.mark.parametrize(("share", "count"), [(0.9 * LEAST_PROBABILITY, 0), (1.1 * LEAST_PROBABILITY, 1)])
def test_what_is_hardly_probable_is_no_peak(share, count):
    rows = np.zeros(ROWS)
    rows[100] = share
    assert len(peaks(rows)) == count


def test_peaks_at_both_ends_stay_within_the_rows():
    rows = np.zeros(ROWS)
    rows[0], rows[-1] = 0.5, 0.4
    assert peaks(rows) == [(0.0, 0.5), (ROWS - 1.0, 0.4)]


@pytest.mark.parametrize("count", [1, 7])
def test_probabilities_of_a_wall_sum_to_one(count):
    probability = foot_probabilities(noise(count))
    assert probability.shape == (count, ROWS + 1)
    assert probability.min() >= 0
    assert probability.sum(axis=1) == pytest.approx(np.ones(count))


def test_strips_beyond_one_batch_are_read_as_one_by_one():
    strips = noise(AT_ONCE + 3)
    alone = np.concatenate([foot_probabilities(strip[None]) for strip in strips])
    np.testing.assert_allclose(foot_probabilities(strips), alone, atol=1e-5)
    assert np.ptp(alone, axis=0).max() > 0.01, "the strips are not all read alike"


def test_log_odds_that_are_large_are_probabilities_all_the_same(monkeypatch):
    log_odds = np.zeros((1, ROWS + 1))
    log_odds[0, :2] = 2000.0, 1999.0
    monkeypatch.setattr(linecad.ties.feet, "_run", lambda _: log_odds)
    assert foot_probabilities(noise(1))[0, :3] == pytest.approx([1 / (1 + np.exp(-1)), 1 / (1 + np.exp(1)), 0.0])


def fields(message):
    """Number and value of each field of a message in Protocol Buffers' encoding: an int, or the bytes of another."""

    def number():
        value = shift = 0
        while True:
            byte = next(rest)
            value, shift = value | (byte & 127) << shift, shift + 7
            if byte < 128:
                return value

    rest = iter(message)
    for first in rest:
        rest = chain([first], rest)
        field, kind = divmod(number(), 8)
        assert kind in (0, 2), "ONNX has no other kind where we look"
        yield field, number() if kind == 0 else bytes(islice(rest, number()))


def inside(message, *path):
    """The values of the fields to which field numbers lead."""
    for number in path[:1]:
        for field, value in fields(message):
            if field == number:
                yield from inside(value, *path[1:])
    if not path:
        yield message


def test_the_network_is_small_and_reads_strips():
    assert NETWORK.stat().st_size <= MOST_BYTES
    (graph,) = inside(NETWORK.read_bytes(), 7)
    # ValueInfoProto.type.tensor_type.shape.dim.dim_value; the first dimension is free and has a name.
    assert list(inside(graph, 11, 2, 1, 2, 1, 1)) == [6, ROWS, COLUMNS]
    assert list(inside(graph, 12, 2, 1, 2, 1, 1)) == [ROWS + 1]
    assert (ROWS, COLUMNS) == (216, 64)
    assert foot_probabilities(noise(3)).shape == (3, ROWS + 1)


def test_two_runs_of_the_network_give_the_same_numbers():
    strips = noise(5)
    first = foot_probabilities(strips)
    foot_probabilities(noise(2, seed=1))  # another batch in between
    assert foot_probabilities(strips).tobytes() == first.tobytes()
    linecad.ties.feet._network.cache_clear()
    assert foot_probabilities(strips).tobytes() == first.tobytes()


@pytest.fixture(scope="module")
def house(brick_lane, build_setting):
    """Two walls on one pavement, as two bodies moved by so much or as one."""
    seen, _ = brick_lane

    def look(moved=(0.0, 0.0), is_one=False):
        body = np.zeros_like(seen.part) if is_one else seen.part
        return build_setting(seen, moved[: body.max() + 1], body, pixels=seen.sight.pixels)

    return look


@pytest.fixture(scope="module")
def below(brick_lane):
    """Log height of the pavement below the camera."""
    return np.log(brick_lane[1])


@pytest.mark.parametrize("moved", [(0.0, 0.0), (0.7, -0.4)])
def test_the_feet_of_two_walls_are_found_at_the_scales_of_their_bodies(house, below, moved):
    found = feet_of(house(moved))
    first = [next(foot for foot in found if foot.body == body) for body in range(2)]
    for foot, by in zip(first, moved, strict=True):
        assert foot.log_height == pytest.approx(below + by, abs=FOUND)
        assert foot.probability > 0.5
        assert foot.others == 0.0, "each body has one wall"
        assert foot.probability + foot.unseen <= 1 + 1e-9
    assert [foot.wall.plane.normal for foot in first] == [1, 0]


def test_walls_of_one_body_that_agree_have_one_foot(house, below):
    found = feet_of(house((0.3,), is_one=True))
    assert found[0].log_height == pytest.approx(below + 0.3, abs=FOUND)
    assert found[0].others > 0.15, "the other wall says the same, if less clearly"
    assert [foot.body for foot in found] == [0] * len(found)
    assert all(abs(foot.log_height - found[0].log_height) >= SAME for foot in found[1:])


def test_without_pixels_there_are_no_feet(house):
    setting = house()
    assert feet_of(replace(setting, sight=replace(setting.sight, pixels=None))) == []


def test_without_walls_there_are_no_feet(build_town, build_wall, build_setting):
    seen = build_town(build_wall(1, 10.0, np.array([-4.0, -1.0]), np.array([-2.0, 2.5]))[:2])
    assert feet_of(build_setting(seen, pixels=np.zeros((2880, 3840, 3), np.uint8))) == []


@pytest.fixture
def told(house, monkeypatch):
    """The feet that a house has when the network says so of its walls: of one body, first the wall along the way.

    What it says are log heights with their probabilities.
    """

    def tell(*of_walls, unseen=0.05, is_one=True):
        setting = house(is_one=is_one)
        probability = np.zeros((len(of_walls), ROWS + 1))
        drawer = StripDrawer(setting)
        for number, (wall, said) in enumerate(zip(find_walls(setting), of_walls, strict=True)):
            top = drawer.draw(wall).top
            for log_height, share in said:
                row = (log_height - top) / ROW - 0.5
                between = row - int(row)
                probability[number, int(row) : int(row) + 2] = share * (1 - between), share * between
        probability[:, ROWS] = unseen
        monkeypatch.setattr(linecad.ties.feet, "foot_probabilities", lambda _: probability)
        return feet_of(setting)

    return tell


def test_a_foot_knows_what_speaks_for_and_against_it(told):
    first, second, third = told([(0.4, 0.5), (-0.5, 0.2)], [(0.4, 0.6), (0.0, 0.3)])
    assert [foot.probability for foot in (first, second, third)] == pytest.approx([0.6, 0.3, 0.2])
    assert [foot.log_height for foot in (first, second, third)] == pytest.approx([0.4, 0.0, -0.5])
    assert [foot.others for foot in (first, second, third)] == pytest.approx([0.5, 0.0, 0.0])
    assert [foot.against for foot in (first, second, third)] == pytest.approx([0.3, 0.6, 0.6])
    assert [foot.unseen for foot in (first, second, third)] == [0.05] * 3
    assert [foot.wall.plane.normal for foot in (first, second, third)] == [1, 1, 0]


def test_the_clearest_wall_speaks_for_its_body(told):
    first, second = told([(0.4, 0.8), (-0.5, 0.1)], [(0.4, 0.3)])
    assert (first.probability, first.others, first.against) == pytest.approx((0.8, 0.3, 0.1))
    assert first.wall.plane.normal == 0
    assert second.probability == pytest.approx(0.1)


@pytest.mark.parametrize(("apart", "feet"), [(0.9 * SAME, 1), (1.1 * SAME, 2)])
def test_feet_at_nearly_one_height_are_one(told, apart, feet):
    assert len(told([(0.4, 0.6)], [(0.4 + apart, 0.5)])) == feet


def test_a_body_has_a_few_feet(told):
    found = told([(0.4, 0.4), (0.0, 0.3)], [(0.8, 0.2), (-0.4, 0.1)])
    assert MOST_FEET == 3
    assert [foot.probability for foot in found] == pytest.approx([0.4, 0.3, 0.2])


def test_bodies_have_feet_of_their_own(told):
    found = told([(0.4, 0.4)], [(0.4, 0.6)], is_one=False)
    assert [(foot.body, foot.others, foot.against) for foot in found] == [(0, 0.0, 0.0), (1, 0.0, 0.0)]


def test_a_wall_that_is_not_drawn_has_no_foot(house, monkeypatch):
    setting = house()
    drawn = StripDrawer.draw

    def draw(drawer: StripDrawer, wall) -> Strip | None:
        return drawn(drawer, wall) if wall.body == 1 else None

    monkeypatch.setattr(StripDrawer, "draw", draw)
    assert {foot.body for foot in feet_of(setting)} == {1}


def test_a_wall_is_looked_at_once_whatever_bodies_it_is_of(house, monkeypatch):
    """Pieces of bodies ask for walls that whole bodies asked for before."""
    parted, whole = house(), house(is_one=True)
    looked = []
    monkeypatch.setattr(
        linecad.ties.feet,
        "foot_probabilities",
        lambda strips: [looked.append(len(strips)), foot_probabilities(strips)][1],
    )
    alone = [feet_of(setting) for setting in (parted, whole)]
    looked.clear()
    reader = FootReader(parted)
    shared = [find_feet(setting, reader) for setting in (parted, whole, parted)]
    keys = {wall.key for setting in (parted, whole) for wall in find_walls(setting)}
    assert sum(looked) == len(keys)
    for one, other in zip(shared, [*alone, alone[0]], strict=True):
        assert [(each.body, each.log_height, each.probability) for each in one] == [
            (each.body, each.log_height, each.probability) for each in other
        ]
