"""`linecad elevation`: drawings at scale from a scene file."""

import json
import shutil
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
import pytest
from PIL import Image
from pypdf import PdfReader

from linecad.cli.main import main

ROOM = Path(__file__).resolve().parents[3] / "samples" / "room.jpg"
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def beside(folder, scene_file):
    """A folder with the scene file and its photo beside it."""
    shutil.copy(scene_file, folder / "room.json")
    shutil.copy(ROOM, folder / "room.jpg")
    return folder


def texts(path):
    return [text.text for text in ElementTree.parse(path).iter(f"{SVG}text")]


def test_a_facade_is_drawn_in_every_format_with_the_photo_beneath(beside, capsys):
    outputs = [word for suffix in ("svg", "pdf", "dxf", "tif") for word in ("-o", f"front.{suffix}")]
    chosen = ["--camera-height", "1.6", "--scale", "1:50", "--paper", "a2"]
    assert main(["elevation", "room.json", *outputs, *chosen, "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    assert "Scale: 1:50 on A2" in texts(beside / "front.svg")
    assert "Scale: 1:50 on A2" in PdfReader(beside / "front.pdf").pages[0].extract_text()
    document = ezdxf.readfile(beside / "front.dxf")
    assert document.layouts.get("Sheet").dxf.paper_width == 594
    picture = beside / document.modelspace().query("IMAGE")[0].image_def.dxf.filename
    assert picture.is_file()
    with Image.open(beside / "front.tif") as image:
        assert image.info["dpi"] == (200, 200)
    assert (beside / "front.tifw").is_file()


def test_the_plan_is_drawn(beside):
    assert main(["elevation", "room.json", "-o", "plan.svg", "--plan", "--quiet"]) == 0
    assert any(text.startswith("Plan, facade 0 ") for text in texts(beside / "plan.svg"))


def test_names_that_say_their_kind_twice_are_taken(beside):
    assert main(["elevation", "room.json", "-o", "a.plan.svg", "--plan", "--quiet"]) == 0
    assert main(["elevation", "room.json", "-o", "a.elevation.svg", "--quiet"]) == 0
    assert any(text.startswith("Plan, facade 0 ") for text in texts(beside / "a.plan.svg"))
    assert any(text.startswith("Elevation of facade 0") for text in texts(beside / "a.elevation.svg"))


def test_a_plane_chooses_its_facade(beside):
    assert main(["elevation", "room.json", "-o", "a.svg", "--facade", "0", "--quiet"]) == 0
    title = next(text for text in texts(beside / "a.svg") if text.startswith("Elevation of facade 0"))
    plane = title.split("plane ")[1].rstrip(")")
    assert main(["elevation", "room.json", "-o", "b.svg", "--plane", plane, "--quiet"]) == 0
    assert (beside / "a.svg").read_bytes() == (beside / "b.svg").read_bytes()


def test_export_draws_the_same_by_the_suffix(beside):
    assert main(["elevation", "room.json", "-o", "a.pdf", "--camera-height", "1.6", "--paper", "A4", "--quiet"]) == 0
    chosen = ["--camera-height", "1.6", "--option", "paper=A4"]
    assert main(["export", "room.json", "-o", "b.elevation.pdf", *chosen, "--quiet"]) == 0
    assert (beside / "a.pdf").read_bytes() == (beside / "b.elevation.pdf").read_bytes()


def test_a_line_of_known_length_sets_the_scale(beside):
    line = next(each for each in json.loads((beside / "room.json").read_text())["lines"] if each["component"] == 0)
    known = f"{line['id']}=2.5"
    assert main(["elevation", "room.json", "-o", "a.svg", "--length", known, "--quiet"]) == 0
    assert any(text.startswith("Scale: 1:") for text in texts(beside / "a.svg"))


def test_without_the_photo_a_line_says_that_none_lies_beneath(folder, scene_file, capsys):
    assert main(["elevation", str(scene_file), "-o", "a.svg", "--quiet"]) == 0
    (said,) = capsys.readouterr().err.splitlines()
    assert said.endswith("no photo lies beneath the drawing")
    assert main(["elevation", str(scene_file), "-o", "b.svg", "--option", "underlay=off", "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    assert "no photo lies beneath" in (folder / "a.svg").read_text()
    assert "no photo lies beneath" not in (folder / "b.svg").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "a.svg", "--plane", "4711"], "there is no plane 4711; the facades are 0 (plane "),
        (["-o", "a.svg", "--facade", "99"], "there is no facade 99; the facades are 0 (plane "),
        (["-o", "a.svg", "--scale", "1:50"], "1:50 needs a known length"),
        (["-o", "a.svg", "--scale", "50", "--camera-height", "1.6"], "expected one like 1:50"),
        (["-o", "a.svg", "--scale", "1:1", "--camera-height", "1.6"], "does not fit on A0; 1:"),
        (["-o", "a.tif"], "no photo is at hand; name it with --photo"),
        (["-o", "a.tif", "--plan"], "unknown suffix .tif for a plan; use .svg, .pdf, .dxf"),
        (["-o", "a.step"], "unknown suffix .step for an elevation; use .svg, .pdf, .dxf, .tif"),
        (["-o", "a.svg", "--option", "sewn=on"], "there is no option 'sewn' for .svg"),
        (
            ["-o", "a.elevation.SVG", "--plan"],
            "the name says an elevation, --plan draws a plan; leave it out, or write a.pl",
        ),
        (["-o", "a.plan.svg"], "the name says a plan, which --plan draws; add it, or write a.elevation.svg"),
        (["-o", "a.plan.tif"], "the name says a plan, which --plan draws; add it, or write a.elevation.tif"),
        ([], "no output was named"),
    ],
)
def test_what_cannot_be_drawn_is_told_in_one_line(fails, scene_file, arguments, words):
    told = fails("elevation", scene_file, *arguments, *(["--option", "underlay=off"] if "a.svg" in arguments else []))
    assert words in told


@pytest.mark.parametrize(
    "arguments",
    [["--plane", "1", "--facade", "1"], ["--plane", "-1"], ["--paper", "A9"], ["--length", "3"]],
)
def test_wrong_usage(fails, scene_file, arguments):
    fails("elevation", scene_file, "-o", "a.svg", *arguments, code=2)
