"""A conversion and Python's `reconstruct`: what they read, and what they refuse before the photo."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import linecad
import linecad.pipeline
from linecad.convert import Conversion
from linecad.corrections.edits import Corrections
from linecad.corrections.file import write_corrections
from linecad.errors import DepthMapError, OptionError, ReconstructionError
from linecad.model.scale import LineLength
from linecad.model.wanted import Wanted
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


@pytest.mark.parametrize("options", [Options(solve=SolveOptions(fast=True)), Options(over_bodies=False)])
def test_a_confidence_that_the_program_does_not_tell_is_refused(options):
    asked = Conversion(options=options, wanted=Wanted(confidence=0.5))
    with pytest.raises(OptionError, match="only formulation=bodies tells how likely"):
        asked.checked()
    assert replace(asked, options=Options()).checked().wanted.confidence == 0.5
    assert replace(asked, wanted=Wanted()).checked().options == options


def test_a_drawing_to_scale_needs_a_length_that_may_be_known(tmp_path):
    asked = Conversion(values={"drawing-scale": "1:50"})
    with pytest.raises(OptionError, match="drawing-scale=1:50 needs a known length"):
        asked.checked()
    write_corrections(Corrections("room.jpg", 400, 300), tmp_path / "said.json")
    for known in (
        replace(asked, wanted=Wanted(known=LineLength(3, 2.0))),
        replace(asked, corrections=tmp_path / "said.json"),  # a length among them
        replace(asked, values={"drawing-scale": "fit"}),
    ):
        assert known.checked() == known


def test_maps_that_come_with_each_photo_count_as_given():
    conversion = Conversion(options=Options(depth_factor=0.5))
    assert conversion.checked(maps_come=True) is conversion
    with pytest.raises(OptionError, match="only formulation=bodies looks"):
        Conversion(options=Options(over_bodies=False)).checked(maps_come=True)
