"""A job does what was asked for, with the files as they were when it was."""

from dataclasses import replace

import numpy as np
import pytest

import linecad.pipeline
from linecad.batch.work import do
from linecad.convert import Conversion
from linecad.errors import ReconstructionError
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

    monkeypatch.setattr(linecad.pipeline, "place_lines", look)
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
