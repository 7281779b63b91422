"""The record survives whatever happens to it, and what it says leads nowhere else."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.batch.job import STATUSES, Figures, Outcome
from linecad.batch.record import NAME, Record, Row, options_hash, parse_row, row_line, settled
from linecad.convert import Conversion
from linecad.errors import InputError, OutputError
from linecad.model.wanted import Wanted
from linecad.options import Options
from linecad.scene import QUALITIES
from solver.options import SolveOptions

FIGURES = Figures(20, 30, 25, 4, 5, None, "optimal", ("a note",), "doubtful")


def row(name="facade", **changes):
    outcome = Outcome("done", "", 2.5, 1.25, 260.0, FIGURES, {f"{name}.json": 10, f"thumbnails/{name}.jpg": 20})
    return Row(**{"photo": f"/p/{name}.jpg", "sha256": "0" * 64, "options": "f" * 64, "name": name, "outcome": outcome,
                  "finished": "2026-11-21T12:00:00+00:00", **changes})  # fmt: skip


whole = st.integers(0, 2**40)
seconds = st.floats(0, 1e6).map(lambda number: round(number, 1))
words = st.text(max_size=20)
plain = st.from_regex(r"[\w(][\w .()-]{0,20}", fullmatch=True)
some_figures = st.builds(
    Figures, whole, whole, whole, whole, whole, st.none() | st.floats(0, 1e9), words, st.lists(words).map(tuple),
    st.none() | st.sampled_from(QUALITIES),
)  # fmt: skip
outcomes = st.builds(
    Outcome, st.sampled_from(STATUSES), words, seconds, seconds, seconds, st.none() | some_figures,
    st.dictionaries(plain | plain.map("thumbnails/{}".format), whole, max_size=3),
)  # fmt: skip


@given(st.builds(Row, words, words, words, plain, outcomes, words, words))
def test_a_row_reads_back_as_it_was(given_row):
    line = row_line(given_row)
    assert line.count(b"\n") == 1
    assert line.isascii()
    assert parse_row(line) == given_row


def test_a_row_of_before_tells_nothing_of_the_camera_and_had_no_map():
    document = json.loads(row_line(row()))
    del document["camera"], document["depth"]
    found = parse_row(json.dumps(document).encode())
    assert found.outcome.figures.camera is None
    assert found.depth == ""


def test_rows_are_read_back_in_their_order(tmp_path):
    with Record(tmp_path / NAME) as record:
        assert record.rows == []
        record.add(row("a"))
        record.add(row("b"))
    with Record(tmp_path / NAME) as record:
        assert [each.name for each in record.rows] == ["a", "b"]
        assert record.damaged == 0


@pytest.mark.parametrize("lost", [1, 2, 50, 400])
def test_a_line_that_was_cut_off_counts_for_nothing_and_harms_no_other(tmp_path, lost):
    path = tmp_path / NAME
    with Record(path) as record:
        record.add(row("a"))
        record.add(row("b"))
    path.write_bytes(path.read_bytes()[:-lost])
    with Record(path) as record:
        # Without its line break alone the row is whole.
        assert [each.name for each in record.rows] == (["a", "b"] if lost == 1 else ["a"])
        record.add(row("c"))
    with Record(path) as record:
        assert [each.name for each in record.rows][-1] == "c"
        assert len(record.rows) == (3 if lost == 1 else 2)
        assert record.damaged == (0 if lost == 1 else 1)


@given(st.binary(max_size=300))
def test_any_bytes_are_a_row_or_none(data):
    found = parse_row(data)
    assert found is None or parse_row(row_line(found)) == found


HOSTILE = [math.nan, math.inf, -1, 1e308, 2**70, None, "x", [], {}, True, [["a"]]]


@pytest.mark.parametrize("key", list(json.loads(row_line(row()))))
def test_a_row_with_a_hostile_value_is_none_or_harmless(key):
    for value in HOSTILE:
        document = {**json.loads(row_line(row())), key: value}
        found = parse_row(json.dumps(document).encode())
        if found is not None:
            assert parse_row(row_line(found)) is not None
    document = json.loads(row_line(row()))
    del document[key]
    assert parse_row(json.dumps(document).encode()) is None or key in ("gap", "lines", "camera", "depth")


@pytest.mark.parametrize("name", ["", ".", "..", "../up", "/etc/passwd", "a/b", "a\\b", ".hidden", "a\0b"])
def test_a_name_that_leads_out_of_the_folder_is_no_row(name):
    document = {**json.loads(row_line(row())), "name": name}
    assert parse_row(json.dumps(document).encode()) is None


@pytest.mark.parametrize("file", ["/etc/passwd", "../up.json", "a/../../b", "a/b/c", "", "x\\..\\y", "thumbnails/../x"])
def test_a_file_that_lies_elsewhere_is_no_row(file):
    document = {**json.loads(row_line(row())), "files": {file: 5}}
    assert parse_row(json.dumps(document).encode()) is None


def test_a_row_is_settled_while_its_files_are_as_large_as_they_were(tmp_path):
    (tmp_path / "thumbnails").mkdir()
    (tmp_path / "facade.json").write_bytes(b"0123456789")
    assert not settled(row(), tmp_path)
    (tmp_path / "thumbnails" / "facade.jpg").write_bytes(bytes(20))
    assert settled(row(), tmp_path)
    (tmp_path / "facade.json").write_bytes(b"012345678")
    assert not settled(row(), tmp_path)


def test_a_photo_that_failed_is_never_settled(tmp_path):
    assert not settled(row(outcome=Outcome("failed", "too few lines")), tmp_path)


def test_options_hash_changes_with_everything_that_decides(tmp_path):
    camera, other = tmp_path / "a.json", tmp_path / "b.json"
    camera.write_text("1")
    other.write_text("2")
    cases = [
        options_hash(Conversion(), (".json",)),
        options_hash(Conversion(), (".json", ".png")),
        options_hash(Conversion(focal=500.0), (".json",)),
        options_hash(Conversion(wanted=Wanted(confidence=0.5)), (".json",)),
        options_hash(Conversion(wanted=Wanted(detail="none")), (".json",)),
        options_hash(Conversion(camera=camera), (".json",)),
        options_hash(Conversion(camera=other), (".json",)),
        options_hash(Conversion(depth=camera), (".json",)),
        options_hash(Conversion(depth=other), (".json",)),
        options_hash(Conversion(depth=camera, options=Options(depth_kind="z")), (".json",)),
        options_hash(Conversion(options=Options(extension=31.0)), (".json",)),
        options_hash(Conversion(options=Options(solve=SolveOptions(seed=1))), (".json",)),
        options_hash(Conversion(options=Options(solve=SolveOptions(without=frozenset({"cycles"})))), (".json",)),
    ]
    assert len(set(cases)) == len(cases)


def test_options_hash_goes_by_the_content_of_the_camera_file_and_not_by_the_order_of_formats(tmp_path):
    camera, copy = tmp_path / "a.json", tmp_path / "b.json"
    camera.write_text("1")
    copy.write_text("1")
    first = options_hash(Conversion(camera=camera), (".json", ".png"))
    assert first == options_hash(Conversion(camera=copy), (".png", ".json"))


def test_options_of_a_camera_file_that_is_gone(tmp_path):
    with pytest.raises(InputError, match="check the name"):
        options_hash(Conversion(camera=tmp_path / "gone.json"), (".json",))


def test_a_record_that_is_a_folder_or_a_link(tmp_path):
    (tmp_path / NAME).mkdir()
    with pytest.raises(OutputError, match="is not a file"):
        Record(tmp_path / NAME)
    link = tmp_path / "link.jsonl"
    link.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(OutputError, match="choose another folder"):
        Record(link)
    assert not (tmp_path / "elsewhere").exists()


def test_a_line_longer_than_any_of_ours_is_skipped_in_pieces(tmp_path):
    with (tmp_path / NAME).open("wb") as file:
        file.write(b'{"photo": "' + b"x" * (3 * 2**20) + b'"}\n')
        file.write(row_line(row("a")))
    with Record(tmp_path / NAME) as record:
        assert [each.name for each in record.rows] == ["a"]
        assert record.damaged >= 1
