"""The lines of a scene, and the crossings of the segments that show them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linecad.arrays import Bool, Float, Int, Text, check_lengths, check_not_negative, check_unique, check_words, freeze
from linecad.line_graph import EDGE_KINDS
from linecad.scene.words import CONFIDENCES, REASONS, ROLES


@dataclass(frozen=True, eq=False)
class Lines:
    """The lines in space of a scene, with the segments that show them."""

    id: Int  # (N,) unique, not negative
    axis: Int  # (N,) number of a direction: 0, 1, 2, and from 3 on those of further frames
    segment: Float  # (N, 2, 2) px
    ends: Float  # (N, 2, 3) world, in the scene's unit
    is_boundary: Bool  # (N,) at the meeting of two planes
    component: Int  # (N,) 0 is what the scene is about (linecad.model.groups); each may have its own scale
    confidence: Text  # (N,) proven, supported, weak
    # (N,) 0 to 1, that the depth relative to component 0 is right within 5 %; (0,) in scenes that do not tell
    probability: Float | tuple[()] = ()
    by_depth_map: Bool | tuple[()] = ()  # (N,) a depth map alone says where it stands, or its body; left out: of none
    role: Text | tuple[()] = ()  # (N,) one of ROLES; left out: all are outlines
    by_face: Bool | tuple[()] = ()  # (N,) no crossing placed it: it lies on a face; left out: crossings placed all
    # N: the segments (K, 2, 2) px that a line was joined from, (0, 2, 2) where it has one; left out: all have one
    pieces: tuple[Float, ...] = ()

    def __post_init__(self) -> None:
        for name in ("id", "axis", "component"):
            freeze(self, name, np.int64, (None,))
        freeze(self, "segment", np.float64, (None, 2, 2))
        freeze(self, "ends", np.float64, (None, 2, 3))
        freeze(self, "is_boundary", np.bool_, (None,))
        freeze(self, "confidence", np.str_, (None,))
        freeze(self, "probability", np.float64, (None,))
        for name in ("by_depth_map", "by_face"):
            if len(getattr(self, name)) == 0:
                object.__setattr__(self, name, np.zeros(len(self.id), bool))
            freeze(self, name, np.bool_, (None,))
        if len(self.role) == 0:
            object.__setattr__(self, "role", np.full(len(self.id), ROLES[0]))
        freeze(self, "role", np.str_, (None,))
        self._freeze_pieces()
        same = ["axis", "segment", "ends", "is_boundary", "component", "confidence", "by_depth_map", "by_face", "role"]
        check_lengths(self, len(self.id), [*same, "pieces", *["probability"] * (len(self.probability) > 0)])
        check_not_negative(self, ["id", "axis", "component"])
        check_words(self, "confidence", CONFIDENCES)
        check_words(self, "role", ROLES)
        check_unique("Lines", self.id.tolist())
        if len(self.probability) and not (min(self.probability) >= 0 and max(self.probability) <= 1):
            raise ValueError("Lines.probability holds a number outside 0 to 1")

    def _freeze_pieces(self) -> None:
        """Make the pieces read-only, and none where they are left out."""
        none = np.zeros((0, 2, 2))  # most lines have none, and share it
        given = self.pieces or (none,) * len(self.id)
        frozen = tuple(np.array(each, np.float64).reshape(-1, 2, 2) if len(each) else none for each in given)
        for each in (none, *filter(len, frozen)):
            each.flags.writeable = False
        object.__setattr__(self, "pieces", frozen)

    def __len__(self) -> int:
        return len(self.id)

    def segments_of(self, row: int) -> Float:
        """The segments (K, 2, 2) px of the photo that show a line, one or its pieces."""
        return self.pieces[row] if len(self.pieces[row]) else self.segment[row : row + 1]

    @cached_property
    def row_by_look(self) -> dict[tuple[int, bytes], int]:
        """The row of each line by axis and segment, that of a line joined from pieces by each of these."""
        axes = enumerate(self.axis.tolist())
        return {(axis, ends.tobytes()): row for row, axis in axes for ends in self.segments_of(row)}


@dataclass(frozen=True, eq=False)
class Intersections:
    """The crossings of a scene that were candidates, with the decision about each."""

    lines: Int  # (E, 2) ids of the two lines
    kind: Text  # (E,) L, T, X, collinear
    pixel: Float  # (E, 2) px
    real: Bool  # (E,)
    in_tree: Bool  # (E,) in the minimum spanning tree of the real ones
    weight: Float  # (E,)
    reason: Text | tuple[()] = ()  # (E,) one of REASONS; "" in scenes that do not tell, as when it is left out

    def __post_init__(self) -> None:
        freeze(self, "lines", np.int64, (None, 2))
        freeze(self, "kind", np.str_, (None,))
        freeze(self, "pixel", np.float64, (None, 2))
        for name in ("real", "in_tree"):
            freeze(self, name, np.bool_, (None,))
        freeze(self, "weight", np.float64, (None,))
        if len(self.reason) == 0:
            object.__setattr__(self, "reason", np.full(len(self.lines), ""))
        freeze(self, "reason", np.str_, (None,))
        check_lengths(self, len(self.lines), ["kind", "pixel", "real", "in_tree", "weight", "reason"])
        check_words(self, "kind", EDGE_KINDS)
        check_words(self, "reason", (*REASONS, ""))

    def __len__(self) -> int:
        return len(self.lines)
