"""What is written reads back as it was; what is damaged is refused in one line."""

import json
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from linecad.camera.photo import read_photo
from linecad.dataset.light import draw_light
from linecad.dataset.make import Draft, measure
from linecad.dataset.scenes import draw_scene
from linecad.dataset.store import (
    LIST,
    PHOTO,
    TRUTH,
    DatasetList,
    read_list,
    read_truth,
    write_list,
    write_scene_folder,
    write_truth,
)
from linecad.dataset.truth import TrueOpenings, Truth
from linecad.errors import DatasetError, OutputError


@pytest.fixture(scope="module")
def truth() -> Truth:
    rng = np.random.default_rng(3)
    model, view = draw_scene("room", rng)
    return measure(Draft("room-0009", model, view, draw_light(rng, True), 0), 160, 90)


def damaged(truth: Truth, folder: Path, **changes: object) -> Path:
    """A scene folder in which some arrays were replaced."""
    write_truth(truth, folder)
    with np.load(folder / TRUTH) as archive:
        arrays = dict(archive)
    arrays.update({name: np.asarray(value) for name, value in changes.items()})
    np.savez(folder / TRUTH, allow_pickle=True, **arrays)
    return folder


def refused(folder: Path) -> str:
    with pytest.raises(DatasetError) as caught:
        read_truth(folder)
    message = str(caught.value)
    assert "\n" not in message
    return message


def is_refused(folder: Path) -> bool:
    """Whether reading ends in DatasetError; any other exception fails the test."""
    try:
        read_truth(folder)
    except DatasetError:
        return True
    return False


def test_a_truth_reads_back_exactly(truth: Truth, tmp_path: Path) -> None:
    folder = tmp_path / truth.name
    folder.mkdir()
    write_truth(truth, folder)
    found = read_truth(folder)
    assert found.openings is not None
    assert truth.openings is not None
    for one, other, record in ((found, truth, Truth), (found.openings, truth.openings, TrueOpenings)):
        for field in fields(record):
            if field.name != "openings":
                np.testing.assert_array_equal(getattr(one, field.name), getattr(other, field.name), err_msg=field.name)


def test_a_truth_of_earlier_versions_tells_no_openings(truth: Truth, tmp_path: Path) -> None:
    write_truth(replace(truth, openings=None), tmp_path)
    assert read_truth(tmp_path).openings is None


def test_openings_that_are_not_all_told_are_refused(truth: Truth, tmp_path: Path) -> None:
    write_truth(truth, tmp_path)
    with np.load(tmp_path / TRUTH) as archive:
        arrays = {name: archive[name] for name in archive.files if name != "opening_is_door"}
    np.savez(tmp_path / TRUTH, allow_pickle=True, **arrays)
    assert "opening_is_door" in refused(tmp_path)


def test_an_opening_of_a_building_that_is_not_there_is_refused(truth: Truth, tmp_path: Path) -> None:
    assert truth.openings is not None
    bodies = np.full(len(truth.openings.body), truth.body.max() + 1)
    assert "opening_body names what is not there" in refused(damaged(truth, tmp_path, opening_body=bodies))


def test_the_camera_file_is_one_that_convert_takes(truth: Truth, tmp_path: Path) -> None:
    write_truth(truth, tmp_path)
    camera = json.loads((tmp_path / "camera.json").read_text())
    np.testing.assert_array_equal(camera["K"], truth.matrix)
    assert (camera["width"], camera["height"]) == (160, 90)


def test_the_camera_file_goes_with_the_photo(truth: Truth, tmp_path: Path) -> None:
    from linecad.dataset.finishing import develop, write_photo

    rng = np.random.default_rng(0)
    image = rng.uniform(0, 1, (90, 160, 3)).astype(np.float32)
    write_scene_folder(tmp_path, truth, lambda path: write_photo(develop(image, 16, rng), path, rng))
    folder = tmp_path / truth.name
    photo = read_photo(folder / PHOTO, folder / "camera.json")
    assert photo.camera is not None
    np.testing.assert_array_equal(photo.camera.matrix, truth.matrix)


