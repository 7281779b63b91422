"""Datasets recognised and read, those of others too, and what is said about damaged ones."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat, savemat

from linecad.camera.distortion import open_photo
from linecad.editing.labelling import camera_of_labels
from linecad.errors import DatasetError, LinecadError
from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.frames import nearest_axes
from linecad.evaluation.labels import FAKE, REAL, UNDECIDED, label_crossings
from linecad.evaluation.marks import UNKNOWN_AXIS, label_by_marks
from linecad.evaluation.references import open_case, reference_of
from linecad.geometry import angle_between_frames, project

K = [[500.0, 0, 160], [0, 510.0, 120], [0, 0, 1]]


def only(folder):
    cases = find_dataset(folder).cases
    assert len(cases) == 1
    return open_case(cases[0])


@pytest.fixture
def write(tmp_path, drawn):
    """A function that writes a truth file beside a small grey photo, and gives the folder."""
    from PIL import Image

    Image.fromarray(drawn.pixels[:240, :320]).save(tmp_path / "a.jpg")

    def make(document):
        (tmp_path / "a.json").write_text(json.dumps(document))
        return tmp_path

    return make


def test_york_urban_as_published(made, york_folder):
    dataset = find_dataset(york_folder)
    assert [case.name for case in dataset.cases] == ["P1", "P2"]
    photo, reference = open_case(dataset.cases[1])
    assert photo.camera.matrix == pytest.approx(made.camera.matrix)
    error, which = angle_between_frames(made.frame.rotation, reference.rotation)
    assert error < 1e-6
    assert which == (0, 2, 1)  # label 2 is vertical
    assert reference.lines.ends == pytest.approx(made.pixels)
    names = nearest_axes(reference.lines.ends, photo.camera.matrix, made.frame.rotation)
    assert [which[label] for label in reference.lines.axis] == names.tolist()
    assert not reference.has_labels


def test_york_urban_may_have_its_directions_with_the_lines(york_folder, tmp_path):
    shutil.copytree(york_folder, tmp_path / "york")
    other = tmp_path / "york" / "P1" / "P1GroundTruthVP_Orthogonal_CamParams.mat"
    lines = tmp_path / "york" / "P1" / "P1LinesAndVP.mat"
    content = {name: value for name, value in (loadmat(lines) | loadmat(other)).items() if name[0] != "_"}
    other.unlink()
    savemat(lines, content)
    before = open_case(find_dataset(york_folder).cases[0])[1]
    after = open_case(find_dataset(tmp_path / "york").cases[0])[1]
    assert after.rotation.tolist() == before.rotation.tolist()


@pytest.mark.parametrize(
    ("file", "change", "says"),
    [
        ("P1/P1LinesAndVP.mat", {"vp_association": np.ones((3, 1))}, "lines and 3 labels"),
        ("P1/P1LinesAndVP.mat", {"vp_association": np.full((31, 1), 4)}, "label other than"),
        ("P1/P1LinesAndVP.mat", {"lines": np.array(["a", "b"])}, "not made of numbers"),
        ("P1/P1GroundTruthVP_Orthogonal_CamParams.mat", {"vp_orthogonal": np.ones((3, 3))}, "not orthogonal"),
        ("P1/P1GroundTruthVP_Orthogonal_CamParams.mat", {"vp_orthogonal": np.eye(2)}, "4 numbers"),
        ("cameraParameters.mat", {"focal": 0.0}, "focal length"),
        ("cameraParameters.mat", {"focal": np.nan}, "finite"),
        ("cameraParameters.mat", {"pixelSize": 0.0}, "focal length"),
    ],
)
def test_damaged_files_of_york_urban_are_named(york_folder, tmp_path, file, change, says):
    folder = tmp_path / "york"
    shutil.copytree(york_folder, folder)
    content = {name: value for name, value in loadmat(folder / file).items() if name[0] != "_"}
    savemat(folder / file, content | change)
    with pytest.raises(DatasetError, match=says) as caught:
        open_case(find_dataset(folder).cases[0])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("content", [b"", b"not MATLAB", b"MATLAB 5.0 MAT-file" + b"\0" * 200])
def test_a_file_that_is_no_matlab_file(york_folder, tmp_path, content):
    folder = tmp_path / "york"
    shutil.copytree(york_folder, folder)
    (folder / "P2" / "P2LinesAndVP.mat").write_bytes(content)
    with pytest.raises(DatasetError, match=r"P2LinesAndVP\.mat"):
        open_case(find_dataset(folder).cases[1])


def test_york_urban_as_json(write):
    directions = np.array([[0.0, 0, 1], [0, -1, 0], [1, 0, 0]])
    lines = [{"p": [10, 20], "q": [30, 20], "label": 3}, {"p": [10, 20], "q": [10, 60], "label": 2}]
    square = [[500.0, 0, 160], [0, 500.0, 120], [0, 0, 1]]
    folder = write(
        {"width": 320, "height": 240, "K": square, "vp_dirs_orthogonal": directions.tolist(), "lines": lines}
    )
    _, reference = only(folder)
    assert reference.rotation.T.tolist() == directions.tolist()
    assert reference.lines.axis.tolist() == [2, 1]
    assert reference.lines.ends.tolist() == [[[10, 20], [30, 20]], [[10, 20], [10, 60]]]


def points_document(**more):
    points = [[u, v, 0.0, 0.0, 5.0 + u / 100, 3.0, 0.001] for u, v in [(20, 30), (100, 200), (300, 100)]]
    return {"width": 320, "height": 240, "K": K, "points": points, **more}


def test_points_with_depth(write):
    photo, reference = only(write(points_document(on_line=[2, 0])))
    # The pixels are made square: y shrinks towards the principal point.
    straight = 120 + (np.array([30.0, 200, 100]) - 120) * 500 / 510
    assert photo.camera.matrix[1, 1] == 500
    assert reference.dense.pixels[:, 1] == pytest.approx(straight, abs=1e-6)
    assert reference.dense.depth == pytest.approx([5.2, 6, 8])
    assert reference.edges.depth == pytest.approx([8, 5.2])


def test_without_on_line_all_points_are_on_edges(write):
    _, reference = only(write(points_document()))
    assert len(reference.edges.depth) == 3


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"points": []}, "no row"),
        ({"points": [[1, 2, 3]]}, "fewer than 5"),
        ({"points": [[1, 2, 3, 4, -5]]}, "behind"),
        ({"points": [[1, 2, 3, 4, "x"]]}, r"points\[0\]\[4\]"),
        ({"on_line": [3]}, r"on_line\[0\]"),
        ({"R_cam_from_manhattan": [[1, 0, 0]]}, "R_cam_from_manhattan"),
        ({"width": 300}, "300 x 240"),
    ],
)
def test_damaged_points_are_named(write, change, says):
    with pytest.raises(LinecadError, match=says):
        only(write(points_document(**change)))


def lines_document(made):
    """The made scene as lines of a multi-view reconstruction, with all crossings of its graph."""
    graph = made.graph(extension=100.0)
    in_camera = made.ends @ made.frame.rotation.T
    lines = [
        {"p": p, "q": q, "P_cam": a, "Q_cam": b, "label": axis}
        for (p, q), (a, b), axis in zip(made.pixels.tolist(), in_camera.tolist(), made.axis.tolist(), strict=True)
    ]
    gap = [0.0, 0.02, 0.5]
    crossings = [
        {"i": j, "j": i, "xy": xy, "rel_gap": gap[number % 3]}
        for number, ((i, j), xy) in enumerate(zip(graph.edges.tolist(), graph.crossing.tolist(), strict=True))
    ]
    return {
        "width": made.camera.width, "height": made.camera.height, "K": made.camera.matrix.tolist(), "lines": lines,
        "crossings": crossings,
    }  # fmt: skip


def test_lines_with_crossings(made, drawn, tmp_path):
    from PIL import Image

    Image.fromarray(drawn.pixels).save(tmp_path / "a.png")
    (tmp_path / "a.json").write_text(json.dumps(lines_document(made)))
    _, reference = only(tmp_path)
    graph = made.graph(extension=100.0)
    label = label_by_marks(reference.marks, graph, made.camera)
    assert label.tolist() == [[REAL, UNDECIDED, FAKE][number % 3] for number in range(len(graph.edges))]
    # Sampled points lie on the lines: lifted by their depth they lie on the made ones.
    in_camera = (
        np.column_stack([reference.edges.pixels, np.ones(len(reference.edges.pixels))])
        @ np.linalg.inv(made.camera.matrix).T
    )
    world = in_camera * reference.edges.depth[:, None] @ made.frame.rotation
    to = world[:, None] - made.ends[None, :, 0]
    along = made.ends[:, 1] - made.ends[:, 0]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    off = np.linalg.norm(np.cross(to, along[None]), axis=2).min(axis=1)
    assert off.max() < 1e-6


def test_labels_made_by_hand(made, labels_folder):
    photo, reference = only(labels_folder)
    assert photo.camera.matrix.tolist() == made.camera.matrix.tolist()
    graph = made.graph(extension=100.0)
    label = label_by_marks(reference.marks, graph, made.camera)
    assert (label == REAL).tolist() == made.truly_real(graph).tolist()
    assert set(label.tolist()) <= {REAL, FAKE}


def test_a_mark_with_another_axis_or_elsewhere_is_not_that_crossing(made, labels_folder):
    marks = only(labels_folder)[1].marks
    graph = made.graph(extension=100.0)
    swapped = replace(marks, axis=(marks.axis + 1) % 3)
    assert (label_by_marks(swapped, graph, made.camera) == UNDECIDED).all()
    away = replace(marks, pixel=marks.pixel + 30)
    assert (label_by_marks(away, graph, made.camera) == UNDECIDED).mean() > 0.9
    anything = replace(marks, axis=np.full_like(marks.axis, UNKNOWN_AXIS))
    assert (label_by_marks(anything, graph, made.camera) != UNDECIDED).all()


def test_marks_that_contradict_each_other_leave_it_open(made, labels_folder):
    marks = only(labels_folder)[1].marks
    twice = replace(
        marks, pixel=np.tile(marks.pixel, (2, 1)), segments=np.tile(marks.segments, (2, 1, 1, 1)),
        axis=np.tile(marks.axis, (2, 1)), label=np.r_[marks.label, 1 - marks.label],
    )  # fmt: skip
    graph = made.graph(extension=100.0)
    assert (label_by_marks(twice, graph, made.camera) == UNDECIDED).all()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"version": 2}, "version"),
        ({"crossings": [{"pixel": [1, 2], "segments": [], "axes": ["x", "z"], "label": "real"}]}, "segments"),
        ({"crossings": [{"pixel": [1], "segments": [], "axes": ["x", "z"], "label": "real"}]}, "pixel"),
        ({"camera": {"K": [[0, 0, 0], [0, 0, 0], [0, 0, 1]]}}, "camera.K"),
        ({"camera": "../camera.json"}, "beside"),
        ({"camera": 5}, "camera"),
        ({"photo": "other.png"}, "other.png"),
        ({"photo": "../a.jpg"}, "beside"),
    ],
)
def test_damaged_labels_are_named(write, change, says):
    document = {"format": "linecad-labels", "version": 1, "photo": "a.jpg", "crossings": []} | change
    with pytest.raises(LinecadError, match=says) as caught:
        only(write(document))
    assert "\n" not in str(caught.value)


def test_the_label_and_axes_of_a_mark_are_checked(write):
    segments = [[[0, 0], [1, 1]], [[0, 1], [1, 0]]]
    good = {"pixel": [1, 2], "segments": segments, "axes": ["x", "z"], "label": "unsure"}
    document = {"format": "linecad-labels", "version": 1, "photo": "a.jpg", "crossings": [good]}
    assert only(write(document))[1].marks.label.tolist() == [UNDECIDED]
    for wrong in ({"label": "maybe"}, {"axes": ["x", "w"]}, {"axes": ["x"]}):
        with pytest.raises(DatasetError, match=next(iter(wrong))):
            only(write(document | {"crossings": [good | wrong]}))


def test_the_samples_are_a_dataset_by_their_true_pixels():
    """Their truth was once taken for a photo's own camera file, and the photo looked for under its name."""
    samples = find_dataset(Path(__file__).parents[3] / "samples")
    assert [case.name for case in samples.cases] == ["courtyard", "room", "street"]
    case = samples.cases[0]
    assert [path.name for path in case.files] == ["courtyard.jpg", "courtyard.truth.json", "courtyard.json"]
    photo, reference = open_case(case)
    assert photo.camera.distortion != ()
    truth = json.loads(case.truth.read_text())
    # The truth is in the undistorted photo already.
    assert reference.dense.pixels.tolist() == [row[:2] for row in truth["points"]]
    assert reference.edges.depth.tolist() == [truth["points"][n][4] for n in truth["on_line"]]


