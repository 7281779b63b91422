"""Parts of photos: what they show is where the camera of the part sees it."""

import numpy as np
import pytest
from parts import CROPS, PARTS, part_of

from linecad.camera.photo import Photo
from linecad.evaluation.references import Points, Reference
from linecad.geometry import central_camera, homogeneous
from linecad.scene import Camera

WIDTH, HEIGHT = 403, 301


def photo(pixels):
    return Photo("photo.jpg", pixels, Camera(WIDTH, HEIGHT, central_camera(350.0, WIDTH, HEIGHT), "file"))


@pytest.mark.parametrize("name", PARTS | CROPS)
def test_the_rays_of_known_points_stay_the_same(name):
    random = np.random.default_rng(3)
    rays = random.uniform([-0.5, -0.4], [0.5, 0.4], (500, 2))
    depth = random.uniform(5.0, 20.0, 500)
    whole = photo(np.zeros((HEIGHT, WIDTH, 3), np.uint8))
    pixels = (homogeneous(rays) @ whole.camera.matrix.T)[:, :2]
    part, known = part_of(whole, Reference(edges=Points(pixels, depth), dense=Points(pixels[:9], depth[:9])), name)
    left, upper, right, lower, scale = (PARTS | CROPS)[name]
    assert part.width == pytest.approx((right - left) * scale * WIDTH, abs=1.5)
    assert part.height == pytest.approx((lower - upper) * scale * HEIGHT, abs=1.5)
    found = (homogeneous(known.edges.pixels) @ np.linalg.inv(part.camera.matrix).T)[:, :2]
    at = np.searchsorted(np.sort(depth), known.edges.depth)
    # Whole pixels of a part that was made smaller are not square to the last bit.
    assert found == pytest.approx(rays[np.argsort(depth)][at], abs=1.5 / 350)
    inside = (pixels > np.array([left * WIDTH, upper * HEIGHT]) + 2).all(axis=1)
    inside &= (pixels < np.array([right * WIDTH, lower * HEIGHT]) - 3).all(axis=1)
    assert set(depth[inside]) <= set(known.edges.depth)
    assert len(known.dense.depth) <= 9


@pytest.mark.parametrize("name", PARTS | CROPS)
def test_a_mark_is_where_its_known_point_is(name):
    """A bright spot, and the pixel that the truth names for it."""
    pixels = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    pixels[148:153, 198:203] = 255
    known = Points(np.array([[200.0, 150.0]]), np.array([7.0]))
    part, reference = part_of(photo(pixels), Reference(edges=known), name)
    rows, columns = np.nonzero(part.pixels[..., 0] > 127)
    assert reference.edges.pixels[0] == pytest.approx([columns.mean(), rows.mean()], abs=0.6)
    assert reference.edges.depth.tolist() == [7.0]
    assert reference.dense is None
