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
    KnownDistance,
    KnownLength,
    LabelCrossing,
    Meet,
    OnePlane,
    Place,
    PlaceAt,
    SetAxis,
    SetFrame,
    Split,
    Withdraw,
)
from linecad.corrections.fact_file import FACTS
from linecad.corrections.file import OPERATIONS, frame_lines, label, metres
from linecad.corrections.nodes import axis, ends, point, two
from linecad.editing.faces import face_anchor
from linecad.editing.session import Session
from linecad.io.strict_json import Node
from linecad.model.known_lengths import units_between


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
        case "distance":
            return _known_distance(node, session)
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
