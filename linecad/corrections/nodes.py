"""What the edits of a corrections file are made of: places, segments, axes, lines."""

from linecad.corrections.edits import Anchor, Point
from linecad.directions import axis_name, axis_of
from linecad.io.strict_json import Node

LARGEST_PIXEL = 1e7  # px from the photo's corner
LEAST_LENGTH = 1e-3  # px, of a segment


def anchor(node: Node, key: str = "segment") -> Anchor:
    """A line by its segment, which stands under `key`, and its axis; JsonError for anything else, as below."""
    return Anchor(ends(node[key]), axis(node["axis"]))


def two_anchors(node: Node) -> tuple[Anchor, Anchor]:
    """Two lines."""
    first, second = two(node)
    return anchor(first), anchor(second)


def two(node: Node) -> tuple[Node, Node]:
    """The elements of a list of two."""
    items = node.items()
    if len(items) != 2:
        raise node.wrong("a list of 2")
    return items[0], items[1]


def anchor_to_json(line: Anchor) -> dict[str, object]:
    """A line as plain values."""
    return {"segment": [list(end) for end in line.ends], "axis": axis_name(line.axis)}


def ends(node: Node) -> tuple[Point, Point]:
    """Both ends of a segment, px."""
    first, second = map(point, two(node))
    if abs(first[0] - second[0]) + abs(first[1] - second[1]) < LEAST_LENGTH:
        raise node.wrong("two ends that differ")
    return first, second


def point(node: Node) -> Point:
    """A place in the photo, px."""
    u, v = two(node)
    return u.number(LARGEST_PIXEL), v.number(LARGEST_PIXEL)


def axis(node: Node) -> int:
    """The number of a direction by its name."""
    found = axis_of(node.text())
    if found is None:
        raise node.wrong("one of x, y, z, or of x2, y2, x3 and so on of further frames")
    return found
