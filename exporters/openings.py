"""Windows and doors as things: the pane and the reveals of one opening together, and which openings are equal.

Equal ones are one shape in other places: their faces have the same corners, counted from the lowest corner of each.
Formats that know instances write that shape once.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from exporters.faces import FlatFace
from linecad.arrays import Float
from linecad.scene import Opening, OpeningKind

_EQUAL = 1e-7  # m; corners that are nearer are the same, a tenth of what the strictest reader of a STEP file allows


@dataclass(frozen=True, eq=False)
class Fitting:
    """The faces of one opening."""

    id: int  # of the opening
    shape: int  # of the opening: the same for all of one size
    kind: OpeningKind
    label: str  # for people, such as `window 12`
    place: Float  # (3,) m, the lowest coordinates of its faces
    faces: tuple[FlatFace, ...]  # in ascending id, in their place
    model: int  # id of the first opening that is equal to it, its own where none before it is

    @property
    def component(self) -> int:
        """Of the scene, where these are parted; else 0."""
        return self.faces[0].component

    @property
    def key(self) -> str:
        """Its label as an identifier, such as `window_12`."""
        return self.label.replace(" ", "_")

    @property
    def local_faces(self) -> tuple[FlatFace, ...]:
        """Its faces with `place` as their origin."""
        return tuple(face.moved(-self.place) for face in self.faces)


def build_fittings(openings: Iterable[Opening], faces: Sequence[FlatFace]) -> tuple[Fitting, ...]:
    """The openings that have faces, in ascending id; all equal ones have the first of them as their `model`."""
    made: list[Fitting] = []
    for opening in sorted(openings, key=lambda each: each.id):
        own = tuple(face for face in faces if face.opening == opening.id)
        if own:
            place = np.min([face.vertices.min(axis=0) for face in own], axis=0)
            fitting = Fitting(opening.id, opening.shape, opening.kind, own[0].thing, place, own, opening.id)
            equal = next((other for other in made if other.model == other.id and _are_equal(other, fitting)), fitting)
            made.append(replace(fitting, model=equal.id))
    return tuple(made)


def _are_equal(one: Fitting, other: Fitting) -> bool:
    if (one.kind, one.shape, len(one.faces)) != (other.kind, other.shape, len(other.faces)):
        return False
    for a, b in zip(one.faces, other.faces, strict=True):
        if (a.kind, a.axis, a.normal.tolist()) != (b.kind, b.axis, b.normal.tolist()):
            return False
        if [len(ring) for ring in a.rings] != [len(ring) for ring in b.rings]:
            return False
        if np.abs((a.vertices - one.place) - (b.vertices - other.place)).max() > _EQUAL:
            return False
    return True
