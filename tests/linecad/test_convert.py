"""A conversion and Python's `reconstruct`: what they read, and what they refuse before the photo."""

from pathlib import Path

import numpy as np
import pytest

import linecad
import linecad.pipeline
from linecad.convert import Conversion
from linecad.errors import DepthMapError, OptionError, ReconstructionError
from linecad.options import Options
from solver.options import SolveOptions

ROOM = Path(__file__).resolve().parents[2] / "samples" / "room.jpg"


@pytest.fixture
def depth_file(tmp_path):
    np.savez(tmp_path / "map.npz", depth=np.random.default_rng(0).uniform(1, 9, (60, 90)))
    return tmp_path / "map.npz"


@pytest.fixture
def sights(monkeypatch):
    """What the placement of bodies was given; it does nothing else."""
    seen = []

    def look(_graph, sight, *_):
        seen.append(sight)
        raise ReconstructionError("the places need not be found")

    monkeypatch.setattr(linecad.pipeline, "find_evidence", look)
    return seen


@pytest.mark.parametrize("kind", [str, Path])
def test_python_hands_a_map_over(depth_file, sights, kind):
    with pytest.raises(ReconstructionError, match="need not be found"):
        linecad.reconstruct(ROOM, depth=kind(depth_file), options=Options(depth_kind="inverse"))
    [sight] = sights
    assert sight.depth.values.shape == sight.pixels.shape[:2]
    assert sight.depth.kind == "inverse"


def test_without_a_map_there_is_none(sights):
    with pytest.raises(ReconstructionError, match="need not be found"):
        linecad.reconstruct(ROOM)
    assert sights[0].depth is None


@pytest.mark.usefixtures("sights")
def test_the_stages_tell_of_the_map(depth_file):
    conversion, stages = Conversion(depth=depth_file), []
    with pytest.raises(ReconstructionError):
        conversion.reconstruct(conversion.read(ROOM), on_stage=stages.append)
    assert stages[0] == "reading the depth map"


def test_what_does_not_go_together_is_refused_before_the_photo(depth_file, tmp_path):
    nowhere = tmp_path / "none.jpg"
    with pytest.raises(OptionError, match="only formulation=bodies looks"):
        linecad.reconstruct(nowhere, depth=depth_file, options=Options(solve=SolveOptions(fast=True)))
    with pytest.raises(OptionError, match="option depth-factor tells of a depth map, and none is given"):
        linecad.reconstruct(nowhere, options=Options(depth_factor=0.5))
    with pytest.raises(DepthMapError, match="does not exist"):
        linecad.reconstruct(nowhere, depth=tmp_path / "none.npz")


def test_maps_that_come_with_each_photo_count_as_given():
    conversion = Conversion(options=Options(depth_factor=0.5))
    assert conversion.checked(maps_come=True) is conversion
    with pytest.raises(OptionError, match="only formulation=bodies looks"):
        Conversion(options=Options(over_bodies=False)).checked(maps_come=True)
