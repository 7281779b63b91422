"""What the plots show of their tables."""

import re

from linecad.evaluation.bootstrap import Estimate, exact
from linecad.evaluation.plots import LEFT, SIDE, TOP, draw_bars, draw_calibration
from linecad.evaluation.table import Column, Row, Table

COLUMNS = (Column("points", ""), Column("stated", "%"), Column("right", "%"))


def test_a_probability_that_holds_is_on_the_diagonal():
    table = Table(
        "Calibration", "", COLUMNS,
        (Row("0.2 to 0.3", (exact(40.0), exact(0.25), Estimate(0.25, 0.1, 0.5, 3))), Row("0.9 to 1.0", (None,) * 3)),
    )  # fmt: skip
    svg = draw_calibration(table)
    assert re.findall(r'circle cx="([\d.]+)" cy="([\d.]+)"', svg) == [
        (f"{LEFT + 0.25 * SIDE:.1f}", f"{TOP + 0.75 * SIDE:.1f}")
    ]
    assert f'y1="{TOP + 0.9 * SIDE:.1f}" y2="{TOP + 0.5 * SIDE:.1f}"' in svg
    assert "<title>0.2 to 0.3: 40 points</title>" in svg


def test_bars_are_those_of_one_column():
    table = Table("A & B", "", COLUMNS[1:], (Row("x", (exact(0.5), exact(1.0))), Row("y", (None, exact(0.1)))))
    assert draw_bars(table, 0).count("<rect") == 1
    assert draw_bars(table, 1).count("<rect") == 2
    assert "<figcaption>right</figcaption>" in draw_bars(table, 1)
    assert "A &amp; B" in draw_bars(table, 0)
