"""Outlines of a wall and its flank, painted sample by sample, with lines that cut off steps."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.model.regions import partition
from linecad.model.regions.cuts import Borders
from linecad.model.regions.labels import UNIT, Labels
from linecad.model.regions.outlines import LONGEST, RUNS, Outlined, simplest
from linecad.model.regions.surfaces import Surface

WIDTH, HEIGHT = 200, 100  # px, a sample each
WALL, FLANK, OTHER, SKY, CLUTTER = range(5)
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


def test_the_border_of_a_line_is_its_own_where_another_goes_on_in_line_with_it():
    boxes = [(WALL, 0.0, 1.0, 20, 42, 62, HEIGHT), (WALL, 0.0, 1.0, 120, 42, 150, HEIGHT)]
    segments = [upright(x, 42) for x in (20, 62, 120, 150)] + [level(42, 20, 62), level(42, 120, 150)]
    found = drawing(painted(*boxes), segments)(np.arange(6))
    length = dict(zip(found.rows.tolist(), found.border().tolist(), strict=True))
    assert [length[row] for row in (4, 5)] == [42, 30]


@pytest.mark.parametrize(("own", "is_step"), [(0.45, True), (0.3, False)])
def test_a_step_stays_where_it_is_worth_its_corners(own, is_step):
    """A part of a wall that costs nearly as much as clutter, of which every edge is longer than any run."""
    assert RUNS[-1] * WIDTH < 42 < LONGEST * WIDTH
    costs = painted(FRONT, (WALL, own, 1.0, 120, 0, 162, 42))
    _, found = simplified(costs, [upright(120), upright(162, 0, 42), level(42, 120, 162)])
    assert corners(found) == (8 if is_step else 12)


def test_a_long_border_is_no_step():
    """Though the block is worth less than its corners, and is less than a fifth of its wall."""
    wall = [(WALL, 0.0, 1.0, 0, 0, 137, HEIGHT), (WALL, 0.0, 1.0, 137, 72, WIDTH, HEIGHT)]
    costs = painted(*wall, (WALL, 0.48, 1.0, 137, 0, 198, 61))
    segments = [upright(137), level(72, 137), upright(198, 0, 61), level(61, 137, 198)]
    _, found = simplified(costs, segments)
    without = drawing(costs, segments)(np.array([0, 1])).labels
    assert LONGEST * WIDTH < 61
    assert without.price < found.price
    assert share(without, WALL) < share(found, WALL) < share(without, WALL) / 0.8


def test_where_surfaces_meet_is_no_step():
    costs = painted(FRONT, (WALL, 0.45, 1.0, 120, 0, 162, 42))
    segments = [upright(162, 0, 42), level(42, 120, 162), upright(120)]
    assert corners(simplified(costs, segments)[1]) == 8
    assert corners(simplified(costs, segments, meets=2)[1]) == 12


def test_lines_are_asked_once_by_their_border_the_shortest_first():
    costs = painted(FRONT, (WALL, 0.3, 1.0, 120, 0, 164, 42))
    segments = [level(80, 0, 110), upright(120), upright(164, 0, 42), level(42, 120, 164)]
    draw, asked = drawing(costs, segments), []

    def recorded(used):
        asked.append(used.tolist())
        found = draw(used)
        dearer = 100 if len(asked) <= len(RUNS) else 0  # so that the first answer is best, in which row 0 cuts nothing
        return replace(found, labels=replace(found.labels, costs=found.labels.costs + dearer * UNIT))

    first = draw(np.arange(4))
    simplest(first, recorded, 0)
    border = dict(zip(first.rows.tolist(), first.border().tolist(), strict=True))
    assert border[0] == 0
    assert border[2] < border[3] < border[1] == 58
    assert asked[len(RUNS) :] == [[0, 1, 3], [0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize("right", [133, 100])
def test_more_than_a_fifth_of_what_a_label_shows_is_no_step(right):
    """Without the block beside it the flank would have two corners less, but a fourth or half less area too."""
    block = (FLANK, 0.45, 1.0, right, 0, right + 42, 42)
    costs = painted((WALL, 0.0, 1.0, 0, 0, 80, HEIGHT), (FLANK, 0.0, 1.0, 80, 0, right, HEIGHT), block)
    segments = [upright(80), upright(right), upright(right + 42, 0, 42), level(42, right, right + 42)]
    _, found = simplified(costs, segments)
    narrow = drawing(costs, segments)(np.arange(2)).labels
    assert narrow.price < found.price
    assert share(found, FLANK) == pytest.approx(((right - 80) * HEIGHT + 42 * 42) / WIDTH / HEIGHT)


# Edges of a flank, longer than all runs but the last two.
AROUND = [upright(150, 40, 62), upright(180, 40, 62), level(40, 150, 180), level(62, 150, 180)]


STEPS = [(WALL, 0.0, 1.0, 120, y, 128, y + 34) for y in (0, 60)]  # worth less than their corners
ENDS = [upright(128), *(level(y, 110, 130) for y in (34, 60, 94))]  # of these, that only the longest run takes away


def test_a_wall_is_not_given_up_to_clutter_for_corners_of_others():
    """The flank is gone by the time that the steps go."""
    costs, segments = painted(FRONT, *STEPS, (FLANK, 0.0, 1.0, 150, 40, 180, 62)), [upright(120), *AROUND, *ENDS]
    assert RUNS[-3] * WIDTH < 22 < RUNS[-2] * WIDTH < 34 < RUNS[-1] * WIDTH
    first, found = simplified(costs, segments)
    without = drawing(costs, segments)(np.array([0])).labels
    assert corners(first.labels) > corners(found) == corners(without) + 4
    assert share(found, FLANK) == pytest.approx(30 * 22 / WIDTH / HEIGHT, rel=0.1)
    assert without.price < found.price  # by the corners of the clutter around it alone
    assert without.price_of_faces > found.price_of_faces


@pytest.mark.parametrize("taken_by", [CLUTTER, OTHER])
def test_a_wall_is_asked_back_from_clutter_but_not_from_another_wall(taken_by):
    """Where another wall is shown in its place, there is a face all the same."""
    boxes = (OTHER, 0.0, 1.0, 170, 0, WIDTH, HEIGHT), (FLANK, 0.0, 0.45, 120, 0, 150, HEIGHT)
    draw = drawing(painted(FRONT, *boxes), [upright(120), upright(150), upright(170)])
    back = draw(np.arange(3))
    taken = replace(back.labels, label=np.where(back.labels.label == FLANK, taken_by, back.labels.label))
    dear = replace(back, labels=replace(back.labels, costs=back.labels.costs + 10**6))
    answers = [replace(back, labels=taken)] * len(RUNS)
    found = simplest(dear, lambda _: answers.pop() if answers else back, 0)
    assert taken.price > back.labels.price
    assert share(found, FLANK) == (share(back.labels, FLANK) if taken_by == CLUTTER else 0)


@pytest.mark.parametrize("more_loses", ["itself", "another", None])
def test_a_surface_comes_back_only_as_it_was_and_without_loss_of_others(more_loses):
    boxes = (OTHER, 0.0, 1.0, 170, 0, WIDTH, HEIGHT), (FLANK, 0.0, 0.45, 120, 0, 150, HEIGHT)
    back = drawing(painted(FRONT, *boxes), [upright(120), upright(150), upright(170)])(np.arange(3))

    def without(*gone, cost=0):
        label = np.where(np.isin(back.labels.label, gone), CLUTTER, back.labels.label)
        return replace(back, labels=replace(back.labels, label=label, costs=back.labels.costs + cost))

    best = without(FLANK, cost=10)
    answers = [best] * len(RUNS)
    more = without(*{"itself": (FLANK,), "another": (OTHER,), None: ()}[more_loses])
    found = simplest(without(cost=10**6), lambda _: answers.pop() if answers else more, 0)
    assert found is (more if more_loses is None else best).labels
