"""What of the model is shown and exported: the page, the command and the library choose the same."""

import io
import json
import zipfile

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exporters.drawings.facades import facades_of
from exporters.model import build_model
from linecad.cli.main import main
from linecad.editing.wanted import read_wanted
from linecad.io.strict_json import JsonError, Node
from linecad.model.choice import DETAILS
from linecad.model.groups import GROUPS
from linecad.model.wanted import Wanted

GIVEN = ("main", "confidence", "groups", "detail")


@pytest.fixture(scope="module")
def solved(open_page):
    page = open_page()
    page.solve()
    return page


@pytest.fixture
def files(solved, tmp_path, made_photo):
    """The scene file that the page exports, beside its photo."""
    (tmp_path / "made.json").write_bytes(solved.get("export/json").content)
    cv2.imwrite(str(tmp_path / "made.png"), made_photo.pixels[..., ::-1])
    return tmp_path


def command(files, name, output, *more):
    """The bytes that a command writes."""
    photo = ["--photo", str(files / "made.png"), "-o", str(files / output), "--quiet"]
    assert main([name, str(files / "made.json"), *photo, *more]) == 0
    return (files / output).read_bytes()


def exported(solved, name, **wanted):
    answer = solved.get(f"export/{name}", params={"wanted": json.dumps(wanted)})
    assert answer.status_code == 200, answer.text
    return answer.content


def test_the_bytes_are_those_of_linecad_export_with_the_same_choice(solved, files):
    lines = solved.session.scene().lines
    sure = float(np.quantile(lines.probability, 0.4))
    u, v = lines.segment[lines.component == lines.component.max()][0].mean(axis=0).tolist()
    wanted = {"confidence": sure, "groups": "main", "main": [u, v], "detail": "openings"}
    more = ["--confidence", str(sure), "--groups", "main", "--main", f"{u},{v}", "--detail", "openings"]
    for name in ("json", "dxf", "glb"):
        of_page = exported(solved, name, **wanted)
        assert of_page == command(files, "export", f"out.{name}", *more), name
        assert of_page != exported(solved, name)


@pytest.mark.parametrize("suffix", ["svg", "pdf", "dxf"])
def test_the_elevation_of_a_plane_is_that_of_linecad_elevation(solved, files, suffix):
    facades = facades_of(build_model(solved.session.scene()))
    drawn = set()
    for facade in facades[:2]:
        of_page = exported(solved, f"elevation.{suffix}", plane=facade.plane, confidence=0.01)
        if suffix == "dxf":  # its picture lies beside it
            of_page = zipfile.ZipFile(io.BytesIO(of_page)).read("made.elevation.dxf")
        more = ["--plane", str(facade.plane), "--confidence", "0.01"]
        assert of_page == command(files, "elevation", f"made.elevation.{suffix}", *more)
        drawn.add(of_page)
    assert len(drawn) == 2


def test_a_plane_that_is_no_facade_is_told_so(solved):
    ground = next(plane["id"] for plane in solved.state()["planes"] if plane["axis"] == "z")
    answer = solved.get("export/elevation.svg", params={"wanted": json.dumps({"plane": ground})})
    assert answer.status_code == 422
    assert f"plane {ground} has no upright wall; the facades are" in answer.json()["error"]


def test_planes_that_are_facades_say_so(solved):
    facades = {facade.plane for facade in facades_of(build_model(solved.session.scene()))}
    assert {plane["id"] for plane in solved.state()["planes"] if plane["is_facade"]} == facades != set()


@given(st.floats(0, 1), st.sampled_from(GROUPS), st.sampled_from(DETAILS))
def test_what_is_shown_is_what_the_files_hold(solved, confidence, groups, detail):
    scene, wanted = solved.session.scene(), {"confidence": confidence, "groups": groups, "detail": detail}
    shown = solved.post("shown", **wanted).json()
    own = np.asarray(scene.lines.probability)[(scene.lines.component == 0) | (groups == "all")]
    assert (shown["nothing"] is not None) == bool(confidence > own.max())
    if shown["nothing"] is not None:
        assert (shown["lines"], shown["faces"]) == ([], [])
        return
    rest = Wanted(None, None, groups, confidence, detail).of(scene)
    assert shown["faces"] == [face.id for _, face in rest.faces]
    kept = {ends.tobytes() for row in range(len(rest.lines)) for ends in rest.lines.segments_of(row)}
    of_page = zip(solved.session.lines.ids, solved.session.lines.graph.segments.ends, strict=True)
    assert shown["lines"] == [number for number, ends in of_page if ends.tobytes() in kept]
    assert list(rest.notes) == [*scene.notes, *shown["notes"]]


def test_a_threshold_that_leaves_nothing_is_told(solved):
    assert "choose a smaller confidence" in solved.post("shown", confidence=1.0).json()["nothing"]
    answer = solved.get("export/dxf", params={"wanted": json.dumps({"confidence": 1.0})})
    assert answer.status_code == 422
    assert "choose a smaller --confidence" in answer.json()["error"]


def test_a_place_where_nothing_stands_is_told(solved):
    assert "no line and no face stands at" in solved.post("shown", main=[1e6, 1e6], groups="main").json()["nothing"]


def test_without_a_model_nothing_is_shown(page):
    answer = page.post("shown")
    assert answer.status_code == 422
    assert "solve first" in answer.json()["error"]


def test_nothing_given_is_everything():
    assert read_wanted(Node({})) == read_wanted(Node(dict.fromkeys(GIVEN))) == Wanted()


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        ({"confidence": 1.5}, "at most 1"),
        ({"confidence": -0.1}, "from 0 to 1"),
        ({"confidence": True}, "a number"),
        ({"groups": "some"}, "one of main, all"),
        ({"detail": "much"}, "one of none, openings, all"),
        ({"main": [1]}, "list of 2"),
        ([], "expected an object"),
    ],
)
def test_what_is_no_choice_is_refused(solved, wanted, words):
    with pytest.raises(JsonError, match=words):
        read_wanted(Node(wanted))
    for text in (json.dumps(wanted), "{", "NaN"):
        assert solved.get("export/dxf", params={"wanted": text}).status_code == 422
