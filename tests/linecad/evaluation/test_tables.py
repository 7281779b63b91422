"""Results of several photos as tables, JSON and Markdown."""

import json

import pytest

from linecad.evaluation.bootstrap import Estimate, exact
from linecad.evaluation.calibration import ConfidenceScore, Tenth
from linecad.evaluation.decisions import Decisions, GraphStatistics
from linecad.evaluation.depth import DepthScore
from linecad.evaluation.document import markdown, shown, write_json, write_markdown
from linecad.evaluation.draughting.faces import FaceCounts
from linecad.evaluation.draughting.ground import GroundCounts
from linecad.evaluation.draughting.lines import LineCounts
from linecad.evaluation.drawing import DrawingScore
from linecad.evaluation.measure import PhotoResult, WholeResult
from linecad.evaluation.methods import BASELINE, Run, Settings
from linecad.evaluation.scopes import SceneScore, ScopeScore
from linecad.evaluation.tables import all_tables, calibration, depths, depths_by_photo, measures, table_1, table_2

SETTINGS = Settings(formulations=("paper",))
DRAWING = DrawingScore(
    0.5,
    None,
    GroundCounts(1, 2, 1),
    FaceCounts(9, 0, 1, 2, 4, 3, 1, 2, 5, 4),
    LineCounts(20, 0, 3, 6, 40, 7, 10),
    None,
    windows=None,
    all_windows=None,
)
ALL = DepthScore(10, 8, 0.3, 0.6, 0.375, 0.75, 1.0)
LARGEST = DepthScore(10, 5, 0.2, 0.4, 0.5, 1.0, 1.0)
NOTHING = DepthScore(10, 2, 0.0, 0.0, 0.0, 0.0, None)


def photo(name, real, fake, chosen_fake=0):
    decisions = Decisions(real, fake, real + 5, chosen_fake, 5, 50.0, 100.0)
    run = Run(decisions, 2.0, "optimal", 0.0)
    score = SceneScore(ScopeScore(ALL, None, None), ScopeScore(LARGEST, None, None), None)
    whole = WholeResult(20, 3, 1.0, "time limit", 0.1, decisions, 0.5, score, None, None, DRAWING)
    return PhotoResult(name, None, GraphStatistics(10, 20, 12, 6, 2), {"paper": {BASELINE: run, "B": run}}, whole)


PHOTOS = [photo("a", 9, 1), photo("b", 1, 1, 10)]
FAILED = PhotoResult("c", "the photo is black")


def row(table, name):
    return next(row for row in table.rows if row.name == name).cells


def test_mean_and_normalised_accuracy_are_the_papers():
    cells = row(table_1(PHOTOS, "paper"), "B")
    assert cells[0].value == pytest.approx(10 / 12)  # sum n_a / sum N_a
    assert cells[1].value == pytest.approx((9 / 10 + 1 / 2) / 2)  # mean n_a / N_a
    assert cells[2].value == pytest.approx(0.5)
    precision, recall, f1 = (cell.value for cell in cells[3:6])
    assert (precision, recall) == (pytest.approx(20 / 30), pytest.approx(20 / 30))
    assert f1 == pytest.approx(2 * precision * recall / (precision + recall))
    assert cells[6].value == 2
    assert cells[7].value == 1


def test_the_baseline_has_no_precision_and_a_method_that_did_not_run_no_figures():
    assert row(table_1(PHOTOS, "paper"), BASELINE)[3:6] == (None, None, None)
    assert row(table_1(PHOTOS, "paper"), BASELINE)[0] is not None
    assert set(row(table_1(PHOTOS, "paper"), "B+C+P")) == {None}


def test_statistics_are_means_per_photo():
    table = table_2(PHOTOS)
    assert [cells.cells[0].value for cells in table.rows] == [10, 20, 12, 6, 2]
    assert "2 labelled photos" in table.note


def test_measures_that_no_photo_has_are_no_rows():
    names = {row.name: row for row in measures([each.whole for each in PHOTOS]).rows}
    assert names["proven optimal"].cells[0].value == 0
    assert not [name for name in names if "planes:" in name or "marked" in name]


def test_both_scopes_have_the_same_measures():
    table = depths([each.whole.depth for each in PHOTOS])
    assert [column.name for column in table.columns] == ["everything", "component 0"]
    found = {each.name: tuple(cell.value for cell in each.cells) for each in table.rows}
    assert found == {
        "lines: recall at 2 %": pytest.approx((0.3, 0.2)), "lines: recall at 5 %": pytest.approx((0.6, 0.4)),
        "lines: precision at 2 %": pytest.approx((0.375, 0.5)), "lines: precision at 5 %": pytest.approx((0.75, 1.0)),
    }  # fmt: skip


