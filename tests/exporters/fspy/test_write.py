"""The project as fSpy and its importer for Blender understand it, from their definitions of the coordinates."""

import io
import json
import struct
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from exporters.camera import vanishing_points
from exporters.formats import export
from exporters.fspy.write import write_camera
from exporters.model import ORIGINS, build_model
from linecad.errors import OutputError
from linecad.line_graph import Segments
from linecad.scene import Camera

AXES = {"xPositive": (0, 1), "yPositive": (1, 1), "zPositive": (2, 1)}
AXES |= {"xNegative": (0, -1), "yNegative": (1, -1), "zNegative": (2, -1)}


class Project:
    """The parts of a project file."""

    def __init__(self, path):
        data = path.read_bytes()
        magic, self.version, state, image = struct.unpack_from("<4sIII", data)
        assert magic == b"fspy"
        assert len(data) == 16 + state + image
        self.state = json.loads(data[16 : 16 + state])
        self.image = data[16 + state :]
        self.camera = self.state["cameraParameters"]

    def pixels(self, point):
        """px from the photo's corner of relative coordinates."""
        return np.array([point["x"] * self.camera["imageWidth"], point["y"] * self.camera["imageHeight"]])

    def meeting(self, lines):
        """px where two control lines meet."""
        a, b, c, d = (np.append(self.pixels(point), 1.0) for line in lines["lineSegments"] for point in line)
        x, y, w = np.cross(np.cross(a, b), np.cross(c, d))
        return np.array([x / w, y / w])


@pytest.fixture(scope="module")
def path(scene, photo, tmp_path_factory):
    path = tmp_path_factory.mktemp("fspy") / "a.fspy"
    export(scene, path, photo)
    return path


@pytest.fixture(scope="module")
def project(path):
    return Project(path)


def resized(scene, width, height):
    camera = Camera(width, height, scene.camera.matrix, "file")
    return replace(scene, camera=camera), np.zeros((height, width, 3), np.uint8)


def test_the_header_and_the_photo(project, photo):
    assert project.version == 1
    image = np.asarray(Image.open(io.BytesIO(project.image)).convert("RGB"), float)
    assert image.shape == photo.shape
    assert np.abs(image - photo).mean() < 3


def through_the_importer(project, points):
    """px from the corner: a point of the scene through the camera that Blender is given, by Blender's own definitions.

    The angle is that of the longer side, the shift counts in the longer side, and the principal point in image plane
    coordinates is turned into a shift as the importer does.
    """
    camera = project.camera
    width, height = camera["imageWidth"], camera["imageHeight"]
    longer = max(width, height)
    focal = longer / 2 / np.tan(camera["horizontalFieldOfView"] / 2)
    x, y = camera["principalPoint"]["x"], camera["principalPoint"]["y"]
    shift = np.array([-0.5 * x, -0.5 * y])  # of the longer side
    pose = np.array(camera["cameraTransform"]["rows"])
    seen = (np.append(points, np.ones((len(points), 1)), axis=1) @ np.linalg.inv(pose).T)[:, :3]
    flat = seen[:, :2] / -seen[:, 2:] * focal - shift * longer  # y up, from the middle of the picture
    return np.column_stack([width / 2 + flat[:, 0], height / 2 - flat[:, 1]])


@pytest.mark.parametrize("size", [None, (1000, 1400)])
def test_every_line_falls_on_the_photo_through_the_imported_camera(scene, photo, tmp_path, size):
    """The made scene's photo is wide; the same camera with a tall photo has another longer side."""
    if size is not None:
        scene, photo = resized(scene, *size)
    export(scene, tmp_path / "a.fspy", photo)
    project = Project(tmp_path / "a.fspy")
    found = through_the_importer(project, scene.lines.ends.reshape(-1, 3))
    np.testing.assert_allclose(found, scene.lines.segment.reshape(-1, 2) + 0.5, atol=1e-6)


@pytest.mark.parametrize("origin", ORIGINS)
def test_the_imported_camera_stands_above_the_ground_where_the_other_formats_have_it(grounded, photo, tmp_path, origin):
    export(grounded, tmp_path / "a.fspy", photo, {"origin": origin})
    project, eye = Project(tmp_path / "a.fspy"), build_model(grounded, origin=origin).eye
    found = through_the_importer(project, grounded.lines.ends.reshape(-1, 3) + eye)
    np.testing.assert_allclose(found, grounded.lines.segment.reshape(-1, 2) + 0.5, atol=1e-6)
    export(replace(grounded, metres_per_unit=None), tmp_path / "free.fspy", photo)
    places = [each.state["controlPointsStateBase"] for each in (project, Project(tmp_path / "free.fspy"))]
    assert places[0] == places[1]


def test_view_and_camera_transform_undo_each_other(project):
    product = np.array(project.camera["viewTransform"]["rows"]) @ project.camera["cameraTransform"]["rows"]
    np.testing.assert_allclose(product, np.eye(4), atol=1e-14)


def test_the_control_lines_give_the_same_camera_again(project, scene):
    """What fSpy computes when it opens the project: focal length and rotation from two vanishing points."""
    state = project.state
    assert state["globalSettings"]["calibrationMode"] == "TwoVanishingPoints"
    assert state["calibrationSettings2VP"] == {"principalPointMode": "Manual", "quadModeEnabled": False}
    base, more = state["controlPointsStateBase"], state["controlPointsState2VP"]
    centre = project.pixels(base["principalPoint"])
    first, second, third = (
        project.meeting(lines) - centre
        for lines in (base["firstVanishingPoint"], more["secondVanishingPoint"], more["thirdVanishingPoint"])
    )
    focal = np.sqrt(-first @ second)
    assert focal == pytest.approx(scene.camera.focal, rel=1e-8)
    words = [state["calibrationSettingsBase"][f"{name}VanishingPointAxis"] for name in ("first", "second")]
    for point, word in zip((first, second, third), [*words, project.camera["vanishingPointAxes"][2]], strict=True):
        axis, sign = AXES[word]
        ray = np.append(point, focal)
        np.testing.assert_allclose(ray / np.linalg.norm(ray), sign * scene.rotation[:, axis], atol=1e-7)


