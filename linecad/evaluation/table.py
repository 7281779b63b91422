"""Figures with their intervals in rows and columns, before anything says how they look."""

from dataclasses import dataclass

from linecad.evaluation.bootstrap import Estimate


@dataclass(frozen=True)
class Column:
    """A column of figures."""

    name: str
    unit: str  # "%": a share from 0 to 1, shown as a percentage; else a unit, or nothing


@dataclass(frozen=True)
class Row:
    """A row; a cell is None where nothing is known."""

    name: str
    cells: tuple[Estimate | None, ...]
    unit: str | None = None  # of this row's cells, where it is not the column's


@dataclass(frozen=True)
class Table:
    """Figures with their intervals."""

    title: str
    note: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
