"""Facts about bodies in the corrections file."""

from collections.abc import Callable

from linecad.corrections.edits import LARGEST_LOG_RATIO, MOST_LINES, Anchor, Cut, Fact, Foot, Meet, OnePlane, PlaceAt
from linecad.corrections.nodes import anchor, anchor_to_json, axis, point, two_anchors
from linecad.directions import axis_name
from linecad.io.strict_json import Node

FACTS = ("meet", "plane", "foot", "cut", "place")


def read_fact(node: Node) -> Fact:
    """The fact that a JSON object tells; JsonError where it breaks docs/reference/corrections.md."""
    match node["op"].one_of(FACTS):
        case "meet":
            return Meet(two_anchors(node["lines"]))
        case "plane":
            return OnePlane(two_anchors(node["lines"]), axis(node["normal"]))
        case "foot":
            return Foot(anchor(node["line"]), point(node["pixel"]))
        case "cut":
            return Cut(two_anchors(node["lines"]))
        case _:
            ends = anchor(node["line"]), anchor(node["to"])
            return PlaceAt(*ends, node["log_ratio"].number(LARGEST_LOG_RATIO), part_of(node, anchor))


def part_of(node: Node, line: Callable[[Node], Anchor]) -> tuple[Anchor, ...]:
    """The lines of a part of a body under "part", each read by `line`; none where that is not there."""
    part = node.get("part")
    if part is None:
        return ()
    lines = part.items()
    if not 1 <= len(lines) <= MOST_LINES:
        raise part.wrong(f"a list of 1 to {MOST_LINES}")
    return tuple(line(each) for each in lines)


def fact_to_json(fact: Fact) -> dict[str, object]:
    """A fact as plain values."""
    match fact:
        case Meet():
            return {"op": "meet", "lines": [anchor_to_json(line) for line in fact.lines]}
        case OnePlane():
            lines = [anchor_to_json(line) for line in fact.lines]
            return {"op": "plane", "lines": lines, "normal": axis_name(fact.normal)}
        case Foot():
            return {"op": "foot", "line": anchor_to_json(fact.line), "pixel": list(fact.pixel)}
        case Cut():
            return {"op": "cut", "lines": [anchor_to_json(line) for line in fact.lines]}
        case PlaceAt():
            ends = {"line": anchor_to_json(fact.line), "to": anchor_to_json(fact.to)}
            part = {"part": [anchor_to_json(line) for line in fact.part]} if fact.part else {}
            return {"op": "place", **ends, "log_ratio": fact.log_ratio, **part}