def test_a_truncated_truth_is_refused(truth: Truth, tmp_path: Path) -> None:
    write_truth(truth, tmp_path)
    whole = (tmp_path / TRUTH).read_bytes()
    for length in (0, 1, 100, len(whole) // 2, len(whole) - 1):
        (tmp_path / TRUTH).write_bytes(whole[:length])
        assert "make the scene again" in refused(tmp_path)


def test_a_truth_with_flipped_bits_is_refused_or_read_but_never_breaks(truth: Truth, tmp_path: Path) -> None:
    write_truth(truth, tmp_path)
    whole = (tmp_path / TRUTH).read_bytes()
    rng = np.random.default_rng(0)
    refusals = 0
    for _ in range(60):
        data = bytearray(whole)
        data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
        (tmp_path / TRUTH).write_bytes(data)
        refusals += is_refused(tmp_path)
    assert refusals > 40  # the archive's check sums see to most of them


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ids", np.full((90, 160), 10**6, np.int32)),
        ("ids", np.zeros((90, 160))),
        ("ids", np.zeros((0, 0), np.int32)),
        ("piece_edge", np.zeros(1, np.int32)),
        ("matrix", np.zeros((3, 3))),
        ("rotation", np.full((3, 3), np.nan)),
        ("corners", np.zeros((5, 4, 3))),
        ("version", 99),
    ],
)
def test_a_truth_that_contradicts_itself_is_refused(truth: Truth, tmp_path: Path, name: str, value: object) -> None:
    refused(damaged(truth, tmp_path, **{name: value}))


def test_objects_in_a_truth_are_refused_and_not_built(truth: Truth, tmp_path: Path) -> None:
    refused(damaged(truth, tmp_path, body=np.array([{"a": 1}], dtype=object)))


def test_an_array_is_missing(truth: Truth, tmp_path: Path) -> None:
    write_truth(truth, tmp_path)
    np.savez(tmp_path / TRUTH, version=np.array(1), matrix=np.eye(3))
    assert "rotation" in refused(tmp_path)


def test_a_folder_without_truth_is_named(tmp_path: Path) -> None:
    assert TRUTH in refused(tmp_path)


def test_a_scene_folder_appears_whole_or_not_at_all(truth: Truth, tmp_path: Path) -> None:
    def fails(path: Path) -> None:
        path.write_bytes(b"half a photo")
        raise OSError(28, "No space left on device")

    with pytest.raises(OutputError):
        write_scene_folder(tmp_path, truth, fails)
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_run_left_is_replaced(truth: Truth, tmp_path: Path) -> None:
    left = tmp_path / f".linecad-{truth.name}"
    left.mkdir()
    (left / "rubbish").write_text("half")
    write_scene_folder(tmp_path, truth, lambda path: path.write_bytes(b"photo"))
    assert [path.name for path in tmp_path.iterdir()] == [truth.name]
    assert sorted(path.name for path in (tmp_path / truth.name).iterdir()) == ["camera.json", PHOTO, TRUTH]


def test_a_list_reads_back(tmp_path: Path) -> None:
    made = DatasetList(7, 320, 180, 4, ("street-0000", "room-0009"))
    write_list(made, tmp_path)
    assert read_list(tmp_path) == made


@pytest.mark.parametrize(
    "change",
    [
        {"format": "other"},
        {"version": 2},
        {"size": [320]},
        {"size": [320, 0]},
        {"scenes": ["../elsewhere"]},
        {"scenes": [""]},
        {"scenes": "street-0000"},
        {"seed": -1},
    ],
)
def test_a_strange_list_is_refused(tmp_path: Path, change: dict[str, object]) -> None:
    write_list(DatasetList(7, 320, 180, 4, ()), tmp_path)
    document = json.loads((tmp_path / LIST).read_text())
    (tmp_path / LIST).write_text(json.dumps(document | change))
    with pytest.raises(DatasetError) as caught:
        read_list(tmp_path)
    assert "\n" not in str(caught.value)


def test_a_folder_without_a_list_is_no_dataset(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=LIST):
        read_list(tmp_path)
