"""The edits that the page sends, read strictly and turned into corrections that name lines by their geometry."""

import numpy as np

from linecad.arrays import Float
from linecad.corrections.apply import Correcting
from linecad.corrections.edits import (
    Anchor,
    Delete,
    Draw,
    Edit,
    Ends,
    Join,
    KnownLength,
    LabelCrossing,
    SetAxis,
    SetFrame,
    Split,
)
from linecad.corrections.file import OPERATIONS, frame_lines, label, metres
from linecad.corrections.values import axis, ends, point
from linecad.editing.face_edits import read_face_edit
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
            pair = node["lines"].items()
            if len(pair) != 2:
                raise node["lines"].wrong("a list of 2")
            return Join((lines.anchor(pair[0].integer()), lines.anchor(pair[1].integer())))
        case "draw":
            drawn, own, _ = proposal(node, lines)
            return Draw(Anchor(_plain(drawn), own))
        case "length":
            return KnownLength(_line(node, lines), metres(node))
        case "frame":
            return SetFrame(frame_lines(node["lines"], "ends"))
        case _:
            return read_face_edit(node, session)


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
