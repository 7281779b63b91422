"""The edits about faces in the corrections file (docs/reference/corrections.md)."""

from typing import assert_never, cast

import shapely

from linecad.corrections.edits import (
    MOST_CORNERS,
    MOST_OF_GRID,
    OPENING_WORDS,
    SHOWN,
    Anchor,
    FaceEdit,
    NoWindow,
    OpeningWord,
    Point,
    Region,
    Shown,
    WallAnchor,
    WallByEdges,
    Window,
)
from linecad.corrections.nodes import LEAST_LENGTH, anchor, anchor_to_json, axis, point
from linecad.directions import UP, axis_name
from linecad.io.strict_json import Node

FACE_OPERATIONS = ("region", "window", "no-window", "wall")
EDGES = 4


def face_edit_to_json(edit: FaceEdit) -> dict[str, object]:
    """One edit as plain values."""
    match edit:
        case Region():
            return {"op": "region", "polygon": [list(corner) for corner in edit.polygon], "is": edit.shows}
        case Window():
            line = edit.wall.line
            return {
                "op": "window",
                "wall": {
                    "normal": axis_name(edit.wall.normal),
                    "line": None if line is None else anchor_to_json(line),
                },
                "corners": [list(corner) for corner in edit.corners],
                "kind": edit.kind,
                "columns": edit.columns,
                "rows": edit.rows,
                "last": None if edit.last is None else list(edit.last),
            }
        case NoWindow():
            return {"op": "no-window", "at": list(edit.at)}
        case WallByEdges():
            return {"op": "wall", "lines": [anchor_to_json(line) for line in edit.lines]}
        case _:
            assert_never(edit)


def face_edit(node: Node) -> FaceEdit:
    """An edit about faces; JsonError where the node is none."""
    match node["op"].one_of(FACE_OPERATIONS):
        case "region":
            return Region(polygon(node["polygon"]), shown(node))
        case "window":
            return window(node, wall_anchor(node["wall"]))
        case "no-window":
            return NoWindow(point(node["at"]))
        case _:
            items = node["lines"].items()
            if len(items) != EDGES:
                raise node["lines"].wrong(f"a list of {EDGES}")
            one, two, three, four = (anchor(item) for item in items)
            return WallByEdges((one, two, three, four))


def polygon(node: Node) -> tuple[Point, ...]:
    """The corners of a polygon with an area that does not cross itself, px."""
    corners = points(node)
    if not shapely.Polygon(corners).is_valid:
        raise node.wrong("the corners of a polygon that does not cross itself")
    return corners


def points(node: Node) -> tuple[Point, ...]:
    """Places that a line goes through, px, enough for a polygon."""
    items = node.items()
    if not 3 <= len(items) <= MOST_CORNERS:
        raise node.wrong(f"a list of 3 to {MOST_CORNERS} points")
    return tuple(point(item) for item in items)


def shown(node: Node) -> Shown:
    """The member "is": what a region shows."""
    return cast(Shown, node["is"].one_of(SHOWN))


def window(node: Node, wall: WallAnchor) -> Window:
    """A window of a wall, alone or in rows and columns; their number is 1 and "last" null where they are missing."""
    items = node["corners"].items()
    if len(items) != 2:
        raise node["corners"].wrong("a list of 2")
    corners = point(items[0]), point(items[1])
    if sum(abs(corners[0][k] - corners[1][k]) for k in range(2)) < LEAST_LENGTH:
        raise node["corners"].wrong("two corners that differ")
    kind = node.get("kind")
    columns, rows = (_count(node, key) for key in ("columns", "rows"))
    last = _last(node)
    if columns * rows > 1 and last is None:
        raise node.wrong('a window with "last", as there are several')
    word = OPENING_WORDS[0] if kind is None else cast(OpeningWord, kind.one_of(OPENING_WORDS))
    return Window(wall, corners, word, columns, rows, last)


def wall_anchor(node: Node) -> WallAnchor:
    """How a wall is named."""
    normal = axis(node["normal"])
    if normal == UP:
        raise node["normal"].wrong("a level direction such as x or y")
    return WallAnchor(normal, _line_of(node))


def _line_of(node: Node) -> Anchor | None:
    line = node.get("line")
    return None if line is None or line.value is None else anchor(line)


def _count(node: Node, key: str) -> int:
    member = node.get(key)
    return 1 if member is None else member.integer(1, MOST_OF_GRID)


def _last(node: Node) -> Point | None:
    member = node.get("last")
    return None if member is None or member.value is None else point(member)
