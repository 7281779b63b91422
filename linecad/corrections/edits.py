"""What a person corrects about a photo, edit by edit: another input of a reconstruction, never a change in place.

Lines are named by what they looked like when the edit was made (an *anchor*: both ends and the axis), crossings by the
anchors of their two lines and their place. So corrections can be applied again to lines that were found anew.
Pixels are those of the undistorted photo, as in the scene file.
"""

from dataclasses import dataclass
from typing import Literal, get_args

Label = Literal["real", "fake", "unsure"]
LABELS: tuple[Label, ...] = get_args(Label)

MOST_EDITS = 100_000  # in one file; a photo has some thousand crossings
SHORTEST = 1e-6  # m, of a known length
LONGEST = 1e6  # m

Point = tuple[float, float]  # px
Ends = tuple[Point, Point]  # px


@dataclass(frozen=True)
class Anchor:
    """A line by its segment and its axis (0, 1, 2)."""

    ends: Ends
    axis: int


@dataclass(frozen=True)
class LabelCrossing:
    """Two lines meet in space (real), do not (fake), or a person could not tell (unsure); None takes the word back."""

    lines: tuple[Anchor, Anchor]
    pixel: Point
    label: Label | None


@dataclass(frozen=True)
class SetAxis:
    """A line runs along another axis than was found."""

    line: Anchor
    axis: int


@dataclass(frozen=True)
class Delete:
    """A line is none."""

    line: Anchor


@dataclass(frozen=True)
class Split:
    """Two lines were found as one; they part at a point."""

    line: Anchor
    at: Point


@dataclass(frozen=True)
class Join:
    """Two pieces are one line."""

    lines: tuple[Anchor, Anchor]


@dataclass(frozen=True)
class Draw:
    """A line that was not found."""

    line: Anchor


@dataclass(frozen=True)
class KnownLength:
    """The length of a line in metres; None takes it back."""

    line: Anchor
    metres: float | None


@dataclass(frozen=True)
class FaceAnchor:
    """A plane by its normal and a place in the photo that shows it before all other faces with that normal."""

    pixel: Point
    axis: int


@dataclass(frozen=True)
class Place:
    """A point in space: on the ray of a pixel, where that comes nearest to a line or meets a plane."""

    pixel: Point  # also outside the photo
    on: Anchor | FaceAnchor


@dataclass(frozen=True)
class KnownDistance:
    """How far apart two points are in metres; None takes back the distance of the same two."""

    places: tuple[Place, Place]
    metres: float | None


@dataclass(frozen=True)
class SetFrame:
    """Lines drawn along the Manhattan axes, in place of the frame that was found; equal axes are parallel in space."""

    lines: tuple[Anchor, ...]


Edit = LabelCrossing | SetAxis | Delete | Split | Join | Draw | KnownLength | KnownDistance | SetFrame


@dataclass(frozen=True)
class Corrections:
    """All that a person corrected about one photo, in order; what was undone and can come back, the next one last."""

    photo: str  # file name, without its folder
    width: int  # px
    height: int  # px
    edits: tuple[Edit, ...] = ()
    undone: tuple[Edit, ...] = ()

    @property
    def frame(self) -> SetFrame | None:
        """The last word about the frame, or None where the automatic one stands."""
        return next((edit for edit in reversed(self.edits) if isinstance(edit, SetFrame)), None)
