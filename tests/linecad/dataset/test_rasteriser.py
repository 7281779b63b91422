"""Exact depth and visible edges: against formulas, and against a search through all quads ray by ray."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.arrays import Float, Int
from linecad.dataset.rasteriser import GAP, NEAR, rasterise, visible_pieces
from linecad.dataset.truth import NOTHING
from linecad.dataset.view import View

WIDTH, HEIGHT = 48, 32
AHEAD = View(np.zeros(3), 0.0, 0.0, 0.0, 0.66, (0.0, 0.0))
ASKEW = View(np.zeros(3), 0.3, 0.1, -0.05, 0.66, (0.01, -0.02))


def parallelogram(corner: list[float], first: list[float], second: list[float]) -> Float:
    origin = np.array(corner)
    return np.array([origin, origin + first, origin + first + second, origin + second])


def rays(view: View) -> Float:
    x, y = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    pixels = np.stack([x, y, np.ones_like(x)], axis=-1).astype(float)
    return pixels @ np.linalg.inv(view.matrix(WIDTH, HEIGHT) @ view.rotation()).T


def brute_force(quads: Float, view: View) -> tuple[Float, Float]:
    """Largest inverse depth (H, W) over all quads, and how near (H, W) a ray comes to some border, relative."""
    best = np.zeros((HEIGHT, WIDTH))
    margin = np.full((HEIGHT, WIDTH), np.inf)
    for corner, first, _, last in quads:
        # corner + a u + b v = t ray, solved for every pixel.
        system = np.stack(np.broadcast_arrays(first - corner, last - corner, -rays(view)), axis=-1)
        sound = np.abs(np.linalg.det(system)) > 1e-9
        system[~sound] = np.eye(3)
        a, b, depth = np.moveaxis(
            np.linalg.solve(system, np.broadcast_to(-corner, system.shape[:-1])[..., None])[..., 0], -1, 0
        )
        inside = sound & (a >= 0) & (a <= 1) & (b >= 0) & (b <= 1) & (depth >= NEAR)
        border = np.minimum.reduce([np.abs(a), np.abs(a - 1), np.abs(b), np.abs(b - 1), np.abs(depth - NEAR)])
        margin = np.minimum(margin, np.where(sound, border, 0))
        best = np.maximum(best, np.where(inside, 1 / np.where(inside, depth, 1), 0))
    return best, margin


def drawn(quads: Float, view: View) -> tuple[Int, Float]:
    return rasterise(quads, view.matrix(WIDTH, HEIGHT), view.rotation(), WIDTH, HEIGHT)


def test_depth_of_a_wall_straight_ahead_is_its_distance() -> None:
    wall = parallelogram([-50.0, 7.0, -50.0], [100.0, 0, 0], [0, 0, 100.0])
    ids, inverse = drawn(wall[None], AHEAD)
    assert (ids == 0).all()
    np.testing.assert_allclose(1 / inverse, 7.0, rtol=1e-12)


def test_depth_of_the_ground_follows_from_the_height_of_the_camera() -> None:
    ground = parallelogram([-500.0, -10.0, -1.7], [1000.0, 0, 0], [0, 900.0, 0])
    ids, inverse = drawn(ground[None], AHEAD)
    focal, horizon = 0.66 * WIDTH, (HEIGHT - 1) / 2
    for row in range(20, HEIGHT):
        np.testing.assert_allclose(1 / inverse[row], 1.7 * focal / (row - horizon), rtol=1e-9)
    assert (ids[:15] == NOTHING).all()


@settings(max_examples=settings.default.max_examples * 3 // 5)
@given(seed=st.integers(0, 10**6), count=st.integers(1, 12))
def test_depth_agrees_with_a_search_through_all_quads(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    corners, first, second = (rng.normal(0, scale, (count, 3)) for scale in (4, 5, 5))
    corners[:, 1] += 5  # some still reach behind the camera
    quads = np.stack([corners, corners + first, corners + first + second, corners + second], axis=1)
    ids, inverse = drawn(quads, ASKEW)
    wanted, margin = brute_force(quads, ASKEW)
    clear = margin > 1e-7
    np.testing.assert_allclose(inverse[clear], wanted[clear], rtol=1e-7, atol=1e-12)
    assert ((ids == NOTHING) == (inverse == 0)).all()


def test_of_two_quads_in_one_plane_the_first_is_shown() -> None:
    wall = parallelogram([-50.0, 7.0, -50.0], [100.0, 0, 0], [0, 0, 100.0])
    ids, _ = drawn(np.stack([wall, wall]), AHEAD)
    assert (ids == 0).all()


def seen(quads: Float, edges: Float) -> tuple[Float, Int]:
    size = (960, 540)
    matrix, rotation = AHEAD.matrix(*size), AHEAD.rotation()
    ids, _ = rasterise(quads, matrix, rotation, *size)
    return visible_pieces(edges, quads, matrix, rotation, ids)


WALL = parallelogram([-3.0, 10.0, -2.0], [6.0, 0, 0], [0, 0, 3.0])
TOP = np.array([[-3.0, 10.0, 1.0], [3.0, 10.0, 1.0]])
POST = parallelogram([-0.5, 6.0, -5.0], [1.0, 0, 0], [0, 0, 10.0])


def pixel(x: float, y: float, z: float) -> Float:
    focal = 0.66 * 960
    return np.array([(960 - 1) / 2 + focal * x / y, (540 - 1) / 2 - focal * z / y])


def test_a_free_edge_is_seen_whole() -> None:
    pieces, owner = seen(WALL[None], TOP[None])
    assert owner.tolist() == [0]
    np.testing.assert_allclose(pieces[0], [pixel(*TOP[0]), pixel(*TOP[1])], atol=1.5)


def test_a_post_before_it_parts_an_edge_where_it_stands() -> None:
    pieces, owner = seen(np.stack([WALL, POST]), TOP[None])
    assert owner.tolist() == [0, 0]
    left, right = pixel(-0.5, 6.0, 0)[0], pixel(0.5, 6.0, 0)[0]
    assert pieces[0, 1, 0] == pytest.approx(left, abs=1.5)
    assert pieces[1, 0, 0] == pytest.approx(right, abs=1.5)


def test_an_edge_a_hand_behind_a_wall_is_hidden() -> None:
    behind = np.array([[[-2.0, 10.05, -1.0], [2.0, 10.05, -1.0]]])
    pieces, _ = seen(WALL[None], behind)
    assert len(pieces) == 0


def test_an_edge_that_no_quad_carries_is_not_told() -> None:
    before = np.array([[[-2.0, 9.5, -1.0], [2.0, 9.5, -1.0]]])
    pieces, _ = seen(WALL[None], before)
    assert len(pieces) == 0


def test_an_edge_from_behind_the_camera_is_clipped_to_the_photo() -> None:
    ground = parallelogram([-500.0, -10.0, -1.7], [1000.0, 0, 0], [0, 900.0, 0])
    line = np.array([[[0.8, -9.0, -1.7], [0.8, 40.0, -1.7]]])
    pieces, _ = seen(ground[None], line)
    assert len(pieces) == 1
    assert pieces[0, 0, 1] == pytest.approx(539, abs=1.5)
    np.testing.assert_allclose(pieces[0, 1], pixel(0.8, 40.0, -1.7), atol=1.5)


def test_what_is_thinner_than_a_pixel_does_not_part_an_edge() -> None:
    wire = parallelogram([-0.006, 6.0, -5.0], [0.012, 0, 0], [0, 0, 10.0])
    pieces, _ = seen(np.stack([WALL, wire]), TOP[None])
    assert GAP >= 2
    assert len(pieces) == 1
