"""A job does what was asked for, with the files as they were when it was."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import linecad.pipeline
from linecad.batch.thumbnail import WIDTH
from linecad.batch.work import do
from linecad.convert import Conversion
from linecad.errors import OutputError, ReconstructionError
from linecad.io.scene_file import read_scene
from linecad.model.scale import LineLength
from linecad.model.wanted import Wanted


@pytest.fixture
def mapped(tmp_path):
    """A conversion with a depth map of the small photo."""
    np.savez(tmp_path / "map.npz", depth=np.random.default_rng(0).uniform(1, 9, (213, 320)))
    return Conversion(focal=300.0, depth=tmp_path / "map.npz")


def test_the_map_reaches_the_program(small_photo, job_of, mapped, monkeypatch):
    def look(_graph, sight, *_):
        raise ReconstructionError(f"seen {sight.depth.values.shape}")

    monkeypatch.setattr(linecad.pipeline, "find_evidence", look)
    assert do(job_of(small_photo, conversion=mapped)).error == "seen (213, 320)"


def test_a_map_that_changes_while_the_batch_runs_fails_its_photo(small_photo, job_of, mapped):
    job = job_of(small_photo, conversion=mapped)
    mapped.depth.write_bytes(b"another one")
    outcome = do(job)
    assert outcome.status == "failed"
    assert "map.npz was changed while the batch was running" in outcome.error


def test_a_map_that_is_damaged_fails_its_photo(small_photo, job_of, mapped):
    mapped.depth.write_bytes(mapped.depth.read_bytes()[:9000])
    outcome = do(job_of(small_photo, conversion=mapped))
    assert outcome.status == "failed"
    assert "map.npz is damaged or incomplete" in outcome.error


@pytest.mark.parametrize(("suffixes", "kept"), [((".json", ".obj"), ["room.json"]), ((".obj",), [])])
def test_a_length_that_is_not_there_keeps_the_scene(small_photo, job_of, conversion, suffixes, kept):
    wanted = replace(conversion, wanted=Wanted(known=LineLength(99999, 3.0)))
    job = job_of(small_photo, suffixes, conversion=wanted)
    outcome = do(job)
    assert outcome.status == "failed"
    assert "no line 99999" in outcome.error
    assert ("the whole scene is kept in" in outcome.error) == bool(kept)
    assert sorted(outcome.files) == sorted([*kept, "thumbnails/room.jpg"])
    assert sorted(path.name for path in job.folder.iterdir()) == sorted([*kept, "thumbnails"])


def refusing(*_):
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize(("suffixes", "made"), [((".json", ".stl", ".dxf"), [".json", ".dxf"]), ((".stl",), [])])
def test_a_format_that_cannot_be_written_leaves_the_others(small_photo, job_of, monkeypatch, suffixes, made):
    job = job_of(small_photo, suffixes)
    (job.folder / "room.stl").write_text("of an earlier batch")
    monkeypatch.setattr("exporters.mesh.write", refusing)
    outcome = do(job)
    assert outcome.status == "failed"
    assert outcome.error.startswith(f"{job.folder / 'room.stl'} was not written: no space is left for it")
    assert outcome.error.endswith("; the scene is kept in room.json, for linecad export") == bool(made)
    assert outcome.error.count("kept") == bool(made)
    files = [*(f"room{suffix}" for suffix in made), "thumbnails/room.jpg"]
    assert outcome.files == {file: (job.folder / file).stat().st_size for file in files}
    assert (job.folder / "room.stl").read_text() == "of an earlier batch"
    if made:
        assert len(read_scene(job.folder / "room.json").lines) > 0
    with Image.open(job.thumbnail) as thumbnail:
        assert thumbnail.width == 2 * WIDTH  # the photo and its lines


def test_a_scene_file_that_cannot_be_written_is_not_called_kept(small_photo, job_of, monkeypatch):
    def refuse(_scene, path):
        raise OutputError(f"{path} was not written: no space is left for it")

    monkeypatch.setattr("linecad.outputs.write_scene", refuse)
    outcome = do(job_of(small_photo, (".json", ".dxf")))
    assert outcome.error.endswith("room.json was not written: no space is left for it")
    assert list(outcome.files) == ["room.dxf", "thumbnails/room.jpg"]


def test_a_disk_that_takes_no_small_picture_either_keeps_the_rest(small_photo, job_of, monkeypatch):
    def refuse(path, *_):
        raise OutputError(f"{path} was not written: no space is left for it")

    monkeypatch.setattr("exporters.mesh.write", refusing)
    monkeypatch.setattr("linecad.batch.work.write_thumbnail", refuse)
    outcome = do(job_of(small_photo, (".json", ".stl")))
    assert "room.stl was not written" in outcome.error
    assert outcome.error.endswith("; the scene is kept in room.json, for linecad export")
    assert list(outcome.files) == ["room.json"]
