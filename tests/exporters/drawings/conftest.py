"""The wall with three windows of the other exporters, with its metres and a ground, and a photo with marks on it."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from exporters.drawings.choice import Choice
from exporters.drawings.elevation import build_elevation
from exporters.drawings.plan import build_plan
from exporters.model import build_model

EYE = np.array([-6.5, -15.0, 5.2])  # as the scene has it: where the camera stands before the house
MARKS = [(0.5, 0.5), (11.5, 0.5), (11.5, 7.5), (0.5, 7.5)]  # m on the wall, the middles of dark squares
MARK = 0.4  # m, the side of one


@pytest.fixture(scope="session")
def facade(row):
    """A wall of 12 by 8 m with three windows of 1.2 by 1.6 m, in metres; its ground is known."""
    planes = [
        replace(plane, faces=tuple(replace(f, kind="ground") if f.id == 16 else f for f in plane.faces))
        for plane in row.planes
    ]
    return replace(row, planes=tuple(planes), metres_per_unit=1.0)


@pytest.fixture(scope="session")
def drawing(facade):
    return build_elevation(build_model(facade, origin="ground"), Choice(drawing_scale="1:50"))


@pytest.fixture(scope="session")
def plan(facade):
    return build_plan(build_model(facade, origin="ground"), Choice(drawing_scale="1:100"))


@pytest.fixture(scope="session")
def marked(facade):
    """RGB: a light wall with a dark square at each of MARKS, as the camera sees it, drawn four times as fine."""
    camera, fine = facade.camera, 4
    picture = np.full((camera.height * fine, camera.width * fine, 3), 200, np.uint8)
    for x, z in MARKS:
        half = MARK / 2
        corners = np.array(
            [(x + a, 0.0, z + b) for a, b in ((-half, -half), (half, -half), (half, half), (-half, half))]
        )
        ray = (corners - EYE) @ facade.rotation.T @ camera.matrix.T
        pixels = (ray[:, :2] / ray[:, 2:] + 0.5) * fine - 0.5
        cv2.fillPoly(picture, [np.round(pixels * 16).astype(np.int32)], (30, 30, 30), cv2.LINE_AA, 4)
    return np.asarray(cv2.resize(picture, (camera.width, camera.height), interpolation=cv2.INTER_AREA), np.uint8)
