"""`linecad evaluate` from folder to files: the same figures whatever the number of workers, errors in one line."""

import json
import multiprocessing
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

import linecad.pipeline
from linecad.cli.main import main
from linecad.errors import LinecadError, ReconstructionError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.measure import measure_photo
from linecad.evaluation.methods import Settings
from linecad.evaluation.run import evaluate
from linecad.options import Options
from linecad.threads import THREADS


def without_seconds(value):
    """JSON without what a clock told."""
    if isinstance(value, dict):
        return {name: without_seconds(each) for name, each in value.items() if name not in ("seconds", "tables")}
    return [without_seconds(each) for each in value] if isinstance(value, list) else value


@pytest.mark.thorough
def test_the_figures_do_not_hang_on_the_number_of_workers(york_folder, tmp_path, capsys):
    documents = []
    for workers in (1, 2):
        out = tmp_path / f"{workers}.json"
        assert main(["evaluate", str(york_folder), "--json", str(out), "--workers", str(workers), "--quiet"]) == 0
        documents.append(without_seconds(json.loads(out.read_text())))
    assert documents[0] == documents[1]
    assert [photo["name"] for photo in documents[0]["photos"]] == ["P1", "P2"]
    out, err = capsys.readouterr()
    assert "marked line length covered" in out
    assert err == ""


def test_labels_made_by_hand_give_the_papers_tables(labels_folder, tmp_path, capsys):
    files = [tmp_path / name for name in ("a.json", "a.md", "a.html")]
    names = [
        option for pair in zip(("--json", "--markdown", "--report"), map(str, files), strict=True) for option in pair
    ]
    assert main(["evaluate", str(labels_folder), *names, "--time-limit", "20"]) == 0
    out, err = capsys.readouterr()
    assert "boxes: measured" in err
    assert files[1].read_text() == out
    assert "## Table 1, formulation paper" in out
    assert "## Table 1, formulation gain" in out
    document = json.loads(files[0].read_text())
    statistics = document["photos"][0]["statistics"]
    assert statistics["real"] > 20
    assert document["photos"][0]["methods"]["gain"]["B+P"]["decisions"]["tree_fake"] == 0
    assert files[2].read_text().startswith("<!DOCTYPE html>")


@pytest.mark.thorough
def test_without_ablation_only_the_default_settings_are_solved(labels_folder, tmp_path, capsys):
    out = tmp_path / "a.json"
    assert main(["evaluate", str(labels_folder), "--json", str(out), "--no-ablation", "--quiet"]) == 0
    photo = json.loads(out.read_text())["photos"][0]
    assert photo["methods"] == {}
    assert photo["whole"]["decisions"]["chosen_real"] > 20
    assert "Table 1" not in capsys.readouterr().out


@pytest.mark.thorough
def test_options_reach_the_reconstruction_and_the_record(labels_folder, tmp_path, capsys):
    out = tmp_path / "a.json"
    options = ["--fast", "--no-ablation", "--option", "weights=ones", "--option", "without=planarity,boundary"]
    assert main(["evaluate", str(labels_folder), "--json", str(out), *options, "--quiet"]) == 0
    document = json.loads(out.read_text())
    settings = document["settings"]["reconstruction"]
    assert settings["weights"] == "ones"
    assert settings["solve"]["without"] == ["boundary", "planarity"]
    assert settings["solve"]["time_limit_s"] is None
    assert document["photos"][0]["whole"]["status"] == "robust fit"
    assert capsys.readouterr().err == ""


@pytest.mark.thorough
def test_the_samples_can_be_evaluated(tmp_path, capsys):
    samples = Path(__file__).parents[3] / "samples"
    assert main(["evaluate", str(samples), "--fast", "--limit", "1", "--report", str(tmp_path / "a.html")]) == 0
    out, err = capsys.readouterr()
    assert "courtyard: measured" in err
    depths = out[out.index("## Depths by photo") :].split("\n\n")[2]
    shown = {line.split(" | ")[0]: line for line in depths.splitlines()}
    assert "## Drawing: lines" in out
    assert float(shown["| courtyard"].split("|")[-2]) > 85  # %, precision of component 0
    assert "plan, as found" in (tmp_path / "a.html").read_text()


def test_one_photo_that_fails_does_not_stop_the_others(york_folder, tmp_path, capsys):
    (tmp_path / "P1.png").write_bytes(b"")
    cases = list(find_dataset(york_folder).cases)
    broken = Case("broken", "york", tmp_path / "P1.png", cases[0].truth)
    found = evaluate((broken, cases[1]), Settings(), 1)
    assert "cannot be read" in found[0].error or "P1.png" in found[0].error
    assert found[1].error is None
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        ([], 2, "DATASET"),
        (["none"], 1, "not a folder"),
        (["."], 1, "no dataset"),
        ([".", "--json", "none/a.json"], 1, "none"),
        ([".", "--json", "a", "--report", "a"], 1, "named twice"),
        ([".", "--turned", "none"], 1, "not a folder"),
        ([".", "--workers", "0"], 2, "'0' is not a whole number"),
        ([".", "--limit", "x"], 2, "'x' is not a whole number"),
        ([".", "--time-limit", "0"], 2, "positive"),
    ],
)
def test_wrong_use_is_told_in_one_line(tmp_path, monkeypatch, capsys, arguments, code, says):
    monkeypatch.chdir(tmp_path)
    try:
        ended = main(["evaluate", *arguments])
    except SystemExit as leaving:
        ended = leaving.code
    err = capsys.readouterr().err
    assert ended == code
    assert says in err
    assert len(err.strip().splitlines()) == 1


