"""Planes of different components that the places of bodies made nearly one, made one exactly.

Crossings connect the pieces of a wall within a component, and there its planes are merged with what the noise allows
(`linecad.model.plane_merging`). Components stand to each other as bodies were placed, and walls that became one by that
are some tenths of a percent apart: two planes in the file, and two faces. A component has one scale, so it can meet one
plane of another exactly; all its lines move along their rays by as little.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from linecad.arrays import Float, Int
from linecad.directions import MAIN
from linecad.model.lifting import Lifted

SAME = 0.006  # log offset within which planes of placed components are one
TOLD = 0.03  # the same of planes that a person called one, which were placed with a tolerance
LEAST_LINES = 3  # of a plane

CommonPlane = tuple[int, int, int]  # two lines, and the normal of the plane that both lie in


@dataclass(frozen=True, eq=False)
class _Piece:
    """The lines of one plane in one component."""

    component: int
    axis: int  # the normal
    number: int  # of the plane
    log_offset: float
    side: float  # of the camera, 1 or -1
    lines: int


def join_planes(lifted: Lifted, component: Int, axis: Int, told: Sequence[CommonPlane] = ()) -> Lifted:
    """The lines of placed components with the planes in common that they nearly have.

    `component` (N,) is -1 for lines of none, `axis` (N,) that of each line. Planes of two lines that a person `told`
    are one come first, then those with the most lines. No component moves by more than TOLD for the former and SAME for
    the latter, the first of those that are joined not at all.
    """
    log_scale, shared = _joined(lifted.offset, lifted.shared, component, axis, told)
    scale = np.append(np.exp(log_scale), 1.0)[component]
    ends, offset = lifted.ends * scale[:, None, None], lifted.offset * scale[:, None]
    for normal in range(shared.shape[1]):
        changed = np.flatnonzero(shared[:, normal] != lifted.shared[:, normal])
        for number in np.unique(shared[changed, normal]).tolist():
            # The number is that of the component that leads, whose lines have the place already.
            lead = int(np.flatnonzero(lifted.shared[:, normal] == number)[0])
            follow = changed[shared[changed, normal] == number]
            offset[follow, normal] = offset[lead, normal]
            if normal < MAIN:
                ends[follow, :, normal] = offset[lead, normal]
    return replace(lifted, ends=ends, offset=offset, shared=shared)


def _joined(offset: Float, shared: Int, component: Int, axis: Int, told: Sequence[CommonPlane]) -> tuple[Float, Int]:
    """By which log each of the C components moves, and the numbers (N, K) with one for planes that became one."""
    pieces = _pieces(offset, shared, component, axis)
    alike = [
        (one, other) for one, other in combinations(pieces, 2)
        if one.component != other.component and (one.axis, one.side) == (other.axis, other.side)
        and abs(one.log_offset - other.log_offset) <= SAME
    ]  # fmt: skip
    alike.sort(key=lambda pair: -min(pair[0].lines, pair[1].lines))
    joining = _Joining(component, shared)
    for first, second, normal in told:
        one, other = (_piece(line, normal, offset, shared, component) for line in (first, second))
        if one is not None and other is not None and one.side == other.side:
            joining.join(one, other, TOLD)
    joining.settle()
    for one, other in alike:
        joining.join(one, other, SAME)
    return joining.moved, joining.shared


class _Joining:
    """Components that move as groups, so that planes of two become one."""

    def __init__(self, component: Int, shared: Int) -> None:
        count = int(component.max(initial=-1)) + 1
        self.component, self.shared, self.own = component, shared.copy(), shared
        self.group, self.moved, self.settled = np.arange(count), np.zeros(count), np.zeros(count)

    def settle(self) -> None:
        """From here on moves count anew."""
        self.settled = self.moved.copy()

    def join(self, one: _Piece, other: _Piece, most: float) -> None:
        """Make two planes of two groups one, unless a component had to move by more than `most`."""
        first, second = sorted([one, other], key=lambda piece: self.group[piece.component])
        lead, follower = self.group[first.component], self.group[second.component]
        if lead == follower:
            return
        by = first.log_offset + self.moved[first.component] - second.log_offset - self.moved[second.component]
        after = np.where(self.group == follower, self.moved + by, self.moved)
        if np.abs(after - self.settled).max() > most:
            return
        self.moved, self.group = after, np.where(self.group == follower, lead, self.group)
        of_second = (self.component == second.component) & (self.own[:, second.axis] == second.number)
        own = (self.component == first.component) & (self.own[:, first.axis] == first.number)
        self.shared[of_second, second.axis] = self.shared[own, first.axis][0]  # that may have followed another itself


def _piece(line: int, normal: int, offset: Float, shared: Int, component: Int) -> _Piece | None:
    """The plane of a normal that a line is in; None where it is in none, or in no component."""
    place, part, number = float(offset[line, normal]), int(component[line]), int(shared[line, normal])
    if part < 0 or number < 0 or not np.isfinite(place) or place == 0:
        return None
    return _Piece(part, normal, number, float(np.log(abs(place))), float(np.sign(place)), 1)


def _pieces(offset: Float, shared: Int, component: Int, axis: Int) -> list[_Piece]:
    found = []
    for normal in range(shared.shape[1]):
        own = np.flatnonzero((shared[:, normal] >= 0) & (component >= 0))
        for part, number in np.unique(np.column_stack([component[own], shared[own, normal]]), axis=0).tolist():
            lines = own[(component[own] == part) & (shared[own, normal] == number)]
            place = float(offset[lines[0], normal])
            if len(lines) >= LEAST_LINES and len(np.unique(axis[lines])) > 1 and place != 0:
                found.append(_Piece(part, normal, number, float(np.log(abs(place))), float(np.sign(place)), len(lines)))
    return found
