"""What a person corrects about a photo, edit by edit: another input of a reconstruction, never a change in place.

Lines are named by what they looked like when the edit was made (an *anchor*: both ends and the axis), crossings by the
anchors of their two lines and their place. So corrections can be applied again to lines that were found anew.
Pixels are those of the undistorted photo, as in the scene file.
"""

from dataclasses import dataclass
from typing import Literal, get_args

Label = Literal["real", "fake", "unsure"]
LABELS: tuple[Label, ...] = get_args(Label)
Shown = Literal["ground", "sky", "clutter"]
SHOWN: tuple[Shown, ...] = get_args(Shown)
OpeningWord = Literal["window", "door"]
OPENING_WORDS: tuple[OpeningWord, ...] = get_args(OpeningWord)

MOST_CORNERS = 1000  # of a polygon
MOST_OF_GRID = 100  # rows or columns of equal windows
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
class SetFrame:
    """Lines drawn along the Manhattan axes, in place of the frame that was found; equal axes are parallel in space."""

    lines: tuple[Anchor, ...]


@dataclass(frozen=True)
class Region:
    """What a part of the photo shows: the ground, the sky, or clutter, which is what has no plane."""

    polygon: tuple[Point, ...]  # px, 3 corners or more; it does not cross itself
    shows: Shown


@dataclass(frozen=True)
class WallAnchor:
    """A vertical plane by its normal, the number of a direction, and a line in it; without one the place decides."""

    normal: int
    line: Anchor | None


@dataclass(frozen=True)
class Window:
    """Windows or doors of one size: rectangles of a wall in rows and columns, in place of those found there.

    `last` is the corner of the last one of all rows and columns that `corners[1]` is of the first; it says nothing
    about one alone.
    """

    wall: WallAnchor
    corners: tuple[Point, Point]  # px, opposite ones of the first
    kind: OpeningWord = "window"
    columns: int = 1
    rows: int = 1
    last: Point | None = None  # px


@dataclass(frozen=True)
class NoWindow:
    """There is no window or door at a place of the photo."""

    at: Point


@dataclass(frozen=True)
class WallByEdges:
    """Four lines, two upright and two level, are the edges of one wall, which ends at them."""

    lines: tuple[Anchor, Anchor, Anchor, Anchor]


FaceEdit = Region | Window | NoWindow | WallByEdges
Edit = LabelCrossing | SetAxis | Delete | Split | Join | Draw | KnownLength | SetFrame | FaceEdit


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
