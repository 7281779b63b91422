"""Cues as a whole: they are summed, a new one is a row, and unary ones reach the robust fit and the lifting."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.camera.photo import Photo
from linecad.finding import connect, find_lines
from linecad.graph import cues
from linecad.graph.build import build_line_graph
from linecad.graph.cues import STEP, CueSet, Known, weigh
from linecad.line_graph import LineDepths
from linecad.model.lifting import fit_log_depths, lift
from linecad.options import LONG_REACH, WEIGHTS, Options
from solver.robust import RobustFit


@pytest.fixture(scope="module")
def graph(made):
    return build_line_graph(made.segments, made.camera, made.frame, LONG_REACH, "odds", True)


@pytest.fixture(scope="module")
def known(made, graph):
    return Known(graph, made.camera, made.frame, np.zeros((made.camera.height, made.camera.width, 3), np.uint8))


def true_log_depths(made, graph):
    rays = graph.rays * (np.arange(3) != graph.axis[:, None])
    order = [int(np.flatnonzero((made.pixels == ends).all(axis=(1, 2)))[0]) for ends in graph.segments.ends]
    return np.log((rays * made.ends[order, 0]).sum(axis=1) / (rays**2).sum(axis=1))


def test_a_cue_more_adds_its_log_odds(known, monkeypatch):
    seen = []

    def dark(told):
        seen.append(told)
        return np.where(told.pixels.mean() < 1, 2.0, 0.0) * np.ones(len(told.graph.edges))

    before = weigh(known, "odds")
    monkeypatch.setitem(cues.CUES, "odds", CueSet((*cues.CUES["odds"].cues, dark)))
    after = weigh(known, "odds")
    assert seen == [known]
    well_above = before.weight > STEP
    assert (after.weight - before.weight)[well_above].tolist() == [2.0] * int(well_above.sum())


def test_a_cue_that_looks_at_the_photo_gets_its_pixels(made, monkeypatch):
    shapes = []
    monkeypatch.setitem(
        cues.CUES,
        "ones",
        CueSet((lambda told: shapes.append(told.pixels.shape) or np.ones(len(told.graph.edges)),), are_log_odds=False),
    )
    pixels = np.zeros((made.camera.height, made.camera.width, 3), np.uint8)
    build_line_graph(made.segments, made.camera, made.frame, LONG_REACH, "ones", False, pixels)
    assert shapes == [(made.camera.height, made.camera.width, 3)]


def test_a_photo_reaches_the_cues_by_way_of_its_lines(made, monkeypatch):
    shapes = []

    def look(told):
        shapes.append(told.pixels.shape)
        return np.ones(len(told.graph.edges))

    monkeypatch.setitem(cues.CUES, "ones", CueSet((look,), are_log_odds=False))
    photo = Photo("made.png", np.repeat(made.image()[..., None], 3, axis=2), made.camera)
    connect(find_lines(photo), Options(weights="ones", joins="biconnected", reach=LONG_REACH))
    assert shapes == [photo.pixels.shape]


def test_log_odds_that_speak_against_an_edge_leave_it_the_least_weight(known, monkeypatch):
    monkeypatch.setitem(cues.CUES, "ones", CueSet((lambda known: np.full(len(known.graph.edges), -7.3),)))
    assert set(weigh(known, "ones").weight) == {STEP}


@pytest.mark.parametrize("weights", WEIGHTS)
def test_every_set_of_cues_gives_positive_weights(known, weights):
    weight = weigh(known, weights).weight
    assert weight.min() > 0
    assert len(np.unique(weight)) > 1 or weights == "ones"


def test_log_odds_come_in_whole_steps(graph):
    assert (graph.weight % STEP == 0).all()
    assert graph.weight.min() >= STEP


def test_a_unary_cue_reaches_the_graph_and_its_parts(known, monkeypatch):
    depth = LineDepths(np.array([0, 7]), np.log([5.0, 6.0]), np.array([0.1, 0.1]), np.array([False, True]))
    monkeypatch.setattr(cues, "UNARY_CUES", (lambda _: depth, lambda _: LineDepths([3], [0.5], [0.2], [True])))
    graph = weigh(known, "odds")
    assert graph.depths.line.tolist() == [0, 7, 3]
    part = graph.subset(np.array([3, 7, 8]))
    assert part.depths.line.tolist() == [1, 0]
    assert part.depths.log_depth.tolist() == [np.log(6.0), 0.5]


@pytest.mark.parametrize(
    ("message", "change"),
    [
        ("sigma", {"sigma": [0.0]}),
        ("entries", {"log_depth": [1.0, 2.0]}),
        ("line", {"line": [-1]}),
        ("finite", {"log_depth": [np.nan]}),
    ],
)
def test_depths_that_cannot_be(message, change):
    fields = {"line": [0], "log_depth": [1.0], "sigma": [0.1], "may_be_outlier": [True]} | change
    with pytest.raises(ValueError, match=message):
        LineDepths(**fields)


def test_a_depth_of_a_line_that_is_not_there(graph):
    with pytest.raises(ValueError, match="name segment"):
        replace(graph, depths=LineDepths([len(graph.segments)], [1.0], [0.1], [True]))


# The two boxes of the made scene, which true crossings alone do not tie: depths of a few lines place both.


@pytest.fixture(scope="module")
def apart(made, graph):
    """The graph with its true crossings alone, the true log depths, and the box of each line."""
    truth = true_log_depths(made, graph)
    real = graph.informative & (graph.misfit(truth) < 1e-6)
    weight = np.where(real, graph.weight, 1e-12)
    order = [int(np.flatnonzero((made.pixels == ends).all(axis=(1, 2)))[0]) for ends in graph.segments.ends]
    return replace(graph, weight=weight), truth, made.box[order], real


def told_of(graph, truth, box, wrong=()):
    lines = np.concatenate([np.flatnonzero(box == side)[:5] for side in (0, 1)])
    value = truth[lines].copy()
    value[list(wrong)] += 1.0
    return replace(graph, depths=LineDepths(lines, value, np.full(10, 0.02), np.ones(10, bool)))


def test_the_robust_fit_places_both(apart):
    graph, truth, box, _ = apart
    fitted = RobustFit(told_of(graph, truth, box)).depths()
    assert np.abs(fitted - truth).max() < 0.01


def test_an_outlier_is_given_up(apart):
    graph, truth, box, _ = apart
    fitted = RobustFit(told_of(graph, truth, box, wrong=[2, 8])).depths()
    assert np.abs(fitted - truth).max() < 0.01


def test_without_the_switch_it_pulls(apart):
    graph, truth, box, _ = apart
    told = told_of(graph, truth, box, wrong=[2, 8])
    depths = replace(told.depths, may_be_outlier=np.zeros(10, bool))
    assert np.abs(RobustFit(replace(told, depths=depths)).depths() - truth).max() > 0.1


def test_a_line_that_is_left_out_of_a_fit_tells_nothing_in_it(apart):
    graph, truth, box, _ = apart
    told = told_of(graph, truth, box, wrong=range(5))
    depths = replace(told.depths, may_be_outlier=np.zeros(10, bool))
    present = np.setdiff1d(np.arange(len(truth)), told.depths.line[:5])
    fitted = RobustFit(replace(told, depths=depths).subset(present)).depths()
    assert np.abs(fitted - truth[present])[box[present] == 1].max() < 0.01


def test_lifting_keeps_the_depths_that_are_told(apart):
    graph, truth, box, real = apart
    told = told_of(graph, truth, box, wrong=[3])
    shifted = truth + np.where(box == 1, 0.02, 0.0)  # within what the depths explain, so that none is an outlier
    fitted = fit_log_depths(told, real, shifted)
    assert np.abs(fitted - truth).max() < 0.005
    plain = fit_log_depths(graph, real, shifted)
    assert np.abs(plain - truth)[box == 1].min() > 0.015


@pytest.mark.parametrize("scale", [-3.0, 2.0])
def test_lifting_keeps_them_whatever_the_scale_of_the_depths_it_starts_from(apart, scale):
    graph, truth, box, real = apart
    told = told_of(graph, truth, box, wrong=[3])
    start = truth + np.where(box == 1, scale, -scale)  # each group of lines has a scale of its own
    assert np.abs(fit_log_depths(told, real, start) - truth).max() < 0.005


def test_lifting_is_pulled_by_a_depth_that_cannot_be_an_outlier(apart):
    graph, truth, box, real = apart
    told = told_of(graph, truth, box, wrong=[3])
    depths = replace(told.depths, may_be_outlier=np.zeros(10, bool))
    assert np.abs(fit_log_depths(replace(told, depths=depths), real, truth) - truth).max() > 0.05


def test_the_lines_in_space_follow(apart):
    graph, truth, box, real = apart
    told = told_of(graph, truth, box)
    shifted = truth + np.where(box == 1, 0.02, 0.0)
    one, other = lift(told, real, truth), lift(told, real, shifted)
    np.testing.assert_allclose(other.ends, one.ends, rtol=2e-3, atol=1e-6)


@given(st.lists(st.tuples(st.integers(0, 9), st.floats(-3, 3), st.floats(1e-3, 1), st.booleans()), max_size=8))
def test_what_several_sources_tell_is_all_of_it(rows):
    def of(some):
        return LineDepths(*(list(column) for column in zip(*some, strict=True))) if some else LineDepths.none()

    parts = [of(rows[: len(rows) // 2]), of(rows[len(rows) // 2 :])]
    joined = LineDepths.joined(parts)
    assert list(zip(joined.line, joined.log_depth, joined.sigma, joined.may_be_outlier, strict=True)) == rows
