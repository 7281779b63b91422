"""The lines of a photo in a table, in which one that an anchor names is looked up again by its geometry."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from linecad.arrays import Float, Int
from linecad.corrections.edits import Anchor
from linecad.directions import axis_name
from linecad.errors import CorrectionError
from linecad.geometry import PhotoLength, segment_coordinates

ACROSS = PhotoLength(6.0, floor=2.5)  # between a line as it was named and as it is found again
LEAST_OVERLAP = 0.5  # of the shorter of the two
SAME_LINE = 0.5  # px between the ends of two lines that are one


@dataclass(eq=False)
class LineTable:
    """N lines as arrays."""

    ids: Int  # (N,) stable numbers
    ends: Float  # (N, 2, 2) px
    axis: Int  # (N,)
    exact: dict[tuple[int, bytes], int] = field(init=False)  # id by axis and ends, to the last digit

    def __post_init__(self) -> None:
        lines = zip(self.ids.tolist(), self.axis.tolist(), self.ends, strict=True)
        self.exact = {(axis, ends.tobytes()): number for number, axis, ends in lines}

    def find(self, anchor: Anchor, width: int, any_axis: bool = False) -> int:
        """The id of the line that an anchor names in a photo of `width` px; CorrectionError when there is none.

        The line itself if it is there to the last digit; else the one that runs along it best. With `any_axis`, a line
        of another axis is taken where none has that of the anchor.
        """
        ends = np.array(anchor.ends)
        exact = self.exact.get((anchor.axis, ends.tobytes()))
        if exact is not None:
            return exact
        share = shared(ends, self.ends, ACROSS.px(width))
        own = np.where(self.axis == anchor.axis, share, 0.0)
        if any_axis and not own.any():
            own = share
        if not own.any():
            (a, b), (c, d) = anchor.ends
            raise CorrectionError(
                f"no line runs from ({a:.0f}, {b:.0f}) to ({c:.0f}, {d:.0f}) along {axis_name(anchor.axis)} any more"
            )
        return int(self.ids[own.argmax()])

    def find_all(self, anchors: Sequence[Anchor], width: int) -> tuple[int, ...]:
        """The ids of the lines that anchors name, of those that are there."""
        found = []
        for anchor in anchors:
            with contextlib.suppress(CorrectionError):
                found.append(self.find(anchor, width))
        return tuple(dict.fromkeys(found))

    def has(self, ends: Float, axis: int) -> bool:
        """Whether a line of this axis has these ends (2, 2), in either order."""
        off = np.minimum(*(np.abs(self.ends - one).max(axis=(1, 2)) for one in (ends, ends[::-1])))
        return bool(((off < SAME_LINE) & (self.axis == axis)).any())


def shared(ends: Float, others: Float, across: float) -> Float:
    """(N,) the stretch that a segment (2, 2) and others (N, 2, 2) have in common over all that either covers.

    0 where the ends of one are further than `across` from the line of the other, or they share less than LEAST_OVERLAP
    of the shorter one.
    """
    if len(others) == 0:
        return np.zeros(0)
    reach, beside = segment_coordinates(ends, others[:, None])  # (N, 2)
    beside_own = segment_coordinates(others, ends)[1]
    # The longer one tells its direction better.
    off = np.minimum(np.abs(beside).max(axis=1), np.abs(beside_own).max(axis=1))
    length = np.linalg.norm(others[:, 1] - others[:, 0], axis=1)
    low, high = reach.min(axis=1), reach.max(axis=1)
    common = np.minimum(high, length) - np.maximum(low, 0)
    enough = (off <= across) & (common >= LEAST_OVERLAP * np.minimum(length, high - low))
    share: Float = np.where(enough, common / (np.maximum(high, length) - np.minimum(low, 0)), 0.0)
    return share
