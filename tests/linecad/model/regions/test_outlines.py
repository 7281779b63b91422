"""Outlines of a wall and its side, painted sample by sample, with lines that cut off steps."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders
from linecad.model.regions.labels import UNIT, Labels
from linecad.model.regions.outlines import LONGEST, RUNS, Outlined, simplest
from linecad.model.regions.surfaces import Surface

WIDTH, HEIGHT = 200, 100  # px, a sample each
WALL, SIDE, OTHER, SKY, CLUTTER = range(5)
SURFACES = [Surface("wall", axis, 8.0, np.zeros(0, np.int64), axis) for axis in (0, 1, 1)]


def upright(x, top=0.0, bottom=HEIGHT):
    return np.array([[x, top], [x, bottom]]) - 0.5


def level(y, left=0.0, right=WIDTH):
    return np.array([[left, y], [right, y]]) - 0.5


def painted(*boxes):
    """Costs of each sample, clutter but for boxes (label, its cost, that of others, left, top, right, bottom)."""
    costs = np.ones((HEIGHT, WIDTH, 5))
    costs[..., CLUTTER] = 0.5
    for label, own, other, left, top, right, bottom in boxes:
        costs[top:bottom, left:right, :CLUTTER] = other
        costs[top:bottom, left:right, label] = own
    return costs.reshape(-1, 5)


def drawing(costs, segments):
    """A function of rows of segments that labels each cell which they cut out with what costs least in it."""
    segments = np.array(segments)

    def draw(used):
        lines, rows = partition.extended(segments[used], WIDTH, HEIGHT, 1.0)
        cells = partition.cut(lines)
        cell = partition.draw(cells, (HEIGHT, WIDTH), 1.0)
        whole = np.column_stack([np.bincount(cell, each, len(cells)) for each in UNIT * costs.T]).astype(np.int64)
        nothing = Borders(np.zeros((0, 2), np.int64), np.zeros(0, np.int64))
        labels = Labels(SURFACES, cells, cell, whole.argmin(axis=1), costs, whole, nothing)
        return Outlined(labels, lines, np.append(used, -1)[rows])

    return draw


def simplified(costs, segments, meets=0):
    draw = drawing(costs, segments)
    first = draw(np.arange(len(segments)))
    return first, simplest(first, draw, meets)


def share(labels, number):
    return (labels.label[labels.cell] == number).mean()


def corners(labels):
    return sum(len(region.exterior.coords) - 1 for _, region in labels.regions)


FRONT = (WALL, 0.0, 1.0, 0, 0, 120, HEIGHT)


def test_the_border_of_a_line_is_where_it_separates_two_labels():
    found = drawing(painted(FRONT), [upright(120), level(40)])(np.arange(2))
    length = dict(zip(found.rows.tolist(), found.border().tolist(), strict=True))
    assert length[0] == pytest.approx(HEIGHT)
    assert length[1] == 0
    assert found.used.tolist() == [0, 1]
    assert found.width == WIDTH


@pytest.mark.parametrize(("own", "is_step"), [(0.45, True), (0.3, False)])
def test_a_step_stays_where_it_is_worth_its_corners(own, is_step):
    """A part of a wall that costs nearly as much as clutter, of which every edge is longer than any run."""
    assert RUNS[-1] * WIDTH < 42 < LONGEST * WIDTH
    costs = painted(FRONT, (WALL, own, 1.0, 120, 0, 162, 42))
    _, found = simplified(costs, [upright(120), upright(162, 0, 42), level(42, 120, 162)])
    assert corners(found) == (8 if is_step else 12)


def test_where_surfaces_meet_is_no_step():
    costs = painted(FRONT, (WALL, 0.45, 1.0, 120, 0, 162, 42))
    segments = [upright(162, 0, 42), upright(120), level(42, 120, 162)]
    assert corners(simplified(costs, segments)[1]) == 8
    assert corners(simplified(costs, segments, meets=3)[1]) == 12


def test_more_than_a_fifth_of_what_a_label_shows_is_no_step():
    """Without the block beside it the side would have two corners less, but half of its area too."""
    costs = painted(FRONT, (SIDE, 0.0, 1.0, 120, 0, 140, HEIGHT), (SIDE, 0.45, 1.0, 140, 0, 182, 42))
    segments = [upright(120), upright(140), upright(182, 0, 42), level(42, 140, 182)]
    _, found = simplified(costs, segments)
    narrow = drawing(costs, segments)(np.arange(2)).labels
    assert narrow.price < found.price
    assert share(found, SIDE) == pytest.approx((20 * HEIGHT + 42 * 42) / WIDTH / HEIGHT)


# Edges of a side, longer than all runs but the last two.
AROUND = [upright(150, 40, 62), upright(180, 40, 62), level(40, 150, 180), level(62, 150, 180)]


STEPS = [(WALL, 0.0, 1.0, 120, y, 128, y + 34) for y in (0, 60)]  # worth less than their corners
ENDS = [upright(128), *(level(y, 110, 130) for y in (34, 60, 94))]  # of these, that only the longest run takes away


def test_a_wall_is_not_given_up_to_clutter_for_corners_of_others():
    """The side is gone by the time that the steps go."""
    costs, segments = painted(FRONT, *STEPS, (SIDE, 0.0, 1.0, 150, 40, 180, 62)), [upright(120), *AROUND, *ENDS]
    assert RUNS[-3] * WIDTH < 22 < RUNS[-2] * WIDTH < 34 < RUNS[-1] * WIDTH
    first, found = simplified(costs, segments)
    without = drawing(costs, segments)(np.array([0])).labels
    assert corners(first.labels) > corners(found) == corners(without) + 4
    assert share(found, SIDE) == pytest.approx(30 * 22 / WIDTH / HEIGHT, rel=0.1)
    assert without.price < found.price  # by the corners of the clutter around it alone
    assert without.price_of_faces > found.price_of_faces


@pytest.mark.parametrize("taken_by", [CLUTTER, OTHER])
def test_a_wall_is_asked_back_from_clutter_but_not_from_another_wall(taken_by):
    """Where another wall is shown in its place, there is a face all the same."""
    boxes = (OTHER, 0.0, 1.0, 170, 0, WIDTH, HEIGHT), (SIDE, 0.0, 0.45, 120, 0, 150, HEIGHT)
    draw = drawing(painted(FRONT, *boxes), [upright(120), upright(150), upright(170)])
    back = draw(np.arange(3))
    taken = replace(back.labels, label=np.where(back.labels.label == SIDE, taken_by, back.labels.label))
    dear = replace(back, labels=replace(back.labels, costs=back.labels.costs + 10**6))
    answers = [replace(back, labels=taken)] * len(RUNS)
    found = simplest(dear, lambda _: answers.pop() if answers else back, 0)
    assert taken.price > back.labels.price
    assert share(found, SIDE) == (share(back.labels, SIDE) if taken_by == CLUTTER else 0)
