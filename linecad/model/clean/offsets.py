"""Plane offsets that are one number: of lines that are one line, and of lines that meet but for a little.

An offset belongs to all lines of its plane. So where two become one all of them move together, none by more than the
share of its depth that is allowed, and the ends that lie on the plane go with it.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Float, Int
from linecad.model.clean.strokes import FREE, Strokes


@dataclass(frozen=True, eq=False)
class Offsets:
    """The C offsets with which cleaning began, and which of them are one by now."""

    axis: Int  # (C,)
    start: Float  # (C,) as they were
    weight: Float  # (C,) px of segments in the plane
    nearest: Float  # (C,) depth of the nearest line in the plane
    lead: Int  # (C,) number of the one that each is one with
    value: Float  # (C,) as they are

    @property
    def moved(self) -> Float:
        """(C,) by which share of the depth of its nearest line each has moved."""
        share: Float = np.abs(self.value - self.start) / self.nearest
        return share


def offsets_of(strokes: Strokes) -> Offsets:
    """The offsets that lines have."""
    line, normal = np.nonzero(strokes.number != FREE)
    number = strokes.number[line, normal]
    count = int(number.max(initial=-1)) + 1
    value, axis = np.zeros(count), np.zeros(count, np.int64)
    value[number], axis[number] = strokes.offset[line, normal], normal
    nearest = np.full(count, np.inf)
    np.minimum.at(nearest, number, np.abs(strokes.depth)[line])
    weight = np.zeros(count)
    np.add.at(weight, number, strokes.weight[line])
    return Offsets(axis, value, weight, nearest, np.arange(count), value)


def join_offsets(offsets: Offsets, strokes: Strokes, pairs: Int, most: float) -> Offsets:
    """The offsets with those of as many `pairs` (P, 2), in their order, made one as can be.

    They get the mean of what they were by weight. They stay apart where that moves one of them by more than the share
    `most` of the depth, or where a line leads from one to the other: then the photo shows the step.
    """
    lead, value = offsets.lead.copy(), offsets.value.copy()
    ends = _ends_on(offsets, strokes)
    steps = {(p, q) for p, q in np.sort(ends[(ends != FREE).all(axis=1)], axis=1).tolist()}
    for one, other in lead[pairs].tolist():
        one, other = int(lead[one]), int(lead[other])
        if one == other:
            continue
        first, second = np.flatnonzero(lead == one), np.flatnonzero(lead == other)
        both = np.concatenate([first, second])
        mean = float(np.average(offsets.start[both], weights=offsets.weight[both]))
        is_far = (np.abs(mean - offsets.start[both]) > most * offsets.nearest[both]).any()
        if is_far or any((min(p, q), max(p, q)) in steps for p in first for q in second):
            continue
        lead[both], value[both] = one, mean
    return replace(offsets, lead=lead, value=value)


def with_offsets(strokes: Strokes, before: Offsets, after: Offsets) -> Strokes:
    """The strokes of the offsets `before` with those `after`; ends that lie on an offset go with it."""
    ends = _ends_on(before, strokes)
    known = strokes.number != FREE
    number = np.where(known, after.lead[strokes.number], FREE)
    reach = np.where(ends != FREE, after.value[ends], strokes.reach)
    return replace(strokes, number=number, offset=np.where(known, after.value[number], 0.0), reach=np.sort(reach))


def _ends_on(offsets: Offsets, strokes: Strokes) -> Int:
    """(N, 2) the number that leads the offset on which the ends of each line lie exactly, FREE where on none."""
    ends = np.full((len(strokes.axis), 2), FREE)
    for along in range(3):
        known = np.flatnonzero((offsets.axis == along) & (offsets.lead == np.arange(len(offsets.lead))))
        own = np.flatnonzero(strokes.axis == along)
        if len(known) == 0 or len(own) == 0:
            continue
        known = known[np.argsort(offsets.value[known], kind="stable")]
        place = np.minimum(np.searchsorted(offsets.value[known], strokes.reach[own]), len(known) - 1)
        ends[own] = np.where(offsets.value[known[place]] == strokes.reach[own], known[place], FREE)
    return ends