def test_a_truth_whose_camera_file_is_missing_is_named(write):
    folder = write(points_document())
    (folder / "a.json").rename(folder / "a.truth.json")
    with pytest.raises(LinecadError, match=r"a\.json"):
        only(folder)


def test_a_folder_without_any_truth(write, tmp_path):
    with pytest.raises(DatasetError, match="no dataset"):
        find_dataset(write({"width": 320, "height": 240, "K": K}))  # a camera file alone
    with pytest.raises(DatasetError, match="not a folder"):
        find_dataset(tmp_path / "none")


@pytest.mark.parametrize("text", ["{", "", "[1, 2]\0", '{"format": "linecad-dataset", "version": 2, "scenes": []}'])
def test_a_damaged_dataset_file(tmp_path, text):
    (tmp_path / "dataset.json").write_text(text)
    with pytest.raises(DatasetError, match=r"dataset\.json"):
        find_dataset(tmp_path)


def test_a_dataset_file_cannot_send_us_elsewhere(tmp_path):
    top = {"format": "linecad-dataset", "version": 1, "seed": 1, "size": [64, 64], "samples": 4, "scenes": ["../a"]}
    (tmp_path / "dataset.json").write_text(json.dumps(top))
    with pytest.raises(DatasetError, match=r"\.\./a"):
        find_dataset(tmp_path)


