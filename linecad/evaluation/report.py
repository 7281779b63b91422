"""The results as one page that needs nothing else: tables, plots, and the photos that went worst."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from linecad.evaluation.bootstrap import Estimate
from linecad.evaluation.document import cells_of, summary
from linecad.evaluation.measure import PhotoResult, Picture
from linecad.evaluation.tables import Table
from linecad.io import html
from linecad.io.files import write_text_atomically

WORST = 10  # photos that are shown
BAR_WIDTH, BAR_HEIGHT, LABEL_WIDTH = 420, 18, 150  # px
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
        if table.columns[0].unit == "%":
            parts.append(_plot(table, 0))
        else:
            parts += [_plot(part, 0) for part in [_shares(table)] if part.rows]
    chosen = worst(results)
    if chosen:
        parts.append(f"<h2>The worst {len(chosen)} photos</h2>")
        parts.append(
            '<p class="quiet">Segments by axis (x red, y green, z blue); crossings that were taken for real but are '
            "fake (magenta), and real ones that were given up (yellow).</p>"
        )
        parts += [_photo(result) for result in chosen]
    return html.page(f"{dataset}: evaluation", STYLE, parts)


def badness(result: PhotoResult) -> float | None:
    """1 - F1 of the crossings where they have labels, else 1 - depth recall at 5 %, else the rotation error."""
    whole = result.whole
    if whole is None:
        return None
    d = whole.decisions
    if d is not None and d.chosen_real + d.chosen_fake + d.missed_real:
        return 1 - 2 * d.chosen_real / (2 * d.chosen_real + d.chosen_fake + d.missed_real)
    if whole.edges is not None:
        return 1 - whole.edges.recall_5
    return whole.rotation_error


def worst(results: Sequence[PhotoResult]) -> list[PhotoResult]:
    """The photos with a picture that went worst, the worst first."""
    ranked = [(bad, index) for index, result in enumerate(results) if (bad := badness(result)) is not None]
    ranked.sort(key=lambda pair: (-pair[0], pair[1]))
    return [results[index] for _, index in ranked if results[index].picture is not None][:WORST]


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


def _plot(table: Table, column: int) -> str:
    """Bars with intervals for one column of shares, as SVG."""
    width, height = LABEL_WIDTH * 2 + BAR_WIDTH, BAR_HEIGHT * (len(table.rows) + 1)
    lines = [
        f'<figure><svg viewBox="0 0 {width} {height}" width="{width}" role="img" font-size="12">',
        f"<title>{escape(table.title)}: {escape(table.columns[column].name)}</title>",
    ]
    left = 2 * LABEL_WIDTH - 50
    for tick in range(0, 101, 20):
        x = left + BAR_WIDTH * tick / 100
        lines.append(f'<line x1="{x}" x2="{x}" y1="0" y2="{height - BAR_HEIGHT}" stroke="#ddd"/>')
        lines.append(f'<text x="{x}" y="{height - 4}" text-anchor="middle" fill="#555">{tick} %</text>')
    for index, row in enumerate(table.rows):
        y = index * BAR_HEIGHT
        lines.append(f'<text x="{left - 6}" y="{y + 13}" text-anchor="end">{escape(row.name)}</text>')
        cell = row.cells[column]
        if cell is not None:
            lines += _bar(cell, left, y)
    return "\n".join([*lines, "</svg></figure>"])


def _bar(cell: Estimate, left: float, y: float) -> list[str]:
    length, low, high = (BAR_WIDTH * min(max(share, 0.0), 1.0) for share in (cell.value, cell.low, cell.high))
    middle = y + BAR_HEIGHT / 2
    return [
        f'<rect x="{left}" y="{y + 3}" width="{length:.1f}" height="{BAR_HEIGHT - 6}" fill="#7fa8d9"/>',
        f'<line x1="{left + low:.1f}" x2="{left + high:.1f}" y1="{middle}" y2="{middle}" stroke="#222" '
        'stroke-width="2"/>',
    ]


def _photo(result: PhotoResult) -> str:
    assert result.picture is not None  # `worst` chose it
    assert result.whole is not None
    whole = result.whole
    facts = [f"{whole.lines} lines", f"{whole.planes} planes", f"{whole.status} in {whole.seconds:.1f} s"]
    if whole.decisions is not None:
        d = whole.decisions
        facts.append(f"{d.chosen_fake} fake crossings taken, {d.missed_real} real ones given up, {d.chosen_real} right")
    if whole.edges is not None:
        facts.append(f"depth at 5 %: recall {whole.edges.recall_5:.0%}, precision {whole.edges.precision_5:.0%}")
    if whole.rotation_error is not None:
        facts.append(f"rotation error {whole.rotation_error:.2f} degrees")
    return (
        f"<figure>{_overlay(result.picture)}<figcaption><b>{escape(result.name)}</b>: {escape('; '.join(facts))}"
        "</figcaption></figure>"
    )


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
