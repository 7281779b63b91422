"""A photo and its depth map to a scene, by the command: what the file says of the map, and that it is used."""

import json
from pathlib import Path

import numpy as np
import pytest

from linecad.cli.main import main
from linecad.evaluation.depth import score_depth
from linecad.io.scene_file import read_scene

pytestmark = pytest.mark.thorough  # stage by stage, maps have their everyday tests in tests/linecad

SAMPLES = Path(__file__).resolve().parents[1] / "samples"
WIDTH = 0.012  # of the errors of the map that is drawn


@pytest.fixture(scope="module")
def room_map(sample_depth_map):
    return sample_depth_map("room", WIDTH)


@pytest.fixture(scope="module")
def convert(tmp_path_factory):
    """A function that converts the room with some options, to the path of the scene file."""

    def run(*options):
        path = tmp_path_factory.mktemp("scene") / "room.json"
        arguments = ["convert", SAMPLES / "room.jpg", "--camera", SAMPLES / "room.json", "-o", path, *options]
        assert main([*map(str, arguments), "--quiet"]) == 0
        return path

    return run


@pytest.fixture(scope="module")
def without(convert):
    return convert()


@pytest.fixture(scope="module")
def mapped(convert, room_map):
    return convert("--depth", room_map)


def document_of(path):
    return json.loads(path.read_text(encoding="utf-8"))


def test_the_scene_names_the_map_and_the_lines_that_it_placed(without, mapped, room_map):
    document = document_of(mapped)
    report = document["depth_map"]
    assert list(report) == ["file", "left_out", "kind", "shift", "scale", "width"]
    assert (report["file"], report["left_out"], report["kind"], report["shift"]) == (room_map.name, None, "z", 0)
    assert WIDTH / 4 < report["width"] < 4 * WIDTH
    assert all("probability" in line for line in document["lines"])
    placed = [line for line in document["lines"] if "by_depth_map" in line]
    assert 0 < len(placed) < len(document["lines"])
    assert all(line["by_depth_map"] is True for line in placed)
    plain = document_of(without)
    assert "depth_map" not in plain
    assert all("probability" in line and "by_depth_map" not in line for line in plain["lines"])
    assert any("or the depth map put them" in note for note in document["notes"])
    assert not any("depth map" in note for note in plain["notes"])


def test_the_scale_is_that_of_the_map_over_the_scene(mapped, room_map):
    scene = read_scene(mapped)
    with np.load(room_map) as arrays:
        depth = arrays["depth"]
    # A quarter of a line away from its middle: on the line itself the map bleeds.
    middle = scene.lines.segment.mean(axis=1) + 0.02 * scene.camera.width
    column, row = (middle * depth.shape[1] / scene.camera.width).astype(int).T
    inside = (column < depth.shape[1]) & (row < depth.shape[0])
    found = (scene.lines.ends @ scene.rotation.T)[..., 2].mean(axis=1)
    ratio = depth[row[inside], column[inside]] / found[inside]
    assert np.median(ratio) == pytest.approx(scene.depth_map.scale, rel=0.05)


def test_depths_are_truer_with_the_map(without, mapped):
    truth = json.loads((SAMPLES / "room.truth.json").read_text(encoding="utf-8"))
    points = np.array(truth["points"], float)[truth["on_line"]]
    before, after = (score_depth(read_scene(path), points[:, :2], points[:, 4]) for path in (without, mapped))
    assert after.with_depth >= 0.9 * before.with_depth
    assert after.recall_5 > before.recall_5
    assert after.precision_5 > before.precision_5


def test_two_runs_give_the_same_bytes(convert, mapped, room_map):
    assert convert("--depth", room_map).read_bytes() == mapped.read_bytes()


def test_a_map_that_is_left_out_changes_nothing_but_what_is_said_of_it(convert, without, room_map, tmp_path):
    with np.load(room_map) as arrays:
        depth = arrays["depth"]
    shuffled = np.random.default_rng(0).permutation(depth.ravel()).reshape(depth.shape)
    np.savez(tmp_path / "shuffled.npz", depth=shuffled)
    document = document_of(convert("--depth", tmp_path / "shuffled.npz", "--option", "depth-kind=z"))
    report = document.pop("depth_map")
    assert list(report) == ["file", "left_out"]
    assert report["file"] == "shuffled.npz"
    document["notes"].remove(f"the depth map shuffled.npz was left out: {report['left_out']}")
    assert json.dumps(document) == json.dumps(document_of(without))
