"""The members of an edit as plain values, and read again: places, segments, axes, lines."""

from linecad.corrections.edits import Anchor, Point
from linecad.directions import axis_name, axis_of
from linecad.io.strict_json import Node

LARGEST_PIXEL = 1e7  # px from the photo's corner
LEAST_LENGTH = 1e-3  # px, of a segment


def anchor_to_json(line: Anchor) -> dict[str, object]:
    """A line as plain values."""
    return {"segment": [list(end) for end in line.ends], "axis": axis_name(line.axis)}


def anchor(node: Node, key: str = "segment") -> Anchor:
    """A line, its ends under `key`."""
    return Anchor(ends(node[key]), axis(node["axis"]))


def ends(node: Node) -> tuple[Point, Point]:
    """Both ends of a segment, px."""
    items = node.items()
    if len(items) != 2:
        raise node.wrong("a list of 2")
    first, second = point(items[0]), point(items[1])
    if abs(first[0] - second[0]) + abs(first[1] - second[1]) < LEAST_LENGTH:
        raise node.wrong("two ends that differ")
    return first, second


def point(node: Node) -> Point:
    """A place in the photo, px."""
    items = node.items()
    if len(items) != 2:
        raise node.wrong("a list of 2")
    return items[0].number(LARGEST_PIXEL), items[1].number(LARGEST_PIXEL)


def axis(node: Node) -> int:
    """The number of a direction by its name."""
    found = axis_of(node.text())
    if found is None:
        raise node.wrong("one of x, y, z, or of x2, y2, x3 and so on of further frames")
    return found
