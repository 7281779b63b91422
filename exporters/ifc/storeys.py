"""Storeys of a building, as far as rows of windows tell them.

The photo shows no floors. A row of windows shows that there is one below its sills; so a storey begins at the lowest
sill of its rows. Rows of several walls that reach past each other are of one storey.
"""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from exporters.ifc.voids import Void

_FEWEST = 2  # windows of a row; a single one may be that of a stair
_SAME_HEIGHT = 1e-6  # m; sills of one row are equal but for rounding


@dataclass(frozen=True)
class Storey:
    """A storey from its lowest sill up to the next."""

    sill: float  # m, of the lowest row
    head: float  # m, of that row
    windows: int  # in its rows


def build_storeys(voids: Iterable[Void]) -> tuple[Storey, ...]:
    """The storeys that rows of at least two windows tell, from below; none where there is no such row."""
    rows: dict[tuple[int, int], list[Void]] = defaultdict(list)
    for void in voids:
        if void.fitting.kind == "window":
            rows[void.plane, round(void.low[2] / _SAME_HEIGHT)].append(void)
    lowest_first = sorted((row for row in rows.values() if len(row) >= _FEWEST), key=lambda row: row[0].low[2])
    made: list[Storey] = []
    for row in lowest_first:
        sill, head = float(row[0].low[2]), float(min(void.high[2] for void in row))
        if made and sill < made[-1].head:
            made[-1] = Storey(made[-1].sill, made[-1].head, made[-1].windows + len(row))
        else:
            made.append(Storey(sill, head, len(row)))
    return tuple(made)


def storey_of(storeys: tuple[Storey, ...], void: Void) -> int | None:
    """The number of the storey that the middle of an opening is in, the lowest for what is below; None without any."""
    middle = (void.low[2] + void.high[2]) / 2
    below = [number for number, storey in enumerate(storeys) if storey.sill <= middle]
    return below[-1] if below else 0 if storeys else None
