"""The most likely camera and frame of made segments, with its standard errors."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from linecad.camera import joint_fit as camerafit
from linecad.camera.joint_fit import (
    CENTER_X,
    CENTER_Y,
    FOCAL,
    PARAMETERS,
    RADIAL,
    TURNS,
    Prior,
    View,
    fit_view,
    known,
    undistorted,
)
from linecad.geometry import directions_to, rotation_about

WIDTH, HEIGHT = 1200, 900
MIDDLE = np.array([599.5, 449.5])
HALF = np.hypot(WIDTH, HEIGHT) / 2
CORNER = View(rotation_about(np.array([0.35, 0.0, 0.0])) @ rotation_about(np.array([0.0, 0.6, 0.1])), 1000.0, MIDDLE)
FREE = Prior(900.0, 0.4, MIDDLE, 0.015)


def along_axes(view, counts, seed, noise=0.0, length=(30, 200)):
    """Segments (N, 2, 2) px along the axes of a view, so many along each, whose ends are off by `noise` px."""
    rng = np.random.default_rng(seed)
    points = (view.axes @ view.matrix.T)[np.repeat(np.arange(3), counts)]
    middle = rng.uniform([0, 0], [WIDTH, HEIGHT], (len(points), 2))
    reach = rng.uniform(*length, (len(points), 1)) / 2 * directions_to(middle, points)
    ends = np.stack([middle - reach, middle + reach], axis=1)
    return ends + rng.normal(0, noise, ends.shape)


def anywhere(count, seed):
    """Segments (count, 2, 2) px in all directions."""
    rng = np.random.default_rng(seed)
    middle, angle = rng.uniform([0, 0], [WIDTH, HEIGHT], (count, 2)), rng.uniform(0, np.pi, count)
    reach = rng.uniform(15, 100, (count, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([middle - reach, middle + reach], axis=1)


def fit(ends, prior=FREE, start=None):
    """The fit from a start some degrees and some percent beside CORNER."""
    beside = replace(CORNER, axes=CORNER.axes @ rotation_about(np.array([0.03, -0.02, 0.03])), focal=1100.0)
    return fit_view(ends, WIDTH, HEIGHT, beside if start is None else start, prior)


def turn_between(one, other):
    """The turn (3,), rad, about the axes of the camera by which one view differs from another."""
    return cv2.Rodrigues(one.axes.T @ other.axes)[0].ravel()


@given(
    st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3), st.floats(500, 4000), st.floats(-200, 200),
    st.floats(-0.05, 0.05), st.integers(0, 1000),
)  # fmt: skip
@settings(max_examples=40)
def test_slopes_are_those_of_small_steps(x, y, z, focal, off, radial, seed):
    """Sines go by the parameters as central differences say; where a vanishing point is far from the segments."""
    straight = View(rotation_about(np.array([x, y, z])), focal, MIDDLE + np.array([off, -off]))
    places = camerafit.Places(anywhere(40, seed))
    for view, free in ((straight, np.arange(RADIAL)), (replace(straight, radial=radial), np.arange(PARAMETERS))):
        sine, _, slope = camerafit._angles(places, view, WIDTH, HEIGHT, free)
        towards = camerafit.angles_against(places, view, WIDTH, HEIGHT).towards
        far = np.linalg.norm(towards, axis=0) > 100 * np.abs((view.axes @ view.matrix.T)[:, None, 2])
        assert slope.shape == (len(free), *sine.shape)
        for parameter, own in zip(free, slope, strict=True):
            step = 1e-6 * np.eye(PARAMETERS)[parameter]
            ahead, behind = (
                camerafit.angles_against(places, view.moved(sign * step, float(WIDTH)), WIDTH, HEIGHT).sine
                for sign in (1, -1)
            )
            differences = ((ahead - behind) / 2e-6)[far]
            assert np.abs(own[far] - differences).max(initial=0) < 2e-3


def test_exact_segments_give_the_exact_view():
    exact = fit(along_axes(CORNER, (60, 60, 60), 1), replace(FREE, focal_error=np.inf, center_error=np.inf))
    assert np.degrees(np.linalg.norm(turn_between(exact.view, CORNER))) < 0.01
    assert exact.view.focal == pytest.approx(CORNER.focal, rel=1e-4)
    assert_allclose(exact.view.center, CORNER.center, atol=0.3)
    assert exact.share[3] < 0.05


def test_segments_as_a_bent_photo_shows_them_tell_the_bend():
    straight = along_axes(CORNER, (100, 100, 100), 2, length=(20, 60))
    bent = MIDDLE + (straight - MIDDLE) * (1 - 0.04 * ((straight - MIDDLE) ** 2).sum(-1, keepdims=True) / HALF**2)
    found = fit(bent, replace(FREE, radial_error=0.05))
    assert found.view.radial == pytest.approx(-0.04, abs=0.001)
    assert found.view.focal == pytest.approx(CORNER.focal, rel=0.01)


def test_the_bend_of_a_cropped_photo_tells_where_its_middle_was():
    """The lens bends about its own middle; once the fit did not know that this moves with the principal point."""
    middle = MIDDLE + np.array([-160.0, 40.0])
    straight = along_axes(replace(CORNER, center=middle), (100, 100, 100), 12, 0.2)
    bent = middle + (straight - middle) * (1 - 0.06 * ((straight - middle) ** 2).sum(-1, keepdims=True) / HALF**2)
    found = fit(bent, replace(FREE, center_error=0.15, radial_error=0.05))
    assert_allclose(found.view.center, middle, atol=15)
    assert np.sqrt(found.covariance[CENTER_X, CENTER_X]) * WIDTH < 15
    assert found.view.radial == pytest.approx(-0.06, abs=0.003)


@pytest.mark.parametrize(
    ("prior", "fixed"),
    [
        (known(CORNER.matrix), [FOCAL, CENTER_X, CENTER_Y, RADIAL]),
        (replace(FREE, center_error=0.0), [CENTER_X, CENTER_Y, RADIAL]),
        (FREE, [RADIAL]),
    ],
    ids=["camera", "center", "bend"],
)
def test_what_is_fixed_stays_and_has_no_error(prior, fixed):
    start = View(CORNER.axes, 1100.0, MIDDLE + 3.0, 0.01)
    found = fit(along_axes(CORNER, (40, 40, 40), 3, 0.3), prior, start)
    before = np.array([start.focal, *start.center, start.radial])
    after = np.array([found.view.focal, *found.view.center, found.view.radial])
    places = np.array(fixed) - FOCAL
    assert (after[places] == before[places]).all()
    assert (np.delete(after, places) != np.delete(before, places)).all()
    assert not found.covariance[fixed].any()
    assert not found.covariance[:, fixed].any()
    assert (np.delete(np.diag(found.covariance), fixed) > 0).all()


def test_a_tight_prior_weighs_more_than_a_wide_one():
    ends = along_axes(CORNER, (15, 15, 15), 4, 0.5)
    focal = [fit(ends, replace(FREE, focal_error=error)).view.focal for error in (1e-3, 0.02, 0.4)]
    assert abs(focal[0] - 900) < 5
    assert focal[0] < focal[1] < focal[2]


def test_standard_errors_are_as_large_as_the_scatter():
    """Of draws whose ends, and whose axes, are off as the model says."""
    prior = replace(FREE, focal_error=np.inf, center_error=0.0)
    turns, focals, errors = [], [], []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        own = np.array([axis @ rotation_about(rng.normal(0, np.radians(0.3), 3)).T for axis in CORNER.axes])
        found = fit(along_axes(replace(CORNER, axes=own), (40, 40, 40), seed, 0.3), prior, CORNER)
        turns.append(turn_between(found.view, CORNER))
        focals.append(np.log(found.view.focal / CORNER.focal))
        errors.append(np.sqrt(np.diag(found.covariance)))
    predicted = np.sqrt(np.mean(np.square(errors), axis=0))
    scatter = np.sqrt(np.mean(np.square(turns), axis=0))
    assert (np.abs(np.log(scatter / predicted[TURNS])) < np.log(2)).all()
    assert 0.5 < np.sqrt(np.mean(np.square(focals))) / predicted[FOCAL] < 2


def test_standard_errors_grow_when_segments_are_few():
    many, few = (fit(along_axes(CORNER, (count,) * 3, 5, 0.5)).covariance for count in (200, 10))
    assert (np.diag(few)[:4] > np.diag(many)[:4]).all()


@pytest.mark.parametrize("seed", range(3))
def test_outliers_of_two_in_five_do_not_move_the_view(seed):
    """They are known for what they are, and the view stays within its standard errors."""
    own = along_axes(CORNER, (60, 60, 60), seed, 0.3)
    found = fit(np.concatenate([own, anywhere(120, seed + 100)]))
    assert np.degrees(np.linalg.norm(turn_between(found.view, CORNER))) < 0.3
    assert found.view.focal == pytest.approx(CORNER.focal, rel=0.02)
    assert found.share[3] == pytest.approx(0.4, abs=0.08)
    assert (found.belongs[3, len(own) :] > 0.5).mean() > 0.8
    assert (found.belongs[3, : len(own)] < 0.5).mean() > 0.95


def test_a_quarter_of_the_segments_a_degree_off_does_not_move_their_axis():
    """Detectors err far more often than by their usual error, and not to both sides alike."""
    ends = along_axes(CORNER, (80, 80, 80), 11, 0.05, length=(60, 200))
    turn = np.radians(1.2)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    middle = ends[::4].mean(axis=1, keepdims=True)
    ends[::4] = middle + (ends[::4] - middle) @ matrix
    found = fit(ends, known(CORNER.matrix), CORNER)
    off = np.degrees(np.arccos(np.clip((found.own_axes * CORNER.axes).sum(axis=1), -1, 1)))
    assert (off < 0.1).all()


def test_an_axis_with_a_thousand_segments_does_not_outvote_one_with_ten():
    """Of a photo that is bent a little, so that the axes of all segments are not orthogonal.

    A turn between two axes is shared by both, however many segments show it.
    """
    skewed = CORNER.axes.copy()
    skewed[0] = CORNER.axes[0] @ rotation_about(np.radians(1.0) * CORNER.axes[2]).T
    ends = along_axes(replace(CORNER, axes=skewed), (1000, 10, 100), 6, 0.1)
    found = fit(ends, known(CORNER.matrix), CORNER)
    share = turn_between(found.view, CORNER) @ CORNER.axes[2] / np.radians(1.0)
    assert 0.25 < abs(share) < 0.75
    assert found.turn > np.radians(0.3)
    off = np.arccos(np.clip((found.own_axes * skewed).sum(axis=1), -1, 1))
    assert (np.degrees(off) < 0.15).all()


def test_axes_of_a_square_scene_have_small_turns_of_their_own():
    found = fit(along_axes(CORNER, (100, 100, 100), 7, 0.2), known(CORNER.matrix), CORNER)
    assert found.turn < np.radians(0.25)


def test_a_usual_turn_is_bounded_where_it_has_to_be():
    skewed = replace(CORNER, axes=CORNER.axes + np.roll(CORNER.axes, 1, axis=0) * 0.05)
    prior = replace(known(CORNER.matrix), largest_turn=np.radians(0.4))
    assert fit(along_axes(skewed, (100, 100, 100), 8), prior, CORNER).turn == np.radians(0.4)


def test_the_better_view_has_the_larger_posterior():
    ends = along_axes(CORNER, (60, 60, 60), 9, 0.3)
    wrong = replace(known(CORNER.matrix), focal=1300.0)
    right = fit(ends, known(CORNER.matrix), CORNER)
    assert right.log_posterior > fit(ends, wrong, replace(CORNER, focal=1300.0)).log_posterior + 10


@given(st.floats(-0.12, 0.25), st.floats(-100, 100), st.floats(-100, 100))
def test_undistorted_undoes_what_a_lens_does(radial, x, y):
    """As OpenCV bends pixels, with k1 = radial (focal / half diagonal)^2; inside three quarters of half a diagonal."""
    center, focal = MIDDLE + np.array([x, y]), 800.0
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    straight = center + HALF * np.concatenate([0.05 * ring, 0.4 * ring, 0.75 * ring])
    rays = np.column_stack([(straight - center) / focal, np.ones(len(straight))])
    matrix = replace(CORNER, focal=focal, center=center).matrix
    k1 = radial * (focal / HALF) ** 2
    taken = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), matrix, np.array([k1, 0, 0, 0]))[0].reshape(-1, 2)
    assert_allclose(undistorted(taken, radial, center, WIDTH, HEIGHT), straight, atol=0.05)


def test_a_view_of_a_photo_at_half_its_size_has_half_its_prior():
    half = Prior(900.0, 0.4, MIDDLE, 0.015, 0.05).scaled(0.5)
    assert (half.focal, half.focal_error, half.center_error, half.radial_error) == (450.0, 0.4, 0.015, 0.05)
    assert half.center.tolist() == [299.5, 224.5]
