"""Facts about bodies in the corrections file."""

from linecad.corrections.edits import LARGEST_LOG_RATIO, Cut, Fact, Foot, Meet, OnePlane, PlaceAt
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
            return PlaceAt(anchor(node["line"]), anchor(node["to"]), node["log_ratio"].number(LARGEST_LOG_RATIO))


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
            return {"op": "place", **ends, "log_ratio": fact.log_ratio}
