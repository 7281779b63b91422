"""The renderer sees what the rasteriser sees: edges to a fraction of a pixel, depths, and the choice of LLVM."""

from pathlib import Path

import mitsuba as mi
import numpy as np
import pytest

from linecad.arrays import Float
from linecad.dataset import render
from linecad.dataset.light import Light, draw_light
from linecad.dataset.make import Draft, measure
from linecad.dataset.modelling import Material, Model
from linecad.dataset.scenes import draw_scene
from linecad.dataset.truth import NOTHING
from linecad.dataset.view import View

WIDTH, HEIGHT = 320, 180
VIEW = View(np.array([0.3, -0.2, 1.6]), 0.35, 0.06, 0.01, 0.66, (0.03, -0.02))
LIGHT = Light(np.array([0.0, 0.0, -1.0]), np.zeros(3), 1)


def nothing(_done: int) -> None:
    """Hear nothing."""


@pytest.fixture(scope="module", autouse=True)
def ready() -> str:
    return render.choose_variant()


def darkness(corners: Float) -> Float:
    """(H, W) share of the sky's light that a dark quad takes away, as rendered."""

    def light(corners: Float) -> Float:
        model = Model()
        model.start_body("building")
        model.quad(corners[0], corners[1] - corners[0], corners[3] - corners[0], Material("plain", (0.0, 0.0, 0.0)))
        scene = render.load(model, VIEW, LIGHT, WIDTH, HEIGHT)
        image: Float = render.render(scene, 64, 5, nothing).mean(axis=2).astype(np.float64)
        return image

    behind_the_camera = corners - np.array([0.0, 60.0, 0.0])
    return 1 - light(corners) / light(behind_the_camera)


def project(points: Float) -> Float:
    image = (points - VIEW.eye) @ (VIEW.matrix(WIDTH, HEIGHT) @ VIEW.rotation()).T
    return image[:, :2] / image[:, 2:]


def test_edges_of_a_calibration_quad_lie_where_the_camera_says() -> None:
    corners = np.array([[4.0, 8.0, 0.6], [4.0, 14.0, 0.6], [4.0, 14.0, 3.6], [4.0, 8.0, 3.6]])
    dark = darkness(corners)
    outline = project(corners)
    assert (outline > 10).all()
    assert (outline < np.array([WIDTH, HEIGHT]) - 10).all()
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        along = (end - start) / np.linalg.norm(end - start)
        inwards = np.array([-along[1], along[0]])
        inwards *= np.sign(inwards @ (outline.mean(axis=0) - start))
        # Of lines across the edge, from 4 px outside to 4 px inside, 4 px are as dark as their inner end.
        steps = (np.arange(160) + 0.5) / 20 - 4
        feet = start + np.linspace(0.15, 0.85, 200)[:, None] * (end - start)
        profile = bilinear(dark, feet[:, None] + steps[:, None] * inwards).mean(axis=0)
        assert profile.sum() / 20 / profile[-20:].mean() == pytest.approx(4.0, abs=0.05)


def bilinear(image: Float, pixels: Float) -> Float:
    corner = np.floor(pixels).astype(int)
    share = pixels - corner
    x, y = corner[..., 0], corner[..., 1]
    upper = image[y, x] * (1 - share[..., 0]) + image[y, x + 1] * share[..., 0]
    lower = image[y + 1, x] * (1 - share[..., 0]) + image[y + 1, x + 1] * share[..., 0]
    mixed: Float = upper * (1 - share[..., 1]) + lower * share[..., 1]
    return mixed


def test_depths_of_the_renderer_agree_with_the_rasteriser() -> None:
    rng = np.random.default_rng([1, 1, 0])
    model, view = draw_scene("street", rng)
    light = draw_light(rng, False)
    truth = measure(Draft("street-0001", model, view, light, 0), WIDTH, HEIGHT)
    scene = render.load(model, view, light, WIDTH, HEIGHT)
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    rays = truth.rays(np.column_stack([column.ravel(), row.ravel()]).astype(float))
    length = np.linalg.norm(rays, axis=1)
    found = np.zeros(len(rays))
    if mi.variant() == "llvm_ad_rgb":
        ray = mi.Ray3f(mi.Point3f(0, 0, 0), mi.Vector3f((rays / length[:, None]).T.astype(np.float32)))
        found = np.array(scene.ray_intersect_preliminary(ray).t)
    else:
        for index, direction in enumerate(rays / length[:, None]):
            found[index] = scene.ray_intersect_preliminary(mi.Ray3f([0, 0, 0], direction.tolist())).t
    depth = (found / length).reshape(HEIGHT, WIDTH)
    wanted = truth.depth()
    sky = truth.ids == NOTHING
    agree = np.where(sky, ~np.isfinite(depth), np.abs(depth / np.where(sky, 1, wanted) - 1) < 1e-4)
    # Single precision decides otherwise only on the borders of quads.
    assert agree.mean() > 0.998


def test_the_seed_decides_the_noise() -> None:
    model, view = draw_scene("room", np.random.default_rng(2))
    scene = render.load(model, view, draw_light(np.random.default_rng(2), True), 64, 36)
    first, again, other = (render.render(scene, 2, seed, nothing) for seed in (1, 1, 2))
    np.testing.assert_allclose(first, again, atol=1e-5)  # sums of floats in the order in which threads end
    assert np.abs(first - other).max() > 0.01


def test_passes_add_up_to_the_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(render, "PASS", 2 * 64 * 36)
    model, view = draw_scene("room", np.random.default_rng(2))
    scene = render.load(model, view, draw_light(np.random.default_rng(2), True), 64, 36)
    heard: list[int] = []
    render.render(scene, 5, 1, heard.append)
    assert heard == [2, 4, 5]


def test_an_llvm_that_is_too_old_is_not_taken(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv(render.LLVM_VARIABLE, raising=False)
    monkeypatch.setattr(render, "LLVM_PLACES", (str(tmp_path),))
    for name in ("libLLVM-14.so.1", "libLLVM-15.so", "libLLVMSomething.so.19"):
        (tmp_path / name).touch()
    assert render.find_llvm() is None
    (tmp_path / "libLLVM.so.19.1").touch()
    (tmp_path / "libLLVM-17.so").touch()
    assert render.find_llvm() == tmp_path / "libLLVM.so.19.1"


def test_the_environment_names_the_llvm(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(render.LLVM_VARIABLE, "somewhere/libLLVM.so")
    assert render.find_llvm() == Path("somewhere/libLLVM.so")