def test_points_of_a_made_photo_lie_where_the_truth_says(made, made_truth):
    reference = reference_of(made_truth)
    assert len(reference.edges.depth) > 100
    lifted = made_truth.rays(reference.edges.pixels) * reference.edges.depth[:, None]
    on_faces = np.min([np.abs(lifted[:, 1] - 9), np.abs(lifted[:, 0] + 2.2), np.abs(lifted[:, 1] - 7),
                       np.abs(lifted[:, 0] - 2.6)], axis=0)  # fmt: skip
    assert on_faces.max() < 1e-6
    assert project(lifted, made.camera.matrix, made.frame.rotation) == pytest.approx(reference.edges.pixels)
    shown = made_truth.depth()
    at = reference.dense.pixels.astype(int)
    assert reference.dense.depth == pytest.approx(shown[at[:, 1], at[:, 0]])
    graph = made.graph()
    assert (
        reference.label(graph, made.camera, made.frame.rotation).tolist() == label_crossings(made_truth, graph).tolist()
    )


def test_the_datasets_that_we_measure_on_are_recognised(photographs):
    kinds = {name: find_dataset(photographs / name) for name in ("castle", "york_urban", "south_building")}
    assert {name: dataset.cases[0].kind for name, dataset in kinds.items()} == {
        "castle": "points", "york_urban": "york-json", "south_building": "lines",
    }  # fmt: skip
    assert [len(dataset.cases) for dataset in kinds.values()] == [4, 51, 8]
    _, castle = open_case(kinds["castle"].cases[3])
    assert 0 < len(castle.edges.depth) < len(castle.dense.depth)


@pytest.mark.parametrize("focal", [pytest.param(None, marks=pytest.mark.thorough), 1050.0])
def test_labels_set_in_a_straightened_photo_are_read_in_one(tmp_path, focal):
    """They were once judged on the bent photo, whose pixels are others."""
    photo = Path(__file__).parents[3] / "samples" / "courtyard.jpg"  # without its camera file its lens bends it
    shutil.copy(photo, tmp_path)
    seen = open_photo(photo, None, focal)
    assert seen.bend is not None
    one = {"pixel": [100.0, 100.0], "segments": [[[90, 100], [100, 100]], [[100, 90], [100, 100]]],
           "axes": ["x", "z"], "label": "real"}  # fmt: skip
    labels = {"format": "linecad-labels", "version": 1, "photo": photo.name,
              "camera": camera_of_labels(seen, None), "crossings": [one]}  # fmt: skip
    (tmp_path / "courtyard.json").write_text(json.dumps(labels))
    read, _ = only(tmp_path)
    # The distortion goes through a file and another focal length: pixels may differ by rounding.
    assert np.abs(read.pixels.astype(int) - seen.pixels).mean() < 0.05
