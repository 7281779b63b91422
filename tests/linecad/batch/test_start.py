"""From what the command names to a plan."""

import pytest

from linecad.batch.start import Means, make_plan
from linecad.convert import Conversion
from linecad.errors import DepthMapError, OptionError
from linecad.options import Options
from solver.options import SolveOptions

PLAIN = Conversion()


@pytest.fixture
def mixed(tmp_path):
    """A folder with photos, a map of one of them, and what MoGe wrote of another."""
    names = ["a.jpg", "a.depth.png", "b.jpg", "b/depth.exr", "b/image.jpg", "b/mask.png", "c.jpg"]
    for name in names:
        path = tmp_path / "survey" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"1")
    return tmp_path / "survey"


def plan_of(mixed, conversion=PLAIN, depth_maps=True):
    means = Means(workers=1, memory_limit_mb=1000)
    return make_plan([str(mixed)], mixed.parent / "out", (".json",), conversion, means, depth_maps)[0]


def test_maps_are_found_and_are_no_photos(mixed):
    plan = plan_of(mixed, Conversion(options=Options(depth_kind="z")))
    assert [photo.name for photo in plan.photos] == ["a.jpg", "b.jpg", "c.jpg"]
    assert plan.maps == {mixed / "a.jpg": mixed / "a.depth.png", mixed / "b.jpg": mixed / "b" / "depth.exr"}


def test_nobody_asked_for_maps(mixed):
    plan = plan_of(mixed, depth_maps=False)
    assert len(plan.photos) == 6
    assert plan.maps == {}
    with pytest.raises(OptionError, match="option depth-kind tells of a depth map"):
        plan_of(mixed, Conversion(options=Options(depth_kind="z")), depth_maps=False)


def test_maps_that_nothing_looks_at_or_that_are_not_there_are_refused(mixed):
    with pytest.raises(OptionError, match="only formulation=bodies looks"):
        plan_of(mixed, Conversion(options=Options(solve=SolveOptions(fast=True))))
    (mixed / "a.depth.png").unlink()
    (mixed / "b" / "depth.exr").unlink()
    with pytest.raises(DepthMapError, match="no photo has a depth map beside it"):
        plan_of(mixed)