def test_the_control_lines_are_segments_of_the_scene(project, scene):
    middles = scene.lines.segment.mean(axis=1) + 0.5
    state = project.state
    for controls, word in (
        (state["controlPointsStateBase"]["firstVanishingPoint"], "first"),
        (state["controlPointsState2VP"]["secondVanishingPoint"], "second"),
    ):
        axis, _ = AXES[state["calibrationSettingsBase"][f"{word}VanishingPointAxis"]]
        for line in controls["lineSegments"]:
            middle = np.mean([project.pixels(point) for point in line], axis=0)
            distance = np.linalg.norm(middles[scene.lines.axis == axis] - middle, axis=1)
            assert distance.min() < 1e-6


def test_the_reference_distance_is_a_line_of_the_scene(project, scene):
    """From the origin, along the control axis, to the other handle: its length stands there in metres."""
    settings, points = project.state["calibrationSettingsBase"], project.state["controlPointsStateBase"]
    assert settings["referenceDistanceUnit"] == "Meters"
    axis, _ = AXES[settings["referenceDistanceAxis"]]
    lengths = np.linalg.norm(scene.lines.ends[:, 1] - scene.lines.ends[:, 0], axis=1)
    assert settings["referenceDistance"] == pytest.approx(lengths[scene.lines.component == 0].max())
    assert points["referenceDistanceAnchor"] == points["origin"]
    row = int(np.where(scene.lines.component == 0, lengths, 0).argmax())
    size = np.array([scene.camera.width, scene.camera.height])
    start, end = (scene.lines.segment[row] + 0.5) / size
    np.testing.assert_allclose([points["origin"]["x"], points["origin"]["y"]], start, atol=1e-9)
    towards = vanishing_points(scene.camera, scene.rotation)[axis] / size - start
    first, second = points["referenceDistanceHandleOffsets"]
    assert first == 0
    np.testing.assert_allclose(start + second * towards / np.linalg.norm(towards), end, atol=1e-9)


def test_an_unknown_scale_has_no_unit(free_unit, photo, tmp_path):
    export(free_unit, tmp_path / "a.fspy", photo)
    assert Project(tmp_path / "a.fspy").state["calibrationSettingsBase"]["referenceDistanceUnit"] == "No unit"


def test_a_frontal_photo_is_told_by_one_vanishing_point(scene, photo, tmp_path):
    """Two axes in the image plane vanish at infinity; fSpy then takes the focal length and the horizon as they are."""
    frontal = replace(scene, rotation=[[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    export(frontal, tmp_path / "a.fspy", photo)
    project = Project(tmp_path / "a.fspy")
    state = project.state
    assert state["globalSettings"]["calibrationMode"] == "OneVanishingPoint"
    assert state["calibrationSettings1VP"]["principalPointMode"] == "Manual"
    film = state["calibrationSettingsBase"]["cameraData"]["customSensorWidth"]
    millimetres = state["calibrationSettings1VP"]["absoluteFocalLength"]
    assert millimetres / film * scene.camera.width == pytest.approx(scene.camera.focal)
    meeting = project.meeting(state["controlPointsStateBase"]["firstVanishingPoint"])
    np.testing.assert_allclose(meeting, scene.camera.matrix[:2, 2] + 0.5, atol=1e-6)
    left, right = (project.pixels(point) for point in state["controlPointsState1VP"]["horizon"])
    assert abs((right - left)[1]) < 1e-6 * abs((right - left)[0])


def test_without_lines_they_are_drawn_across_the_photo(no_lines, photo, tmp_path):
    export(no_lines, tmp_path / "a.fspy", photo)
    project = Project(tmp_path / "a.fspy")
    meeting = project.meeting(project.state["controlPointsStateBase"]["firstVanishingPoint"])
    axis, _ = AXES[project.state["calibrationSettingsBase"]["firstVanishingPointAxis"]]
    np.testing.assert_allclose(meeting, vanishing_points(no_lines.camera, no_lines.rotation)[axis], rtol=1e-8)
    assert project.state["calibrationSettingsBase"]["referenceDistanceAxis"] is None


def test_a_project_without_photo_is_refused(scene, tmp_path):
    with pytest.raises(OutputError, match="name it with --photo"):
        export(scene, tmp_path / "a.fspy")
    assert list(tmp_path.iterdir()) == []


def test_a_camera_alone_is_the_camera_of_its_scene(scene, project, photo, tmp_path):
    write_camera(
        scene.camera, scene.rotation, Segments(scene.lines.segment, scene.lines.axis), tmp_path / "a.fspy", photo
    )
    alone = Project(tmp_path / "a.fspy")
    assert alone.camera == project.camera
    assert alone.image == project.image
    assert alone.state["controlPointsState2VP"] == project.state["controlPointsState2VP"]


def test_a_camera_alone_has_no_length(scene, photo, tmp_path):
    segments = Segments(np.zeros((0, 2, 2)), np.zeros(0))
    write_camera(scene.camera, scene.rotation, segments, tmp_path / "a.fspy", photo)
    base = Project(tmp_path / "a.fspy").state["calibrationSettingsBase"]
    assert base["referenceDistanceAxis"] is None
    assert base["referenceDistanceUnit"] == "No unit"
