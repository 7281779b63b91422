"""What a solve changed far from everything that a person edited since the one before."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass

import numpy as np

from linecad.arrays import Float
from linecad.corrections.edits import Anchor, Edit, Fact, SetFrame, Withdraw
from linecad.geometry import PhotoLength, distances_to

FAR = PhotoLength(200.0)  # px from what was edited


def distant(changed: Iterable[int], place: Mapping[int, Float], edits: Iterable[Edit], width: int) -> frozenset[int]:
    """Those of the changed crossings, at places (2,) px in a photo of `width` px, that are FAR from all of the edits.

    None where the edits mean the whole photo: another frame, or facts about bodies, which tell themselves what moves.
    """
    changed, edits = sorted(changed), list(edits)
    if not changed or not edits or any(isinstance(edit, SetFrame | Fact | Withdraw) for edit in edits):
        return frozenset()
    marks = np.array([mark for edit in edits for mark in _marks(edit)]).reshape(-1, 2, 2)
    if not len(marks):
        return frozenset()
    apart = distances_to(np.array([place[crossing] for crossing in changed]), marks).min(axis=1)
    return frozenset(crossing for crossing, far in zip(changed, (apart > FAR.px(width)).tolist(), strict=True) if far)


def _marks(value: object) -> Iterator[list[list[float]]]:
    """The segments and places that an edit names, a place as a segment of no length; px."""
    if isinstance(value, Anchor):
        yield [list(end) for end in value.ends]
    elif isinstance(value, tuple) and len(value) == 2 and all(isinstance(number, float) for number in value):
        yield [list(value), list(value)]
    elif isinstance(value, tuple):
        for item in value:
            yield from _marks(item)
    elif is_dataclass(value):
        for field in fields(value):
            yield from _marks(getattr(value, field.name))
