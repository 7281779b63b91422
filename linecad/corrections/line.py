"""One line that edits are applied to, and what it was before them."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float
from linecad.corrections.corrected import Origin
from linecad.line_graph import Segments


@dataclass
class Line:
    """A line as it is now."""

    ends: Float  # (2, 2) px
    axis: int
    origin: Origin
    before: "Line | None" = None  # as it was found or drawn, if it was changed since

    @property
    def as_found(self) -> "Line":
        """What it was before any edit."""
        return self.before or self

    def changed(self, ends: Float, axis: int | None = None, origin: Origin | None = None) -> "Line":
        """The line after an edit, or a piece of it."""
        return Line(ends, self.axis if axis is None else axis, origin or self.origin, self.as_found)


def segments_of(lines: Iterable[Line]) -> Segments:
    """The segments of lines."""
    own = list(lines)
    ends = np.array([line.ends for line in own]).reshape(-1, 2, 2)
    return Segments(ends, np.array([line.axis for line in own], np.int64))
