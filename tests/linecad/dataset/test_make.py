"""A dataset from end to end: the same scenes for the same seed, and a run that goes on where another one stopped."""

import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from linecad.camera.photo import read_photo
from linecad.cli.main import main
from linecad.dataset.choice import judge
from linecad.dataset.make import LOCK, DatasetOptions, draw_draft, make_dataset, measure, scene_name
from linecad.dataset.store import DEPTH_MAP, LIST, PHOTO, TRUTH, read_list, read_truth
from linecad.dataset.truth import NOTHING
from linecad.depth.read import read_depth_map
from linecad.errors import DatasetError, LinecadError, OutputError
from linecad.io.locks import alone

OPTIONS = DatasetOptions(scenes=2, seed=3, width=320, height=180, samples=2)
WITH_MAPS = replace(OPTIONS, depth_maps=0.012)


def silent(_text: str) -> None:
    """Report nothing."""


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "set"
    assert make_dataset(folder, OPTIONS, silent).new == 2
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """The files of a dataset by their places in it."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def with_maps(dataset: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The dataset, to which a second run added depth maps."""
    folder = tmp_path_factory.mktemp("maps") / "set"
    shutil.copytree(dataset, folder)
    assert make_dataset(folder, WITH_MAPS, silent).kept == 2
    return folder


def test_a_dataset_holds_photos_cameras_and_truths(dataset: Path) -> None:
    found = read_list(dataset)
    assert found.scenes == ("street-0000", "street-0001")
    for name in found.scenes:
        truth = read_truth(dataset / name)
        photo = read_photo(dataset / name / PHOTO, dataset / name / "camera.json")
        assert (photo.width, photo.height) == (truth.width, truth.height) == (320, 180)
        assert len(truth.pieces) > 500


def test_the_sky_of_the_truth_is_brighter_than_the_ground_of_the_photo(dataset: Path) -> None:
    truth = read_truth(dataset / "street-0000")
    grey = read_photo(dataset / "street-0000" / PHOTO).grey
    assert grey[truth.ids == NOTHING].mean() > grey[-20:].mean() + 20


@pytest.mark.thorough
def test_the_same_seed_gives_the_same_truth(dataset: Path) -> None:
    again = measure(draw_draft(3, 1), 320, 180)
    found = read_truth(dataset / "street-0001")
    for name in ("quads", "edges", "pieces", "ids"):
        np.testing.assert_array_equal(getattr(found, name), getattr(again, name))


def test_another_seed_gives_another_scene() -> None:
    assert draw_draft(3, 9).model.quads(np.zeros(3)).shape != draw_draft(4, 9).model.quads(np.zeros(3)).shape


@pytest.mark.thorough
def test_a_run_goes_on_where_another_one_was_killed(with_maps: Path, tmp_path: Path) -> None:
    folder = tmp_path / "set"
    shutil.copytree(with_maps, folder)
    shutil.rmtree(folder / "street-0001")
    (folder / ".linecad-street-0001").mkdir()  # what was begun
    before = (folder / "street-0000" / PHOTO).stat().st_mtime_ns
    made = make_dataset(folder, WITH_MAPS, silent)
    assert (made.new, made.kept) == (1, 1)
    assert (folder / "street-0000" / PHOTO).stat().st_mtime_ns == before
    assert sorted(path.name for path in folder.iterdir()) == [LIST, "street-0000", "street-0001"]
    # A scene that is made gets the map that it would get if it were there.
    for name in (TRUTH, DEPTH_MAP):
        assert (folder / "street-0001" / name).read_bytes() == (with_maps / "street-0001" / name).read_bytes()


def test_depth_maps_come_beside_photos_and_change_nothing_else(dataset: Path, with_maps: Path) -> None:
    found = contents(with_maps)
    maps = [found.pop(f"{name}/{DEPTH_MAP}") for name in ("street-0000", "street-0001")]
    assert found == contents(dataset)
    assert maps[0] != maps[1]
    assert read_depth_map(with_maps / "street-0000" / DEPTH_MAP).values.shape == (180, 320)


@pytest.mark.parametrize("other", [{"depth_maps": 0.035}, {"depth_kind": "affine-inverse"}])
def test_maps_of_another_width_or_kind_take_the_place_of_those_before(
    with_maps: Path, tmp_path: Path, other: dict[str, Any]
) -> None:
    folder = tmp_path / "set"
    shutil.copytree(with_maps, folder)
    make_dataset(folder, replace(WITH_MAPS, **other), silent)
    for name in ("street-0000", "street-0001"):
        assert (folder / name / DEPTH_MAP).read_bytes() != (with_maps / name / DEPTH_MAP).read_bytes()


def test_a_second_run_in_the_folder_is_refused(dataset: Path) -> None:
    with alone(dataset / LOCK, "", ""), pytest.raises(LinecadError, match="another linecad dataset works in"):
        make_dataset(dataset, OPTIONS, silent)
    assert make_dataset(dataset, OPTIONS, silent).kept == 2


def test_a_scene_that_the_list_does_not_know_yet_is_kept(dataset: Path, tmp_path: Path) -> None:
    folder = tmp_path / "set"
    shutil.copytree(dataset, folder)
    text = (folder / LIST).read_text().replace('"street-0000",', "").replace('"street-0001"', '"street-0000"')
    (folder / LIST).write_text(text)
    assert make_dataset(folder, OPTIONS, silent).new == 0
    assert read_list(folder).scenes == ("street-0000", "street-0001")


def test_other_options_are_refused_in_a_dataset_that_was_begun(dataset: Path) -> None:
    with pytest.raises(DatasetError, match="seed 3, 320x180 px"):
        make_dataset(dataset, DatasetOptions(2, 4, 320, 180, 2), silent)


def test_a_folder_with_other_things_is_refused(tmp_path: Path) -> None:
    (tmp_path / "holiday.jpg").touch()
    with pytest.raises(OutputError, match=r"holiday\.jpg"):
        make_dataset(tmp_path, OPTIONS, silent)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (["--scenes", "0"], "scenes"),
        (["--seed", "-1"], "seed"),
        (["--size", "63x180"], "width"),
        (["--size", "320x99999"], "height"),
        (["--samples", "0"], "samples"),
    ],
)
def test_what_is_out_of_range_is_said_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: list[str], word: str
) -> None:
    assert main(["dataset", str(tmp_path / "set"), "--scenes", "1", "--seed", "1", *change]) == 1
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1
    assert word in shown
    assert not (tmp_path / "set").exists()


def test_a_size_that_is_none_is_wrong_usage(tmp_path: Path) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["dataset", str(tmp_path), "--scenes", "1", "--seed", "1", "--size", "large"])
    assert ended.value.code == 2


def test_without_mitsuba_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delitem(sys.modules, "linecad.dataset.render", raising=False)
    monkeypatch.setattr("linecad.dataset.render", None, raising=False)
    monkeypatch.delattr("linecad.dataset.render")
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    with pytest.raises(LinecadError, match=r"linecad\[dataset\]"):
        make_dataset(tmp_path / "set", OPTIONS, silent)
    assert not (tmp_path / "set").exists()


def test_of_ten_scenes_eight_are_streets() -> None:
    kinds = [scene_name(index).split("-")[0] for index in range(20)]
    assert [kinds.count(kind) for kind in ("street", "courtyard", "room")] == [16, 2, 2]


def test_the_choice_does_not_depend_on_the_size_of_the_photos() -> None:
    draft = draw_draft(11, 9)
    assert judge(measure(draft, 1920, 1080), draft.model).accepts("room")