def test_the_truth_is_not_overwritten(labels_folder, capsys):
    truth = labels_folder / "boxes.json"
    before = truth.read_bytes()
    assert main(["evaluate", str(labels_folder), "--json", str(truth)]) == 1
    assert "is an input too" in capsys.readouterr().err
    assert truth.read_bytes() == before


def test_when_no_photo_can_be_measured_the_command_fails(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    labels = {"format": "linecad-labels", "version": 1, "photo": "none.jpg", "crossings": []}
    (tmp_path / "a.json").write_text(json.dumps(labels))
    assert main(["evaluate", ".", "--json", "out.json", "--quiet"]) == 1
    assert "none.jpg" in capsys.readouterr().err
    assert not (tmp_path / "out.json").exists()


def test_a_report_that_raises_ends_the_processes(york_folder):
    def interrupt(*_):
        raise KeyboardInterrupt

    before = {name: os.environ.get(name) for name in THREADS}
    with pytest.raises(KeyboardInterrupt):
        evaluate(find_dataset(york_folder).cases, Settings(), 1, interrupt)
    for process in multiprocessing.active_children():
        process.join(120)  # a process that has begun a photo ends it first, and a busy machine takes long
    assert multiprocessing.active_children() == []
    assert {name: os.environ.get(name) for name in THREADS} == before


def test_a_process_that_dies_is_an_error(monkeypatch, york_folder):
    monkeypatch.setattr("linecad.evaluation.run._set_up", die)
    with pytest.raises(LinecadError, match="died"):
        evaluate(find_dataset(york_folder).cases, Settings(), 1)


def die():
    os._exit(3)


@pytest.fixture
def mapped_folder(labels_folder, tmp_path):
    """The labelled photo with a depth map beside it."""
    folder = tmp_path / "labelled"
    shutil.copytree(labels_folder, folder)
    np.savez(folder / "boxes.depth.npz", depth=np.random.default_rng(0).uniform(1, 9, (120, 160)))
    return folder


def test_maps_beside_the_photos_are_used_where_they_are_asked_for(mapped_folder, monkeypatch):
    seen = []

    def look(_graph, sight, *_):
        seen.append(sight.depth)
        raise ReconstructionError("the places need not be found")

    monkeypatch.setattr(linecad.pipeline, "find_evidence", look)
    dataset = find_dataset(mapped_folder)
    settings = Settings(ablation=False, reconstruction=Options(depth_kind="distance"))
    for cases in (dataset.cases, dataset.with_depth_maps().cases):
        assert measure_photo(cases[0], settings).error == "the places need not be found"
    assert seen[0] is None
    assert (seen[1].values.shape, seen[1].kind) == ((1200, 1600), "distance")
    assert dataset.with_depth_maps().cases[0].files[-1] == mapped_folder / "boxes.depth.npz"


@pytest.mark.thorough
def test_the_report_says_that_maps_were_used(mapped_folder, tmp_path, capsys):
    files = [tmp_path / name for name in ("a.json", "a.html")]
    command = ["evaluate", str(mapped_folder), "--json", str(files[0]), "--report", str(files[1]), "--no-ablation"]
    assert main([*command, "--depth-maps", "--option", "depth-kind=z", "--quiet"]) == 0
    said = "1 of them with a depth map"
    assert said in capsys.readouterr().out
    assert said in files[1].read_text()
    document = json.loads(files[0].read_text())
    assert document["photos"][0]["depth_map"] == "boxes.depth.npz"
    assert document["settings"]["reconstruction"]["depth_kind"] == "z"
    assert main([*command, "--quiet"]) == 0
    assert "depth map" not in capsys.readouterr().out
    assert json.loads(files[0].read_text())["photos"][0]["depth_map"] is None


def test_a_dataset_without_any_map_and_a_map_that_would_be_lost(labels_folder, mapped_folder, capsys):
    assert main(["evaluate", str(labels_folder), "--depth-maps", "--quiet"]) == 1
    assert "boxes.depth.npz" in capsys.readouterr().err
    depth = mapped_folder / "boxes.depth.npz"
    assert main(["evaluate", str(mapped_folder), "--depth-maps", "--json", str(depth), "--quiet"]) == 1
    assert "is an input too" in capsys.readouterr().err
