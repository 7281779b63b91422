"""A job does what was asked for, with the files as they were when it was."""

import numpy as np
import pytest

import linecad.pipeline
from linecad.batch.work import do
from linecad.convert import Conversion
from linecad.errors import ReconstructionError


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
