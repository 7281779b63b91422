"""Our own dataset from the folder to the figures: the made boxes, stored as `linecad dataset` stores its scenes."""

import json

import pytest
from PIL import Image

from linecad.cli.main import main
from linecad.dataset.store import DatasetList, write_list, write_scene_folder
from linecad.errors import DatasetError
from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.references import open_case


@pytest.fixture(scope="module")
def made_folder(drawn, made_truth, tmp_path_factory):
    folder = tmp_path_factory.mktemp("dataset")
    photo = Image.fromarray(drawn.pixels)
    write_scene_folder(folder, made_truth, lambda path: photo.save(path, quality=95))
    write_list(DatasetList(1, made_truth.width, made_truth.height, 4, (made_truth.name,)), folder)
    return folder


def test_a_made_dataset_gives_all_tables(made_folder, tmp_path, capsys):
    out = tmp_path / "a.json"
    pictures = ["--turned", str(tmp_path)]
    assert (
        main(
            [
                "evaluate",
                str(made_folder),
                "--json",
                str(out),
                *pictures,
                "--time-limit",
                "20",
                "--option",
                "face-lines=off",
                "--quiet",
            ]
        )
        == 0
    )
    photo = json.loads(out.read_text())["photos"][0]
    assert photo["error"] is None
    assert photo["statistics"]["real"] > 20
    assert photo["methods"]["gain"]["none"]["decisions"]["tree_fake"] == 0
    whole = photo["whole"]
    assert whole["depth"]["component_0"]["lines"]["precision_5"] > 0.95
    assert sum(tenth["points"] for tenth in whole["depth"]["calibration"]) > 0
    assert whole["plane_score"]["right_lines"] == whole["plane_score"]["lines"] > 0
    assert whole["rotation_error"] < 0.2
    drawing = whole["drawing"]
    assert drawing["lines"]["ends"] == 2 * whole["lines"]
    assert drawing["truth"]["right_plane"] <= drawing["truth"]["right_axis"] <= drawing["truth"]["covered"]
    assert drawing["known_covered"] == drawing["truth"]["covered"] / drawing["truth"]["pixels"]
    name = json.loads(out.read_text())["photos"][0]["name"]
    with Image.open(tmp_path / f"{name}.jpg") as picture:
        assert picture.width > 3 * 700
    printed = capsys.readouterr().out
    titles = ("Table 1, formulation paper", "Table 2", "planes: recall", "Drawing against truth")
    assert [title for title in titles if title not in printed] == []


def test_a_photo_of_another_size_than_its_truth_is_refused(made_folder, drawn, tmp_path):
    case = find_dataset(made_folder).cases[0]
    (tmp_path / "made").mkdir()
    for path in case.truth.iterdir():
        (tmp_path / "made" / path.name).write_bytes(path.read_bytes())
    (tmp_path / "dataset.json").write_bytes((made_folder / "dataset.json").read_bytes())
    Image.fromarray(drawn.pixels[:600]).save(tmp_path / "made" / "photo.jpg")
    (tmp_path / "made" / "camera.json").write_text(
        json.dumps({"width": 1600, "height": 600, "K": drawn.camera.matrix.tolist()})
    )
    with pytest.raises(DatasetError, match="1600 x 600"):
        open_case(find_dataset(tmp_path).cases[0])


def test_a_scene_without_its_truth_is_named(made_folder, tmp_path):
    (tmp_path / "dataset.json").write_bytes((made_folder / "dataset.json").read_bytes())
    (tmp_path / "made").mkdir()
    for name in ("photo.jpg", "camera.json"):
        (tmp_path / "made" / name).write_bytes((made_folder / "made" / name).read_bytes())
    with pytest.raises(DatasetError, match="made"):
        open_case(find_dataset(tmp_path).cases[0])
