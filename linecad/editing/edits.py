"""The edits that the page sends, read strictly and turned into corrections that name lines by their geometry."""

from functools import partial

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
    Many,
    Part,
    SetAxis,
    SetEnds,
    SetFrame,
    Split,
)
from linecad.corrections.file import OPERATIONS, PARTS, axis, ends, frame_lines, label, many, metres, point
from linecad.corrections.snapping import LONGEST_REACH, Proposal, find_snap, propose, stretch
from linecad.directions import axis_name
from linecad.editing.session import Session
from linecad.errors import CorrectionError
from linecad.io.strict_json import Node


def read_edit(node: Node, session: Session) -> Edit:
    """The correction that an edit of the page means; JsonError or CorrectionError where it means none."""
    lines = session.editing
    match node["op"].one_of(OPERATIONS):
        case "ends":
            line = _line(node, lines)
            return SetEnds(line, _plain(_stretched(node, lines).ends))
        case "split":
            return Split(_line(node, lines), point(node["at"]))
        case "join":
            pair = node["lines"].items()
            if len(pair) != 2:
                raise node["lines"].wrong("a list of 2")
            return Join((lines.anchor(pair[0].integer()), lines.anchor(pair[1].integer())))
        case "draw":
            drawn = _drawn(node, lines)
            if drawn.is_bent and _wanted(node) is None:
                raise CorrectionError(
                    f"the line is {np.degrees(drawn.off):.0f} degrees off {axis_name(drawn.axis)}, the nearest axis; "
                    "say which axis it runs along, or draw it anew"
                )
            return Draw(Anchor(_plain(drawn.ends), drawn.axis))
        case "length":
            return KnownLength(_line(node, lines), metres(node))
        case "frame":
            return SetFrame(frame_lines(node["lines"], "ends"))
        case "many":
            return Many(many(node["edits"], partial(_part, session=session)))
        case _:
            return _part(node, session)


def _part(node: Node, session: Session) -> Part:
    lines = session.editing
    match node["op"].one_of(PARTS):
        case "label":
            crossing = node["crossing"].integer()
            first, second = session.crossing_pair(crossing)
            u, v = session.lines.graph.crossing[session.lines.edge[crossing]].tolist()
            return LabelCrossing((lines.anchor(first), lines.anchor(second)), (u, v), label(node))
        case "axis":
            return SetAxis(_line(node, lines), axis(node["axis"]))
        case _:
            return Delete(_line(node, lines))


def proposal_to_json(node: Node, lines: Correcting) -> dict[str, object]:
    """What a drawn line would be, or one whose end is dragged; of one point, what it snaps to.

    `ends` are one or two places, or `line`, `end` and `at` name an end and where it is dragged to. Where no line can be
    made of it, that is the answer: the pointer asks at every place that it passes.
    """
    try:
        if node.get("line") is not None:
            return _proposal_to_json(_stretched(node, lines))
        if len(node["ends"].items()) != 1:
            return _proposal_to_json(_drawn(node, lines)) | _nearest_axes(node, lines)
    except CorrectionError as error:
        return {"refused": str(error)}
    at = np.array(point(node["ends"].items()[0]))
    snap = find_snap(at, lines.table, _reach(node, lines))
    told = None if snap is None else {"line": snap.line, "is_end": snap.is_end}
    return {"axis": None, "ends": [(at if snap is None else snap.point).tolist()], "snapped": [told]}


def _proposal_to_json(found: Proposal) -> dict[str, object]:
    return {
        "axis": axis_name(found.axis),
        "ends": found.ends.tolist(),
        "snapped": [None if snap is None else {"line": snap.line, "is_end": snap.is_end} for snap in found.snaps],
        "off": float(np.degrees(found.off)),
        "is_bent": found.is_bent,
    }


def _nearest_axes(node: Node, lines: Correcting) -> dict[str, object]:
    """The axes that a drawn line may mean, the nearest first, with the degrees that it is off them."""
    off = np.degrees(lines.drawing.off_axes(np.array(ends(node["ends"]))))
    return {"axes": [[axis_name(own), float(off[own])] for own in np.argsort(off, kind="stable").tolist()]}


def _drawn(node: Node, lines: Correcting) -> Proposal:
    return propose(lines.drawing, lines.table, np.array(ends(node["ends"])), _wanted(node), _reach(node, lines))


def _stretched(node: Node, lines: Correcting) -> Proposal:
    number, end, at = node["line"].integer(), node["end"].integer(0, 1), np.array(point(node["at"]))
    lines.anchor(number)
    return stretch(lines.drawing, lines.table, number, end, at, _reach(node, lines))


def _wanted(node: Node) -> int | None:
    chosen = node.get("axis")
    return None if chosen is None or chosen.value is None else axis(chosen)


def _reach(node: Node, lines: Correcting) -> float:
    """px within which ends snap, as the page sees it at its zoom; none where it tells none."""
    member = node.get("reach")
    return 0.0 if member is None else min(abs(member.number()), LONGEST_REACH.px(lines.drawing.width))


def _line(node: Node, lines: Correcting) -> Anchor:
    return lines.anchor(node["line"].integer())


def _plain(drawn: Float) -> Ends:
    (a, b), (c, d) = drawn.tolist()
    return (a, b), (c, d)
