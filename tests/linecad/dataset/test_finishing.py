import numpy as np
import pytest

from linecad.dataset.finishing import develop


def grey(height=60, width=90):
    return np.full((height, width, 3), 0.3, np.float32)


def spread(image):
    return image[10:-10, 10:-10].astype(float).std()


def test_a_single_bright_pixel_of_the_renderer_is_taken_out():
    plain, spotted = grey(), grey()
    spotted[30, 40] = 30.0
    middle = np.s_[25:36, 35:46]
    one, other = (develop(image, 64, np.random.default_rng(0))[middle].astype(int) for image in (plain, spotted))
    assert np.abs(one - other).max() <= 2


@pytest.mark.parametrize("samples", [8, 32])
def test_the_renderers_noise_is_taken_out_and_an_edge_stays(samples):
    image = grey()
    image[:, 45:] = 0.6
    noise = np.random.default_rng(1).normal(0, 0.12 / samples**0.5, image.shape).astype(np.float32)
    clean, noisy = (develop(each, samples, np.random.default_rng(0)) for each in (image, image + noise))
    left, right = noisy[10:50, 20:35].astype(float), noisy[10:50, 55:70].astype(float)
    assert right.mean() - left.mean() > 20
    assert left.std() < 1.8 * clean[10:50, 20:35].astype(float).std()
    across = noisy[10:50].astype(float).mean(axis=(0, 2))
    assert across[49] - across[40] > 0.9 * (right.mean() - left.mean())
