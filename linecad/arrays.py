"""Arrays: the names of their types, the checks that make them read-only and of one shape in records, and a search."""

from collections.abc import Iterable
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Bool = NDArray[np.bool_]
Text = NDArray[np.str_]

Record = TypeVar("Record")


def freeze(record: object, name: str, kind: Any, shape: tuple[int | None, ...]) -> None:
    """Store field `name` of a frozen record as a read-only array of dtype `kind`; None in `shape` is any length."""
    array: NDArray[Any] = np.array(getattr(record, name), dtype=kind)
    if array.size == 0 and len(array.shape) != len(shape):
        array = array.reshape([0 if length is None else length for length in shape])
    fits = array.ndim == len(shape) and all(
        want is None or have == want for have, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        wanted = "x".join("any" if length is None else str(length) for length in shape)
        found = "x".join(map(str, array.shape)) or "scalar"
        raise ValueError(f"{type(record).__name__}.{name} has shape {found}, expected {wanted}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        raise ValueError(f"{type(record).__name__}.{name} holds a number that is not finite")
    array.flags.writeable = False
    object.__setattr__(record, name, array)


def true_places(table: Bool) -> tuple[Int, Int]:
    """Row and column (P,) of what is true in a table (R, C), row by row."""
    # Ten times as fast as np.nonzero where little is true: NumPy is at its best in one row of numbers.
    row, column = np.divmod(np.flatnonzero(table), max(1, table.shape[1]))
    return row, column


def check_lengths(record: object, length: int, names: Iterable[str]) -> None:
    """Raise ValueError unless the fields `names` have `length` entries each."""
    for name in names:
        found = len(getattr(record, name))
        if found != length:
            raise ValueError(f"{type(record).__name__}.{name} has {found} entries, expected {length}")


def check_not_negative(record: object, names: Iterable[str]) -> None:
    """Raise ValueError unless all numbers of the fields `names` are 0 or more."""
    for name in names:
        array = getattr(record, name)
        if len(array) and array.min() < 0:
            raise ValueError(f"{type(record).__name__}.{name} holds {array.min()}, expected 0 or more")


def check_words(record: object, name: str, words: tuple[str, ...]) -> None:
    """Raise ValueError unless the field `name` holds no other than these words."""
    strange = sorted(set(getattr(record, name).tolist()) - set(words))
    if strange:
        raise ValueError(f"{type(record).__name__}.{name} holds {strange}, expected {', '.join(words)}")


def check_unique(name: str, ids: list[int]) -> None:
    """Raise ValueError where an id stands twice."""
    seen: set[int] = set()
    for number in ids:
        if number in seen:
            raise ValueError(f"{name}: the id {number} stands twice")
        seen.add(number)


def read_only_rings(owner: str, rings: Iterable[Float]) -> tuple[Float, ...]:
    """Read-only copies of polygons (V, 3) of at least 3 points; a ValueError tells their `owner`."""
    frozen = tuple(np.array(ring, np.float64) for ring in rings)
    for ring in frozen:
        if ring.ndim != 2 or ring.shape[1] != 3 or len(ring) < 3:
            raise ValueError(f"{owner} has a ring of shape {ring.shape}, expected at least 3 points")
        if not np.isfinite(ring).all():
            raise ValueError(f"{owner} holds a number that is not finite")
        ring.flags.writeable = False
    return frozen


def rows_of(record: Record, chosen: Bool | Int) -> Record:
    """A frozen record of arrays and tuples with the entries of every field that a mask or an index array selects."""
    rows: Int = np.arange(len(chosen))[chosen] if chosen.dtype == np.bool_ else np.asarray(chosen, np.int64)
    of_record: Any = record
    found: Record = replace(
        of_record, **{each.name: _entries(getattr(record, each.name), rows) for each in fields(of_record)}
    )
    return found


def _entries(entries: Any, rows: Int) -> Any:
    if len(entries) == 0:  # of what a record does not tell there are none
        return entries
    return tuple(entries[row] for row in rows.tolist()) if isinstance(entries, tuple) else entries[rows]
