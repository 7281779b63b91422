"""The corrections file: it reads back as it was written, and whatever is wrong in it is told in one line."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.corrections.edits import (
    LABELS,
    OPENING_WORDS,
    SHOWN,
    Anchor,
    Corrections,
    Cut,
    Delete,
    Draw,
    FaceAnchor,
    Foot,
    Join,
    KnownDistance,
    KnownLength,
    LabelCrossing,
    Many,
    Meet,
    NameGroup,
    NoWindow,
    OnePlane,
    Place,
    PlaceAt,
    Region,
    SetAxis,
    SetEnds,
    SetFrame,
    Split,
    WallAnchor,
    WallByEdges,
    Window,
    Withdraw,
)
from linecad.corrections.file import (
    LARGEST_FILE,
    MOST_EDITS,
    check_belongs,
    corrections_from_json,
    corrections_to_json,
    read_corrections,
    write_corrections,
)
from linecad.errors import CorrectionsFileError, OutputError

numbers = st.floats(-1e6, 1e6, allow_nan=False)
points = st.tuples(numbers, numbers)
segments = st.tuples(points, points).filter(lambda p: abs(p[0][0] - p[1][0]) + abs(p[0][1] - p[1][1]) > 0.01)
anchors = st.builds(Anchor, segments, st.integers(0, 2))
pairs = st.tuples(anchors, anchors)
# Corners around a place, in the order of their angles: such a polygon does not cross itself.
polygons = st.builds(
    lambda place, reach: tuple(
        (place[0] + r * np.cos(2 * np.pi * n / len(reach)), place[1] + r * np.sin(2 * np.pi * n / len(reach)))
        for n, r in enumerate(reach)
    ),
    points,
    st.lists(st.floats(1, 1e4), min_size=3, max_size=8),
)
walls = st.builds(WallAnchor, st.sampled_from([0, 1, 3, 4]), st.none() | anchors)
face_edits = st.one_of(
    st.builds(Region, polygons, st.sampled_from(SHOWN)),
    st.builds(Window, walls, segments, st.sampled_from(OPENING_WORDS), st.integers(1, 9), st.integers(1, 9), points),
    st.builds(Window, walls, segments),
    st.builds(NoWindow, points),
    st.builds(WallByEdges, st.tuples(anchors, anchors, anchors, anchors)),
)
names = st.text(st.characters(categories=["L", "N", "P"]), min_size=1, max_size=60)
facts = st.one_of(
    st.builds(Meet, pairs),
    st.builds(OnePlane, pairs, st.integers(0, 6)),
    st.builds(Foot, anchors, points),
    st.builds(Cut, pairs),
    st.builds(PlaceAt, anchors, anchors, st.floats(-5, 5)),
    st.builds(PlaceAt, anchors, anchors, st.floats(-5, 5), st.lists(anchors, min_size=1, max_size=5).map(tuple)),
)
places = st.builds(Place, points, anchors | st.builds(FaceAnchor, points, st.integers(0, 6)))
parts = st.one_of(
    st.builds(LabelCrossing, pairs, points, st.sampled_from([*LABELS, None])),
    st.builds(SetAxis, anchors, st.integers(0, 2)),
    st.builds(Delete, anchors),
)
edits = st.one_of(
    parts,
    facts,
    face_edits,
    st.builds(Withdraw, facts),
    st.builds(Many, st.lists(parts, min_size=1, max_size=4).map(tuple)),
    st.builds(SetEnds, anchors, segments),
    st.builds(Split, anchors, points),
    st.builds(Join, pairs),
    st.builds(Draw, anchors),
    st.builds(KnownLength, anchors, st.none() | st.floats(1e-6, 1e6)),
    st.builds(KnownDistance, st.tuples(places, places), st.none() | st.floats(1e-6, 1e6)),
    st.builds(NameGroup, anchors, st.none() | names),
    st.builds(SetFrame, st.lists(anchors, min_size=1, max_size=4).map(tuple)),
)
lists = st.lists(edits, max_size=6).map(tuple)
corrections = st.builds(Corrections, st.text(max_size=20), st.integers(1, 10**6), st.integers(1, 10**6), lists, lists)

LINE = {"segment": [[10.0, 20.0], [110.0, 25.0]], "axis": "x"}
FILE = {"format": "linecad-corrections", "version": 1, "photo": "a.jpg", "width": 640, "height": 480, "edits": []}


def with_edit(**edit):
    return {**FILE, "edits": [edit]}


@given(corrections)
@settings(max_examples=40)
def test_what_is_written_reads_back_as_the_same(corrections):
    assert corrections_from_json(corrections_to_json(corrections)) == corrections


def test_a_file_reads_back_as_the_same(tmp_path):
    corrections = Corrections("a.jpg", 640, 480, (Delete(Anchor(((1.5, 2.0), (3.0, 40.0)), 2)),))
    write_corrections(corrections, tmp_path / "a.corrections.json")
    assert read_corrections(tmp_path / "a.corrections.json") == corrections


def test_what_was_undone_may_be_missing():
    assert corrections_from_json(json.dumps(FILE)) == Corrections("a.jpg", 640, 480)


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({**FILE, "format": "linecad-scene"}, 'format is "linecad-scene", expected "linecad-corrections"'),
        ({**FILE, "version": 2}, "only version 1 can be read"),
        ({**FILE, "width": 0}, "width is 0"),
        ({**FILE, "height": 10**7}, "height is 10000000"),
        ({key: value for key, value in FILE.items() if key != "edits"}, "edits is missing"),
        (with_edit(op="explode", line=LINE), r"edits\[0\].op is \"explode\""),
        (with_edit(op="axis", line=LINE, axis="w"), r"edits\[0\].axis is \"w\""),
        (
            with_edit(op="label", lines=[LINE], pixel=[1, 2], value="real"),
            r"lines is a list of 1, expected a list of 2",
        ),
        (with_edit(op="label", lines=[LINE, LINE], pixel=[1, 2], value="maybe"), "expected one of real, fake, unsure"),
        (with_edit(op="label", lines=[LINE, LINE], pixel=[1, 1e300], value="real"), "of at most 1e"),
        (with_edit(op="label", lines=[LINE, LINE], pixel=[1, 2, 3], value="real"), "expected a list of 2"),
        (with_edit(op="length", line=LINE, metres=0), "expected a length from 1e-06 to 1e.06 m"),
        (with_edit(op="length", line=LINE, metres=-1), "expected a length"),
        (with_edit(op="length", line=LINE, metres=1e9), "of at most 1e"),
        (with_edit(op="length", line=LINE, metres=True), "expected a number"),
        (with_edit(op="delete", line={**LINE, "segment": [[1, 1], [1, 1]]}), "expected two ends that differ"),
        (with_edit(op="delete", line=7), "expected an object"),
        (with_edit(op="frame", lines=[]), "expected a list of 1 to 100"),
        (with_edit(op="meet", lines=[LINE] * 3), "expected a list of 2"),
        (with_edit(op="plane", lines=[LINE] * 2, normal="up"), 'normal is "up", expected one of x, y, z'),
        (with_edit(op="foot", line=LINE), "pixel is missing"),
        (with_edit(op="place", line=LINE, to=LINE, log_ratio=5.1), "log_ratio is 5.1, expected a finite number of at"),
        (with_edit(op="withdraw", fact={"op": "delete", "line": LINE}), 'fact.op is "delete", expected one of meet'),
        (with_edit(op="frame", lines=[LINE] * 101), "expected a list of 1 to 100"),
        (with_edit(op="ends", line=LINE, ends=[[1, 1], [1, 1]]), "expected two ends that differ"),
        (with_edit(op="many", edits=[]), "expected a list of 1 to 100000"),
        (with_edit(op="many", edits=7), r"edits\[0\].edits is 7, expected a list"),
        (with_edit(op="many", edits=[{"op": "length"}]), r"edits\[0\].edits\[0\].op is \"length\""),
        (with_edit(op="many", edits=[{"op": "many", "edits": []}]), "expected one of label, axis, delete"),
        ([FILE], "expected an object"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(document, message):
    with pytest.raises(CorrectionsFileError, match=message) as refused:
        corrections_from_json(json.dumps(document))
    assert "\n" not in str(refused.value)
    assert str(refused.value).endswith("see docs/reference/corrections.md")


@pytest.mark.parametrize("token", ["NaN", "Infinity", "-Infinity", "1e999", "9" * 5000])
def test_numbers_that_are_none_are_refused(token):
    text = json.dumps(with_edit(op="split", line=LINE, at=["HERE", 1])).replace('"HERE"', token)
    with pytest.raises(CorrectionsFileError) as refused:
        corrections_from_json(text)
    assert len(str(refused.value)) < 300


def test_too_many_edits_are_refused_before_any_is_read():
    for edits in ([0] * (MOST_EDITS + 1), [0, {"op": "many", "edits": [0] * MOST_EDITS}]):  # none of them is an edit
        with pytest.raises(CorrectionsFileError, match=f"{MOST_EDITS + 1} edits, at most {MOST_EDITS}"):
            corrections_from_json(json.dumps({**FILE, "edits": edits}))


def test_a_file_that_is_too_large_is_not_read(tmp_path):
    path = tmp_path / "large.json"
    with path.open("wb") as file:
        file.truncate(LARGEST_FILE + 1)  # a hole: it takes no place on the disk
    with pytest.raises(CorrectionsFileError, match="larger than 64 MiB"):
        read_corrections(path)


@pytest.mark.parametrize(
    ("data", "message"), [(b"\xff\xfe{", "is not UTF-8"), (b"{", "not JSON"), (b"[" * 10**5, "deep")]
)
def test_a_file_of_other_bytes_is_refused_with_its_name(tmp_path, data, message):
    path = tmp_path / "strange.json"
    path.write_bytes(data)
    with pytest.raises(CorrectionsFileError, match=message) as refused:
        read_corrections(path)
    assert str(path) in str(refused.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(CorrectionsFileError, match=r"none\.json cannot be read"):
        read_corrections(tmp_path / "none.json")


def test_corrections_of_a_photo_of_another_size_are_refused():
    with pytest.raises(
        CorrectionsFileError, match=r"a\.json is for .* 640 x 480 px \(a\.jpg\), this one has 480 x 640"
    ):
        check_belongs(Corrections("a.jpg", 640, 480), "a.json", 480, 640)


def test_where_nothing_can_be_written_it_is_said(tmp_path):
    with pytest.raises(OutputError):
        write_corrections(Corrections("a.jpg", 1, 1), tmp_path / "none" / "a.json")


@pytest.mark.parametrize("text", ["", "  ", "two\nlines", "x" * 61])
def test_a_name_of_a_group_is_one_line_of_text(text):
    with pytest.raises(CorrectionsFileError, match="a name of 1 to 60 characters"):
        corrections_from_json(json.dumps(with_edit(op="name", line=LINE, text=text)))
