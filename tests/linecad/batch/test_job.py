"""What a job may make, by the rows of its formats alone."""

import re

import pytest

from exporters.beside import Beside
from exporters.formats import FORMATS, Format
from linecad.batch.job import Job, Limits
from linecad.convert import Conversion


@pytest.fixture
def job(tmp_path, monkeypatch):
    """A job with the scene file, a format without side files, and a new one with them."""
    row = Format("exporters.new", "lines", "metres", beside=Beside(".parts", re.compile(r"part-\d\.bin"), ".lib"))
    monkeypatch.setitem(FORMATS, ".new", row)
    suffixes = (".json", ".dxf", ".new")
    return Job(tmp_path / "p.jpg", "0" * 64, "p", tmp_path, suffixes, Conversion(), Limits(1.0, 100), "f" * 64)


def test_its_places_are_those_of_its_formats(job):
    names = [str(place.relative_to(job.folder)) for place in job.places]
    assert names == ["p.new.lib", "p.new.parts", "p.json", "p.dxf", "p.new", "thumbnails/p.jpg"]


def test_what_it_made_is_found_with_what_others_refer_to_first(job):
    (job.folder / "p.new.parts").mkdir()
    for name in ("p.new.lib", "p.new.parts/part-2.bin", "p.new.parts/part-1.bin", "p.new.parts/mine.txt", "p.dxf.lib"):
        (job.folder / name).write_text("made")
    assert [str(path.relative_to(job.folder)) for path in job.made()] == [
        "p.new.lib", "p.new.parts/part-1.bin", "p.new.parts/part-2.bin",
        "p.json", "p.dxf", "p.new", "thumbnails/p.jpg",
    ]  # fmt: skip
    without = [str(path.relative_to(job.folder)) for path in job.made([job.folder / "p.new"])]
    assert without == ["p.json", "p.dxf", "thumbnails/p.jpg"]


@pytest.mark.parametrize(
    ("file", "allowed"),
    [
        ("p.json", True),
        ("p.dxf", True),
        ("thumbnails/p.jpg", True),
        ("p.new.lib", True),
        ("p.new.parts/part-1.bin", True),
        ("p.new.parts/mine.txt", False),
        ("p.new.parts/../part-1.bin", False),
        ("p.dxf.parts/part-1.bin", False),
        ("p.obj", False),
        ("q.json", False),
        ("thumbnails/q.jpg", False),
        ("../p.json", False),
        ("/p.json", False),
    ],
)
def test_it_may_make_its_own_files_alone(job, file, allowed):
    assert job.may_make(file) is allowed


def test_drawings_may_have_files_beside_them(tmp_path):
    suffixes = (".elevation.dxf", ".elevation.tif", ".dxf")
    job = Job(tmp_path / "p.jpg", "0" * 64, "p", tmp_path, suffixes, Conversion(), Limits(1.0, 100), "f" * 64)
    names = [str(place.relative_to(job.folder)) for place in job.places]
    assert names[:2] == ["p.elevation.dxf.pictures", "p.elevation.tifw"]
    assert job.may_make("p.elevation.tifw")
    assert not job.may_make("p.dxf.pictures/photo-0123456789abcdef.jpg")
