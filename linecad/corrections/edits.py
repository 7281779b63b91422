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
MOST_LINES = 10_000  # of a part of a body
MOST_OF_GRID = 100  # rows or columns of equal windows
MOST_EDITS = 100_000  # in one file; a photo has some thousand crossings
SHORTEST = 1e-6  # m, of a known length
LONGEST = 1e6  # m
LARGEST_LOG_RATIO = 5.0  # of two depths: nothing in a photo is 150 times as far as something else
LONGEST_NAME = 60  # characters, of a group

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
class SetEnds:
    """A line reaches from one place to another along itself; what does not lie on it means its foot there."""

    line: Anchor
    ends: Ends


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
class NameGroup:
    """What a person calls the group that a line is in; None takes the name back. It changes nothing in the model."""

    line: Anchor
    name: str | None


@dataclass(frozen=True)
class SetFrame:
    """Lines drawn along the Manhattan axes, in place of the frame that was found; equal axes are parallel in space."""

    lines: tuple[Anchor, ...]


Part = LabelCrossing | SetAxis | Delete


@dataclass(frozen=True)
class Many:
    """What was done to many lines and crossings in one step, which undo takes back in one step too."""

    edits: tuple[Part, ...]


# Facts: what a person knows of how the bodies of a photo stand to each other. A fact is about the bodies that its lines
# belong to when the scene is solved: which lines hold together is found anew each time.


@dataclass(frozen=True)
class Meet:
    """Two lines meet where they cross in the photo; two along one axis are one line."""

    lines: tuple[Anchor, Anchor]


@dataclass(frozen=True)
class OnePlane:
    """Two lines lie in one plane; where its normal is upright, at one height."""

    lines: tuple[Anchor, Anchor]
    normal: int  # number of a direction


@dataclass(frozen=True)
class Foot:
    """The wall of a line ends on the ground at a pixel; an upright line does at its point nearest to the pixel."""

    line: Anchor
    pixel: Point


@dataclass(frozen=True)
class Cut:
    """What two lines belong to is not connected, however many crossings say so."""

    lines: tuple[Anchor, Anchor]


@dataclass(frozen=True)
class PlaceAt:
    """Where a line stands against another one: the log ratio of the depths of their segments' middles.

    With it goes its body, or a `part` of that alone: of these lines those of its body become a body of their own.
    """

    line: Anchor
    to: Anchor
    log_ratio: float
    part: tuple[Anchor, ...] = ()  # that the line is one of; none for the whole body


Fact = Meet | OnePlane | Foot | Cut | PlaceAt


@dataclass(frozen=True)
class Withdraw:
    """A fact that was told does not hold."""

    fact: Fact


def anchors_of(fact: Fact) -> tuple[Anchor, ...]:
    """The lines that a fact names."""
    match fact:
        case Foot():
            return (fact.line,)
        case PlaceAt():
            return fact.line, fact.to
        case _:
            return fact.lines


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


Edit = (
    LabelCrossing
    | SetAxis
    | Delete
    | SetEnds
    | Split
    | Join
    | Draw
    | KnownLength
    | KnownDistance
    | NameGroup
    | SetFrame
    | Many
    | FaceEdit
    | Fact
    | Withdraw
)


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
