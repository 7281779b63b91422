"""The results as one page that needs nothing else: tables, plots, and the photos that went worst."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from linecad.evaluation.document import cells_of, summary
from linecad.evaluation.measure import PhotoResult, Picture, WholeResult
from linecad.evaluation.plots import draw_bars, draw_calibration
from linecad.evaluation.table import Table
from linecad.evaluation.tables import CALIBRATION
from linecad.io import html
from linecad.io.files import write_text_atomically

WORST = 10  # photos that are shown
STYLE = """\
body { margin: 2em auto; max-width: 62em; padding: 0 1em; }
table { border-collapse: collapse; margin: .8em 0; }
td, th { border: 1px solid #ccc; padding: .25em .6em; text-align: right; }
td:first-child, th:first-child { text-align: left; }
figure { margin: 1.5em 0; } svg { max-width: 100%; height: auto; }
"""
AXIS_COLOURS = ("#e6194b", "#3cb44b", "#4363d8")  # x, y, z
FAKE_TAKEN, REAL_MISSED = "#ff00ff", "#ffd700"


def write_report(path: Path, dataset: str, results: Sequence[PhotoResult], tables: Sequence[Table]) -> None:
    """Write the page; OutputError when the file cannot be written."""
    text = page(dataset, results, tables)
    write_text_atomically(path, text)


def page(dataset: str, results: Sequence[PhotoResult], tables: Sequence[Table]) -> str:
    """The whole page as HTML."""
    parts = [f"<h1>{escape(dataset)}</h1><p>{escape(summary(results))}</p>"]
    for table in tables:
        parts += [f"<h2>{escape(table.title)}</h2>", f'<p class="quiet">{escape(table.note)}</p>', _table(table)]
        if table.title == CALIBRATION:
            parts.append(draw_calibration(table))
        elif table.columns[0].unit == "%":
            parts.append(draw_bars(table, 0))
        else:
            shares = _shares(table)
            parts += [draw_bars(shares, column) for column in range(len(table.columns)) if shares.rows]
    chosen = worst(results)
    if chosen:
        parts.append(f"<h2>The worst {len(chosen)} photos</h2>")
        parts.append(
            '<p class="quiet">Segments by axis (x red, y green, z blue); crossings that were taken for real but are '
            "fake (magenta), and real ones that were given up (yellow).</p>"
        )
        parts += [_photo(result) for result in chosen]
    misplaced = worst_depths(results)
    if misplaced:
        parts.append(f"<h2>Found and true places, the worst {len(misplaced)} photos</h2>")
        parts.append(
            '<p class="quiet">Lines seen from where the camera was not: left as found, right the same lines at their '
            "true depth. Green: right within 5 % by the scale of component 0; red: wrong; grey: the true place is not "
            "known, left alone. The plan from above, and a parallel view, turned by 35 degrees and falling by 20. "
            "Blue: the camera and the borders of its view.</p>"
        )
        parts += [_places(result) for result in misplaced]
    return html.page(f"{dataset}: evaluation", STYLE, parts)


def badness(result: PhotoResult) -> float | None:
    """1 - F1 of the crossings where they have labels, else 1 - depth recall of all lines, else the rotation error."""
    whole = result.whole
    if whole is None:
        return None
    d = whole.decisions
    if d is not None and d.chosen_real + d.chosen_fake + d.missed_real:
        return 1 - 2 * d.chosen_real / (2 * d.chosen_real + d.chosen_fake + d.missed_real)
    if whole.depth is not None:
        return 1 - whole.depth.everything.lines.recall_5
    return whole.rotation_error


def worst(results: Sequence[PhotoResult]) -> list[PhotoResult]:
    """The photos with a picture that went worst, the worst first."""
    ranked = [(bad, index) for index, result in enumerate(results) if (bad := badness(result)) is not None]
    ranked.sort(key=lambda pair: (-pair[0], pair[1]))
    return [results[index] for _, index in ranked if results[index].picture is not None][:WORST]


def worst_depths(results: Sequence[PhotoResult]) -> list[PhotoResult]:
    """The photos with found and true places whose lines, all that are in the file, have the lowest recall of depth."""
    shown = [(each.whole.depth, each) for each in results if each.places and each.whole and each.whole.depth]
    return [result for _, result in sorted(shown, key=lambda pair: pair[0].everything.lines.recall_5)][:WORST]


def _table(table: Table) -> str:
    heads = "".join(f"<th>{escape(column.name)} {escape(column.unit)}</th>" for column in table.columns)
    lines = [f"<table><tr><th></th>{heads}</tr>"]
    for row in table.rows:
        cells = "".join(f"<td>{escape(cell)}</td>" for cell in cells_of(table, row))
        lines.append(f"<tr><td>{escape(row.name)}</td>{cells}</tr>")
    return "\n".join([*lines, "</table>"])


def _shares(table: Table) -> Table:
    """The rows of a table that are percentages."""
    return Table(table.title, table.note, table.columns, tuple(row for row in table.rows if row.unit == "%"))


def _photo(result: PhotoResult) -> str:
    assert result.picture is not None  # `worst` chose it
    assert result.whole is not None
    whole = result.whole
    facts = [f"{whole.lines} lines", f"{whole.planes} planes", f"{whole.status} in {whole.seconds:.1f} s"]
    if whole.decisions is not None:
        d = whole.decisions
        facts.append(f"{d.chosen_fake} fake crossings taken, {d.missed_real} real ones given up, {d.chosen_real} right")
    facts += _depths(whole)
    if whole.rotation_error is not None:
        facts.append(f"rotation error {whole.rotation_error:.2f} degrees")
    return (
        f"<figure>{_overlay(result.picture)}<figcaption><b>{escape(result.name)}</b>: {escape('; '.join(facts))}"
        "</figcaption></figure>"
    )


def _places(result: PhotoResult) -> str:
    assert result.whole is not None  # `worst_depths` chose it
    facts = escape("; ".join(_depths(result.whole)))
    return f"<figure>{result.places}<figcaption><b>{escape(result.name)}</b>: {facts}</figcaption></figure>"


def _depths(whole: WholeResult) -> list[str]:
    if whole.depth is None:
        return []
    scopes = (("everything", whole.depth.everything.lines), ("component 0", whole.depth.component_0.lines))
    return [f"{name} at 5 %: recall {score.recall_5:.0%}, precision {score.precision_5:.0%}" for name, score in scopes]


def _overlay(picture: Picture) -> str:
    lines = [
        f'<svg viewBox="0 0 {picture.width} {picture.height}" width="{picture.width}" role="img">',
        f'<image width="{picture.width}" height="{picture.height}" href="data:image/jpeg;base64,{picture.jpeg}"/>',
    ]
    for axis, colour in enumerate(AXIS_COLOURS):
        path = "".join(f"M{a} {b}L{c} {d}" for a, b, c, d, own in picture.lines if own == axis)
        lines.append(f'<path d="{path}" stroke="{colour}" stroke-width="1" fill="none"/>')
    for points, colour in ((picture.fake_taken, FAKE_TAKEN), (picture.real_missed, REAL_MISSED)):
        lines += [
            f'<circle cx="{x}" cy="{y}" r="3.5" fill="none" stroke="{colour}" stroke-width="1.5"/>' for x, y in points
        ]
    return "\n".join([*lines, "</svg>"])
