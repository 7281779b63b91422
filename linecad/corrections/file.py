"""Corrections as a file: JSON (docs/reference/corrections.md) that reads back as exactly the same edits."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import assert_never, cast

from linecad.corrections.edits import (
    LABELS,
    LONGEST,
    LONGEST_NAME,
    MOST_EDITS,
    SHORTEST,
    Anchor,
    Corrections,
    Cut,
    Delete,
    Draw,
    Edit,
    FaceAnchor,
    Foot,
    Join,
    KnownDistance,
    KnownLength,
    Label,
    LabelCrossing,
    Many,
    Meet,
    NameGroup,
    NoWindow,
    OnePlane,
    Part,
    Place,
    PlaceAt,
    Region,
    SetAxis,
    SetEnds,
    SetFrame,
    Split,
    WallByEdges,
    Window,
    Withdraw,
)
from linecad.corrections.face_file import FACE_OPERATIONS, face_edit, face_edit_to_json
from linecad.corrections.fact_file import FACTS, fact_to_json, read_fact
from linecad.corrections.nodes import anchor, anchor_to_json, axis, ends, point, two, two_anchors
from linecad.directions import axis_name
from linecad.errors import CorrectionsFileError
from linecad.io.files import read_text, write_text_atomically
from linecad.io.strict_json import JsonError, Node, parse

FORMAT = "linecad-corrections"
VERSION = 1
SUFFIX = ".corrections.json"
LARGEST_FILE = 64 * 2**20  # bytes; an edit takes a few hundred
LARGEST_PHOTO = 10**6  # px along one side
MOST_FRAME_LINES = 100
PARTS = ("label", "axis", "delete")  # what `many` may hold
OPERATIONS = (
    *PARTS, "ends", "split", "join", "draw", "length", "distance", "name", "frame", "many", *FACE_OPERATIONS, *FACTS,
    "withdraw",
)  # fmt: skip


def read_corrections(path: str | os.PathLike[str]) -> Corrections:
    """The corrections in a file; CorrectionsFileError if it cannot be read or breaks docs/reference/corrections.md."""
    text = read_text(path, LARGEST_FILE, "corrections file", CorrectionsFileError)
    try:
        return corrections_from_json(text)
    except CorrectionsFileError as error:
        raise CorrectionsFileError(f"{' '.join(str(path).splitlines())}: {error}") from None


def write_corrections(corrections: Corrections, path: str | os.PathLike[str]) -> None:
    """Write the corrections file, whole or not at all; OutputError when that cannot be done."""
    write_text_atomically(Path(path), corrections_to_json(corrections))


def check_belongs(corrections: Corrections, name: str, width: int, height: int) -> None:
    """Raise CorrectionsFileError unless the corrections were made in a photo of this size; `name` is theirs."""
    if (corrections.width, corrections.height) != (width, height):
        raise CorrectionsFileError(
            f"{name} is for a photo of {corrections.width} x {corrections.height} px ({corrections.photo}), this one "
            f"has {width} x {height} px; give the corrections of this photo"
        )


def corrections_from_json(text: str) -> Corrections:
    """The corrections that a JSON text tells; CorrectionsFileError with one line when it breaks the format."""
    try:
        return _corrections(parse(text))
    except JsonError as error:
        raise CorrectionsFileError(f"{error}; see docs/reference/corrections.md") from None


def corrections_to_json(corrections: Corrections) -> str:
    """The text of the corrections file, the same for the same corrections, with one edit in each line."""
    head = {
        "format": FORMAT,
        "version": VERSION,
        "photo": corrections.photo,
        "width": corrections.width,
        "height": corrections.height,
    }
    parts = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in head.items()]
    for key, edits in (("edits", corrections.edits), ("undone", corrections.undone)):
        rows = ",\n".join("  " + json.dumps(edit_to_json(edit), allow_nan=False) for edit in edits)
        parts.append(f' "{key}": [\n{rows}\n ]' if rows else f' "{key}": []')
    return "{\n" + ",\n".join(parts) + "\n}\n"


def edit_to_json(edit: Edit) -> dict[str, object]:
    """One edit as plain values."""
    match edit:
        case LabelCrossing():
            return {
                "op": "label",
                "lines": [anchor_to_json(line) for line in edit.lines],
                "pixel": list(edit.pixel),
                "value": edit.label,
            }
        case SetAxis():
            return {"op": "axis", "line": anchor_to_json(edit.line), "axis": axis_name(edit.axis)}
        case Delete():
            return {"op": "delete", "line": anchor_to_json(edit.line)}
        case SetEnds():
            return {"op": "ends", "line": anchor_to_json(edit.line), "ends": [list(end) for end in edit.ends]}
        case Split():
            return {"op": "split", "line": anchor_to_json(edit.line), "at": list(edit.at)}
        case Join():
            return {"op": "join", "lines": [anchor_to_json(line) for line in edit.lines]}
        case Draw():
            return {"op": "draw", "line": anchor_to_json(edit.line)}
        case KnownLength():
            return {"op": "length", "line": anchor_to_json(edit.line), "metres": edit.metres}
        case KnownDistance():
            return {"op": "distance", "points": [_place_to_json(one) for one in edit.places], "metres": edit.metres}
        case NameGroup():
            return {"op": "name", "line": anchor_to_json(edit.line), "text": edit.name}
        case SetFrame():
            return {"op": "frame", "lines": [anchor_to_json(line) for line in edit.lines]}
        case Many():
            return {"op": "many", "edits": [edit_to_json(part) for part in edit.edits]}
        case Region() | Window() | NoWindow() | WallByEdges():
            return face_edit_to_json(edit)
        case Withdraw():
            return {"op": "withdraw", "fact": fact_to_json(edit.fact)}
        case Meet() | OnePlane() | Foot() | Cut() | PlaceAt():
            return fact_to_json(edit)
        case _:
            assert_never(edit)


def _place_to_json(place: Place) -> dict[str, object]:
    pixel = list(place.pixel)
    if isinstance(place.on, Anchor):
        return {"pixel": pixel, "line": anchor_to_json(place.on)}
    return {"pixel": pixel, "face": {"pixel": list(place.on.pixel), "normal": axis_name(place.on.axis)}}


def _corrections(top: Node) -> Corrections:
    if top["format"].value != FORMAT:
        raise top["format"].wrong(f'"{FORMAT}"')
    if top["version"].integer() != VERSION:
        raise JsonError(f"version is {top['version'].value}, but only version {VERSION} can be read here")
    edits, undone = top["edits"].items(), top["undone"].items() if top.get("undone") else []
    count = sum(map(_count, [*edits, *undone]))
    if count > MOST_EDITS:
        raise JsonError(f"there are {count} edits, at most {MOST_EDITS} are taken")
    return Corrections(
        photo=top["photo"].text(),
        width=top["width"].integer(1, LARGEST_PHOTO),
        height=top["height"].integer(1, LARGEST_PHOTO),
        edits=tuple(map(_edit, edits)),
        undone=tuple(map(_edit, undone)),
    )


def _count(node: Node) -> int:
    """How many edits a value stands for, whether it is one or not."""
    parts = node.value.get("edits") if isinstance(node.value, dict) else None
    return len(parts) if isinstance(parts, list) else 1


def _part(node: Node) -> Part:
    match node["op"].one_of(PARTS):
        case "label":
            return LabelCrossing(two_anchors(node["lines"]), point(node["pixel"]), label(node))
        case "axis":
            return SetAxis(anchor(node["line"]), axis(node["axis"]))
        case _:
            return Delete(anchor(node["line"]))


def _edit(node: Node) -> Edit:
    match node["op"].one_of(OPERATIONS):
        case "ends":
            return SetEnds(anchor(node["line"]), ends(node["ends"]))
        case "split":
            return Split(anchor(node["line"]), point(node["at"]))
        case "join":
            return Join(two_anchors(node["lines"]))
        case "draw":
            return Draw(anchor(node["line"]))
        case "length":
            return KnownLength(anchor(node["line"]), metres(node))
        case "distance":
            first, second = two(node["points"])
            return KnownDistance((_place(first), _place(second)), metres(node))
        case "name":
            return NameGroup(anchor(node["line"]), name(node))
        case "frame":
            return SetFrame(frame_lines(node["lines"], "segment"))
        case "many":
            return Many(many(node["edits"], _part))
        case "withdraw":
            return Withdraw(read_fact(node["fact"]))
        case "label" | "axis" | "delete":
            return _part(node)
        case op if op in FACE_OPERATIONS:
            return face_edit(node)
        case _:
            return read_fact(node)


def _place(node: Node) -> Place:
    line, pixel = node.get("line"), point(node["pixel"])
    if line is not None:
        return Place(pixel, anchor(line))
    return Place(pixel, FaceAnchor(point(node["face"]["pixel"]), axis(node["face"]["normal"])))


def many(node: Node, read: Callable[[Node], Part]) -> tuple[Part, ...]:
    """The edits that one step holds, each as `read` reads it."""
    items = node.items()
    if not 1 <= len(items) <= MOST_EDITS:
        raise node.wrong(f"a list of 1 to {MOST_EDITS}")
    return tuple(map(read, items))


def frame_lines(node: Node, key: str) -> tuple[Anchor, ...]:
    """Lines drawn along the axes, their ends under `key`; JsonError for anything else, as below."""
    items = node.items()
    if not 1 <= len(items) <= MOST_FRAME_LINES:
        raise node.wrong(f"a list of 1 to {MOST_FRAME_LINES}")
    return tuple(anchor(item, key) for item in items)


def label(node: Node) -> Label | None:
    """The member "value": a label, or null."""
    member = node.get("value")
    return None if member is None or member.value is None else cast(Label, member.one_of(LABELS))


def metres(node: Node) -> float | None:
    """The member "metres": a length, or null."""
    member = node.get("metres")
    if member is None or member.value is None:
        return None
    found = member.number(LONGEST)
    if found < SHORTEST:
        raise member.wrong(f"a length from {SHORTEST:g} to {LONGEST:g} m")
    return found


def name(node: Node) -> str | None:
    """The member "text": a name of one line, or null."""
    member = node.get("text")
    if member is None or member.value is None:
        return None
    found = member.text().strip()
    if not 0 < len(found) <= LONGEST_NAME or not found.isprintable():
        raise member.wrong(f"a name of 1 to {LONGEST_NAME} characters")
    return found
