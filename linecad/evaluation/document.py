"""The results of an evaluation as JSON and as Markdown (docs/reference/evaluation.md)."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from linecad import __version__
from linecad.evaluation.bootstrap import Estimate
from linecad.evaluation.measure import PhotoResult
from linecad.evaluation.methods import Settings
from linecad.evaluation.table import Row, Table
from linecad.io.files import write_text_atomically

FORMAT, VERSION = "linecad-evaluation", 1
NOTHING = "-"
OUTPUTS = ("pictures", "turned")  # settings that change no figure


def write_json(
    path: Path, dataset: str, settings: Settings, results: Sequence[PhotoResult], tables: Sequence[Table]
) -> None:
    """Write everything that was measured; OutputError when the file cannot be written."""
    document: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "linecad": __version__,
        "dataset": dataset,
        "settings": {name: value for name, value in asdict(settings).items() if name not in OUTPUTS},
        "tables": [asdict(table) for table in tables],
        "photos": [result.document() for result in results],
    }
    # Families left out are a set.
    text = json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False, default=sorted) + "\n"
    write_text_atomically(path, text)


def write_markdown(path: Path, dataset: str, results: Sequence[PhotoResult], tables: Sequence[Table]) -> None:
    """Write the tables as Markdown; OutputError when the file cannot be written."""
    text = markdown(dataset, results, tables)
    write_text_atomically(path, text)


def markdown(dataset: str, results: Sequence[PhotoResult], tables: Sequence[Table]) -> str:
    """The tables as Markdown under what was measured, with the intervals in brackets."""
    return f"# {dataset}\n\n{summary(results)}\n\n{tables_as_markdown(tables)}"


def tables_as_markdown(tables: Sequence[Table]) -> str:
    """Tables as Markdown, each with its title, with the intervals in brackets."""
    parts = []
    for table in tables:
        heads = [f"{column.name}{' ' + column.unit if column.unit else ''}" for column in table.columns]
        lines = [
            f"## {table.title}",
            "",
            table.note,
            "",
            "| | " + " | ".join(heads) + " |",
            "| --- |" + " --- |" * len(heads),
        ]
        for row in table.rows:
            lines.append(f"| {row.name} | " + " | ".join(cells_of(table, row)) + " |")
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


def summary(results: Sequence[PhotoResult]) -> str:
    """One or more sentences on what was measured and what failed."""
    failed = [result for result in results if result.error is not None]
    text = f"{len(results) - len(failed)} photos measured; in brackets the 95 % interval of a bootstrap over photos."
    maps = sum(result.depth_map is not None for result in results)
    if maps:
        text += f" {maps} of them with a depth map, which table 1 does not use."
    for result in failed:
        text += f" {result.name} failed: {result.error}."
    return text


def cells_of(table: Table, row: Row) -> list[str]:
    """The cells of a row as text; the unit follows where it is the row's own."""
    if row.unit is None:
        return [shown(cell, column.unit) for cell, column in zip(row.cells, table.columns, strict=True)]
    return [f"{shown(cell, row.unit)} {row.unit}".rstrip() for cell in row.cells]


def shown(cell: Estimate | None, unit: str) -> str:
    """A figure with its interval, if that has a width; percentages with one digit, whole numbers with none."""
    if cell is None:
        return NOTHING
    exact = cell.low == cell.high
    if unit == "%":
        factor, digits = 100, 1
    else:
        factor, digits = 1, 0 if abs(cell.value) >= 100 or (exact and cell.value.is_integer()) else 2
    value, low, high = (f"{factor * each:.{digits}f}" for each in (cell.value, cell.low, cell.high))
    return value if exact else f"{value} ({low} to {high})"
