"""Command line, Python, batch, page and evaluation have one set of defaults, and give the same scene."""

import argparse
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import linecad
import linecad.evaluation.measure
from linecad.cli import batch, convert, edit, evaluate
from linecad.cli.arguments import options_of, reconstruction_of
from linecad.cli.main import main
from linecad.convert import Conversion
from linecad.corrections.edits import Corrections
from linecad.editing.run import EditOptions
from linecad.editing.session import Session
from linecad.editing.solving import TaskSolver
from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.measure import measure_photo
from linecad.evaluation.methods import Settings
from linecad.io.scene_file import read_scene
from linecad.lines.segments import find_segments
from linecad.options import Options
from solver.options import DEFAULT_TIME_LIMIT_S, FORMULATIONS, SolveOptions

ROOM = Path(__file__).resolve().parents[2] / "samples" / "room.jpg"
FAST = Options(solve=SolveOptions(fast=True))
BARE = {
    convert: ["convert", "a.jpg"], batch: ["batch", "a.jpg", "-o", "out"], edit: ["edit", "a.jpg"],
    evaluate: ["evaluate", "set"],
}  # fmt: skip


@pytest.mark.parametrize("command", BARE, ids=[words[0] for words in BARE.values()])
def test_a_command_that_is_told_nothing_has_the_defaults(command):
    parser = argparse.ArgumentParser()
    command.add_to(parser.add_subparsers())
    parsed = parser.parse_args(BARE[command])
    assert reconstruction_of(parsed, parsed.option) == Options()
    assert options_of(parsed, [Path("a.step")]) == (Options(), {})


def test_python_batch_page_and_evaluation_have_the_defaults():
    assert Conversion().options == Options()
    assert EditOptions(Path("a.json")).reconstruct == Options()
    assert Settings().reconstruction == Options()
    assert linecad.Options() == Options()


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_time_limit_is_that_of_the_formulation(formulation):
    assert SolveOptions(formulation=formulation).seconds == DEFAULT_TIME_LIMIT_S[formulation]
    assert Settings().options(formulation, "B+P").seconds == DEFAULT_TIME_LIMIT_S[formulation]


def by_python(path, _folder, _monkeypatch):
    return linecad.reconstruct(path, options=FAST)


def by_convert(path, folder, _monkeypatch):
    assert main(["convert", str(path), "-o", str(folder / "a.json"), "--fast", "--quiet"]) == 0
    return read_scene(folder / "a.json")


def by_batch(path, folder, _monkeypatch):
    command = ["batch", str(path), "-o", str(folder), "--format", "json", "--fast", "--workers", "1", "--quiet"]
    assert main(command) == 0
    return read_scene((folder / path.name).with_suffix(".json"))


def by_page(path, folder, monkeypatch):
    """As `linecad edit` begins, but for its process and its server."""
    answers = []

    def serve(photo, options, _on_ready, _on_stage):
        corrections = Corrections(photo.name, photo.width, photo.height)
        session = Session(photo, find_segments(photo.grey), options.reconstruct, corrections, lambda _: None)
        task = session.task(session.now().version)
        answers.append(TaskSolver(photo, options.reconstruct).answer(task, lambda _: None))

    monkeypatch.setattr("linecad.editing.run.edit", serve)
    output = ["-o", str(folder / "said.json")]
    assert main(["edit", str(path), *output, "--fast", "--no-browser", "--quiet"]) == 0
    return answers[0].made.scene


def labelled(path, folder):
    """A dataset of one photo with labels, of which none are needed."""
    shutil.copy(path, folder)
    labels = {"format": "linecad-labels", "version": 1, "photo": path.name, "crossings": []}
    (folder / "labels.json").write_text(json.dumps(labels))
    return folder


def by_evaluation(path, folder, monkeypatch):
    scenes, reconstruct_lines = [], linecad.evaluation.measure.reconstruct_lines

    def kept(*arguments, **more):
        made = reconstruct_lines(*arguments, **more)
        scenes.append(made.scene)
        return made

    monkeypatch.setattr(linecad.evaluation.measure, "reconstruct_lines", kept)
    [case] = find_dataset(labelled(path, folder)).cases
    assert measure_photo(case, Settings(ablation=False, reconstruction=FAST)).error is None
    return scenes[0]


@pytest.mark.parametrize("faint", [False, True])
def test_the_evaluation_looks_for_faint_segments_where_it_is_told(tmp_path, monkeypatch, faint):
    class LookedError(linecad.LinecadError):
        """The lines need not be found."""

    def look(_photo, **more):
        raise LookedError(str(more))

    monkeypatch.setattr(linecad.evaluation.measure, "find_lines", look)
    [case] = find_dataset(labelled(ROOM, tmp_path)).cases
    assert measure_photo(case, Settings(reconstruction=Options(faint=faint))).error == str({"faint": faint})


@pytest.fixture(scope="module")
def photo(made, tmp_path_factory):
    """The drawn boxes, which take a third of the time of a sample photo, five times."""
    path = tmp_path_factory.mktemp("photo") / "boxes.png"
    Image.fromarray(made.image()).save(path)
    return path


@pytest.fixture(scope="module")
def expected(photo):
    return by_python(photo, None, None)


@pytest.mark.parametrize(
    "way", [by_convert, pytest.param(by_batch, marks=pytest.mark.thorough), by_page, by_evaluation]
)
def test_every_way_gives_the_same_scene(expected, photo, tmp_path, monkeypatch, way):
    scene = way(photo, tmp_path, monkeypatch)
    assert scene.camera.matrix == pytest.approx(expected.camera.matrix)
    for name in ("id", "axis", "is_boundary", "component", "confidence"):
        np.testing.assert_array_equal(getattr(scene.lines, name), getattr(expected.lines, name))
    np.testing.assert_allclose(scene.lines.segment, expected.lines.segment, rtol=1e-9)
    np.testing.assert_allclose(scene.lines.ends, expected.lines.ends, rtol=1e-6, atol=1e-6)
    np.testing.assert_array_equal(scene.intersections.lines, expected.intersections.lines)
    np.testing.assert_array_equal(scene.intersections.real, expected.intersections.real)
    np.testing.assert_array_equal(scene.intersections.reason, expected.intersections.reason)
    assert [(plane.axis, plane.lines) for plane in scene.planes] == [(p.axis, p.lines) for p in expected.planes]
