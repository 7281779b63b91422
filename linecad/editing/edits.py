"""The edits that the page sends, read strictly and turned into corrections that name lines by their geometry."""

from functools import partial

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
    KnownDistance,
    KnownLength,
    LabelCrossing,
    Many,
    Meet,
    NameGroup,
    OnePlane,
    Part,
    Place,
    PlaceAt,
    SetAxis,
    SetEnds,
    SetFrame,
    Split,
    Withdraw,
)
from linecad.corrections.face_file import FACE_OPERATIONS
from linecad.corrections.fact_file import FACTS, part_of
from linecad.corrections.file import OPERATIONS, PARTS, frame_lines, label, many, metres, name
from linecad.corrections.nodes import axis, ends, point, two
from linecad.corrections.snapping import LONGEST_REACH, Proposal, find_snap, propose, stretch
from linecad.directions import axis_name
from linecad.editing.face_edits import read_face_edit
from linecad.editing.faces import face_anchor
from linecad.editing.session import Session
from linecad.errors import CorrectionError
from linecad.io.strict_json import Node
from linecad.model.known_lengths import units_between


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
            return Join(_two(node["lines"], lines))
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
        case "distance":
            return _known_distance(node, session)
        case "name":
            return NameGroup(_line(node, lines), name(node))
        case "frame":
            return SetFrame(frame_lines(node["lines"], "ends"))
        case "many":
            return Many(many(node["edits"], partial(_part, session=session)))
        case "withdraw":
            return Withdraw(_told(node["edit"], session))
        case "label" | "axis" | "delete":
            return _part(node, session)
        case op if op in FACE_OPERATIONS:
            return read_face_edit(node, session)
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
            part = part_of(node, lambda each: lines.anchor(each.integer()))
            return PlaceAt(_line(node, lines), to, node["log_ratio"].number(LARGEST_LOG_RATIO), part)


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


def _known_distance(node: Node, session: Session) -> KnownDistance:
    """The distance of two points; ScaleError, at once, where the model does not hold it or it sets no scale."""
    start, end = two(node["points"])
    edit = KnownDistance((_place(start, session), _place(end, session)), metres(node))
    first, second = (session.editing.found_place(place) for place in edit.places)
    units_between(session.scene(), session.lines.corrected, (first, second))
    return edit


def _place(node: Node, session: Session) -> Place:
    """A point on a line, by its id, or in a plane of the model, by the id of one of its faces."""
    pixel, line = point(node["pixel"]), node.get("line")
    if line is not None:
        return Place(pixel, session.editing.anchor(line.integer()))
    return Place(pixel, face_anchor(session.scene(), pixel, node["face"].integer()))


def _line(node: Node, lines: Correcting) -> Anchor:
    return lines.anchor(node["line"].integer())


def _plain(drawn: Float) -> Ends:
    (a, b), (c, d) = drawn.tolist()
    return (a, b), (c, d)
