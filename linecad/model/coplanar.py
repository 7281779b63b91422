"""Planes of different components that the places of bodies made nearly one, made one exactly.

Crossings connect the pieces of a wall within a component, and there its planes are merged with what the noise allows
(`linecad.model.plane_merging`). Components stand to each other as bodies were placed, and walls that became one by that
are some tenths of a percent apart: two planes in the file, and two faces. A component has one scale, so it can meet one
plane of another exactly; all its lines move along their rays by as little.
"""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from linecad.arrays import Float, Int
from linecad.directions import MAIN
from linecad.model.lifting import Lifted

SAME = 0.006  # log offset within which planes of placed components are one
LEAST_LINES = 3  # of a plane


@dataclass(frozen=True, eq=False)
class _Piece:
    """The lines of one plane in one component."""

    component: int
    axis: int  # the normal
    number: int  # of the plane
    log_offset: float
    side: float  # of the camera, 1 or -1
    lines: int


def join_planes(lifted: Lifted, component: Int, axis: Int) -> Lifted:
    """The lines of placed components with the planes in common that they nearly have.

    `component` (N,) is -1 for lines of none, `axis` (N,) that of each line. The planes with the most lines are joined
    first; no component moves by more than SAME, the first of those that are joined not at all.
    """
    log_scale, shared = _joined(lifted.offset, lifted.shared, component, axis)
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


def _joined(offset: Float, shared: Int, component: Int, axis: Int) -> tuple[Float, Int]:
    """By which log each of the C components moves, and the numbers (N, K) with one for planes that became one."""
    pieces = _pieces(offset, shared, component, axis)
    count = int(component.max(initial=-1)) + 1
    group, moved = np.arange(count), np.zeros(count)
    alike = [
        (one, other) for one, other in combinations(pieces, 2)
        if one.component != other.component and (one.axis, one.side) == (other.axis, other.side)
        and abs(one.log_offset - other.log_offset) <= SAME
    ]  # fmt: skip
    alike.sort(key=lambda pair: -min(pair[0].lines, pair[1].lines))
    new = shared.copy()
    for one, other in alike:
        first, second = sorted([one, other], key=lambda piece: group[piece.component])
        lead, follower = group[first.component], group[second.component]
        if lead == follower:
            continue
        by = first.log_offset + moved[first.component] - second.log_offset - moved[second.component]
        after = np.where(group == follower, moved + by, moved)
        if np.abs(after).max() > SAME:
            continue
        moved, group = after, np.where(group == follower, lead, group)
        of_second = (component == second.component) & (shared[:, second.axis] == second.number)
        own = (component == first.component) & (shared[:, first.axis] == first.number)
        new[of_second, second.axis] = new[own, first.axis][0]  # that may have followed another itself
    return moved, new


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
