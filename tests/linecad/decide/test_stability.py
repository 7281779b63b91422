"""Rigid bodies by resampling: walls joined by one line, walls joined by many, inconsistent photos."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.decide.stability import (
    STABILITY,
    STABILITY_IF_INCONSISTENT,
    Fits,
    find_stable_bodies,
    inconsistency_of,
    resample,
    stability,
)
from linecad.line_graph import LineGraph, Segments
from solver.robust import RobustFit, agreeing_with

GRID = 12  # lines of each direction of a wall


def walls(bars, contradiction=0.0, kind="X"):
    """Two walls of a grid of lines each, and crossings of `bars` lines of the first with six uprights of the second.

    `contradiction` is by how much, in log depth, every other bar says another relative depth of the walls.
    """
    axis = np.tile(np.repeat([0, 2], GRID), 2)
    level, upright = np.arange(GRID), np.arange(GRID, 2 * GRID)
    own = np.array([(i, j) for i in level for j in upright])
    between = [(i, 2 * GRID + j) for i in level[:bars] for j in upright[:6]]
    edges = np.concatenate([own, own + 2 * GRID, np.array(between, int).reshape(-1, 2)])
    ratio = np.zeros(len(edges))
    joins = np.arange(len(edges)) >= 2 * len(own)
    ratio[joins] = np.where(edges[joins, 0] % 2, contradiction, 0.0)
    yes = np.ones(len(edges), bool)
    graph = LineGraph(
        segments=Segments(np.tile([[0.0, 0.0], [90.0, 0.0]], (4 * GRID, 1, 1)), axis),
        rays=np.ones((4 * GRID, 3)),
        end_rays=np.ones((4 * GRID, 2, 3)),
        edges=edges,
        crossing=np.zeros((len(edges), 2)),
        gap=np.where(joins, 30.0, 0.0)[:, None] * [1, 1],
        kind=np.where(joins, kind, "X"),
        corner=~yes,
        weight=np.ones(len(edges)),
        coordinate=3 - axis[edges].sum(axis=1),
        log_ratio=ratio,
        tolerance=np.full(len(edges), 0.005),
        possible=yes,
        informative=yes,
    )
    return graph, RobustFit(graph).depths(), resample(graph)


def bodies(graph, depth, fits, is_inconsistent=False):
    return find_stable_bodies(graph, agreeing_with(graph, depth), depth, fits, is_inconsistent)


def test_walls_that_agree_are_one_body():
    found = bodies(*walls(6))
    assert found.bodies.count == 1
    assert (found.bodies.body == 0).all()
    assert found.firm.all()


def test_walls_joined_by_crossings_that_contradict_each_other_are_two_in_an_inconsistent_photo():
    graph, depth, fits = walls(9, contradiction=0.2)
    joins = np.arange(len(graph.edges)) >= 2 * GRID**2
    together = bodies(graph, depth, fits).bodies.joins(graph)
    assert together[joins].any()
    assert together[~joins].all()
    assert not bodies(graph, depth, fits, is_inconsistent=True).bodies.joins(graph)[joins].any()


def test_every_line_has_one_body():
    found = bodies(*walls(3, contradiction=0.1))
    assert found.bodies.body.min() >= 0
    assert (found.firm <= found.bodies.rigid).all()


def test_stability_is_the_share_of_fits_that_leave_a_line_in_place():
    count = 8
    depth = np.zeros((4, count))
    depth[:, 0] = [0.0, 0.0, 0.5, 0.5]  # moves in two of the four
    depth += np.array([0.0, 1.0, 2.0, 3.0])[:, None]  # the scale of a fit means nothing
    present = np.ones((4, count), bool)
    present[3, 0] = False  # in one of these two it is absent
    fits = Fits(present, depth, np.zeros((4, count), np.int64))
    found = stability(np.ones(count, bool), np.zeros(count), fits)
    assert found[0] == pytest.approx(2 / 3)
    assert (found[1:] == 1).all()


def test_a_line_that_is_tied_to_nothing_in_a_fit_says_nothing_there():
    group = np.zeros((2, 6), np.int64)
    group[1, 0] = 1
    depth = np.zeros((2, 6))
    depth[1, 0] = 0.7
    fits = Fits(np.ones((2, 6), bool), depth, group)
    assert stability(np.ones(6, bool), np.zeros(6), fits)[0] == 1


def test_each_fit_leaves_out_three_lines_of_ten_and_three_running_none_twice():
    _, _, fits = walls(2)
    left_out = ~fits.present
    assert np.abs(left_out.mean(axis=1) - 0.3).max() < 0.03
    assert (left_out[:3].sum(axis=0) <= 1).all()


def test_lines_that_are_left_out_of_a_fit_have_no_say_in_it():
    graph, depth, _ = walls(2)
    liar = 7
    lies = (graph.edges == liar).any(axis=1)
    fits = resample(replace(graph, log_ratio=np.where(lies, 0.3, graph.log_ratio)))
    without = ~fits.present[:, liar]
    assert without.any()
    for present, found in zip(fits.present[without], fits.depth[without], strict=True):
        assert np.ptp((found - depth)[present]) < 1e-6
        assert (found[~present] == 0).all()


def test_fits_are_the_same_for_the_same_seed():
    graph, _, _ = walls(2)
    one, two = (resample(graph, 5, 3) for _ in range(2))
    assert (one.present == two.present).all()
    assert (one.depth == two.depth).all()


def test_contradicting_corners_make_a_photo_inconsistent():
    consistent = inconsistency_of(*walls(9, kind="L"), 3840)
    inconsistent = inconsistency_of(*walls(9, contradiction=0.2, kind="L"), 3840)
    assert inconsistent > consistent + 0.1


def test_an_inconsistent_photo_must_be_more_stable():
    assert STABILITY < STABILITY_IF_INCONSISTENT