def test_faces_and_confidence_have_rows_where_they_are_known():
    confidence = ConfidenceScore(0.3, 0.4, 0.25, None)
    table = depths([SceneScore(ScopeScore(ALL, ALL, confidence), ScopeScore(LARGEST, NOTHING, confidence), None)])
    assert row(table, "lines and faces: recall at 5 %")[1].value == 0
    assert row(table, "lines and faces: precision at 5 %")[0].value == 0.75
    assert row(table, "lines and faces: precision at 5 %")[1] is None  # nothing tells a scale
    assert row(table, "area under recall over confidence")[0].value == 0.3
    assert row(table, "area under precision over recall")[0].value == 0.4
    assert row(table, "confidence 0.9: recall at 5 %")[0].value == 0.25
    assert "confidence 0.9: precision at 5 %" not in {each.name for each in table.rows}


def test_calibration_adds_the_points_of_all_photos():
    def score(*last):
        return SceneScore(ScopeScore(ALL, None, None), ScopeScore(LARGEST, None, None), (Tenth(0, 0.0, 0),) * 9 + last)

    table = calibration([score(Tenth(10, 9.5, 9)), score(Tenth(30, 28.5, 21)), PHOTOS[0].whole.depth])
    assert [each.name for each in table.rows][8:] == ["0.8 to 0.9", "0.9 to 1.0"]
    points, stated, right = row(table, "0.9 to 1.0")
    assert (points.value, stated.value, right.value) == (40, pytest.approx(0.95), pytest.approx(0.75))
    assert right.low < 0.75 < right.high
    assert row(table, "0.8 to 0.9")[1:] == (None, None)


def test_each_photo_has_its_own_row_of_depths():
    table = depths_by_photo({each.name: each.whole.depth for each in PHOTOS})
    assert [each.name for each in table.rows] == ["a", "b"]
    assert [cell and cell.value for cell in row(table, "a")] == [0.6, 0.75, None, None, 0.4, 1.0]
    assert [column.name for column in table.columns][4:] == ["component 0: recall", "component 0: precision"]


def test_photos_that_failed_are_in_no_table_and_named():
    tables = all_tables([*PHOTOS, FAILED], SETTINGS)
    assert tables == all_tables(PHOTOS, SETTINGS)
    text = markdown("street", [*PHOTOS, FAILED], tables)
    assert "2 photos measured" in text
    assert "c failed: the photo is black" in text


def test_markdown_has_as_many_cells_in_each_row_of_a_table():
    text = markdown("street", PHOTOS, all_tables(PHOTOS, SETTINGS))
    assert text.startswith("# street\n")
    for part in text.split("\n\n"):
        rows = [line for line in part.splitlines() if line.startswith("|")]
        assert len({line.count("|") for line in rows}) <= 1
    assert "| B | 83.3 (" in text
    assert "| B+C+P | - |" in text
    assert "| rotation error | 0.50 degrees |" in text
    assert "| lines: recall at 5 % | 60.0 % | 40.0 % |" in text


def test_files_say_the_same_each_time(tmp_path):
    tables = all_tables([*PHOTOS, FAILED], SETTINGS)
    for name in ("a", "b"):
        write_json(tmp_path / f"{name}.json", "street", SETTINGS, [*PHOTOS, FAILED], tables)
        write_markdown(tmp_path / f"{name}.md", "street", PHOTOS, tables)
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()
    assert (tmp_path / "a.md").read_bytes() == (tmp_path / "b.md").read_bytes()
    document = json.loads((tmp_path / "a.json").read_text())
    assert (document["format"], document["version"], document["dataset"]) == ("linecad-evaluation", 1, "street")
    assert document["settings"]["reconstruction"]["solve"]["formulation"] == "gain"
    assert [each["name"] for each in document["photos"]] == ["a", "b", "c"]
    assert document["photos"][0]["methods"]["paper"]["B"]["decisions"]["tree_real"] == 9
    assert document["tables"][0]["rows"][1]["cells"][0]["value"] == pytest.approx(10 / 12)


@pytest.mark.parametrize(
    ("cell", "unit", "text"),
    [
        (Estimate(0.8321, 0.8, 0.85, 5), "%", "83.2 (80.0 to 85.0)"),
        (Estimate(3.14159, 2, 4, 5), "s", "3.14 (2.00 to 4.00)"),
        (Estimate(867.22, 800.4, 901, 5), "", "867 (800 to 901)"),
        (None, "%", "-"),
        (exact(0.5), "%", "50.0"),
        (exact(12.0), "", "12"),
        (exact(12.5), "", "12.50"),
    ],
)
def test_figures_are_shown_with_their_interval(cell, unit, text):
    assert shown(cell, unit) == text
