"""The edits that the page sends, read strictly and turned into corrections that name lines by their geometry."""

import numpy as np

from linecad.arrays import Float
from linecad.corrections.apply import Correcting
from linecad.corrections.edits import (
    LARGEST_LOG_RATIO,
    Anchor,
    Cut,
    Delete,
    Draw,
    Edit,
    Ends,
    Fact,
    Foot,
    Join,
    KnownLength,
    LabelCrossing,
    Meet,
    OnePlane,
    PlaceAt,
    SetAxis,
    SetFrame,
    Split,
    Withdraw,
)
from linecad.corrections.fact_file import FACTS
from linecad.corrections.file import OPERATIONS, frame_lines, label, metres
from linecad.corrections.nodes import axis, ends, point
from linecad.editing.session import Session
from linecad.io.strict_json import Node


def read_edit(node: Node, session: Session) -> Edit:
    """The correction that an edit of the page means; JsonError or CorrectionError where it means none."""
    lines = session.editing
    match node["op"].one_of(OPERATIONS):
        case "label":
            crossing = node["crossing"].integer()
            first, second = session.crossing_pair(crossing)
            u, v = session.lines.graph.crossing[session.lines.edge[crossing]].tolist()
            return LabelCrossing((lines.anchor(first), lines.anchor(second)), (u, v), label(node))
        case "axis":
            return SetAxis(_line(node, lines), axis(node["axis"]))
        case "delete":
            return Delete(_line(node, lines))
        case "split":
            return Split(_line(node, lines), point(node["at"]))
        case "join":
            return Join(_two(node["lines"], lines))
        case "draw":
            drawn, own, _ = proposal(node, lines)
            return Draw(Anchor(_plain(drawn), own))
        case "length":
            return KnownLength(_line(node, lines), metres(node))
        case "frame":
            return SetFrame(frame_lines(node["lines"], "ends"))
        case "withdraw":
            return Withdraw(_told(node["edit"], session))
        case _:
            return _fact(node, lines)


def _fact(node: Node, lines: Correcting) -> Fact:
    """A fact whose lines are named by their ids."""
    match node["op"].one_of(FACTS):
        case "meet":
            return Meet(_two(node["lines"], lines))
        case "plane":
            return OnePlane(_two(node["lines"], lines), axis(node["normal"]))
        case "foot":
            return Foot(_line(node, lines), point(node["pixel"]))
        case "cut":
            return Cut(_two(node["lines"], lines))
        case _:
            to = lines.anchor(node["to"].integer())
            return PlaceAt(_line(node, lines), to, node["log_ratio"].number(LARGEST_LOG_RATIO))


def _told(node: Node, session: Session) -> Fact:
    """The fact that was told as the edit of a number."""
    edits, number = session.now().corrections.edits, node.integer()
    told = edits[number] if number < len(edits) else None
    if not isinstance(told, Fact):
        raise node.wrong("the number of an edit that says something of bodies")
    return told


def _two(node: Node, lines: Correcting) -> tuple[Anchor, Anchor]:
    pair = node.items()
    if len(pair) != 2:
        raise node.wrong("a list of 2")
    return lines.anchor(pair[0].integer()), lines.anchor(pair[1].integer())


def proposal(node: Node, lines: Correcting) -> tuple[Float, int, tuple[bool, bool]]:
    """Ends (2, 2), axis and which ends snapped of a line drawn between two points, on an axis or the nearest one."""
    chosen = node.get("axis")
    wanted = None if chosen is None or chosen.value is None else axis(chosen)
    return lines.snapped(np.array(ends(node["ends"])), wanted)


def _line(node: Node, lines: Correcting) -> Anchor:
    return lines.anchor(node["line"].integer())


def _plain(drawn: Float) -> Ends:
    (a, b), (c, d) = drawn.tolist()
    return (a, b), (c, d)
