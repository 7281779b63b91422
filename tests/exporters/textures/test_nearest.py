"""Depths of faces at pixels, against planes known by construction."""

import numpy as np
import pytest

from exporters.model import build_model
from exporters.textures.layout import view_of
from exporters.textures.nearest import nearest_of, shape_of


def test_every_pixel_has_the_depth_of_the_nearest_face_on_its_ray(scene):
    view, model = view_of(scene), build_model(scene)
    nearest = nearest_of([shape_of(face, view) for face in model.faces], view)
    assert nearest.inverse_depth.shape == (scene.camera.height, scene.camera.width)
    seen = 0
    for number, face in enumerate(model.faces):
        own = (nearest.owner == number) & (nearest.inverse_depth > 0)
        y, x = np.nonzero(own)
        rays = np.column_stack([x, y, np.ones(len(x))]) @ np.linalg.inv(view.projection).T
        assert rays[:, face.axis] / nearest.inverse_depth[own] == pytest.approx(face.offset, rel=1e-4)
        seen += own.any()
    assert seen > 3
    assert (nearest.inverse_depth == 0).any()
