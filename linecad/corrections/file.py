"""Corrections as a file: JSON (docs/reference/corrections.md) that reads back as exactly the same edits."""

import json
import os
from pathlib import Path
from typing import assert_never, cast

from linecad.corrections.edits import (
    LABELS,
    LONGEST,
    MOST_EDITS,
    SHORTEST,
    Anchor,
    Corrections,
    Delete,
    Draw,
    Edit,
    Join,
    KnownLength,
    Label,
    LabelCrossing,
    NoWindow,
    Region,
    SetAxis,
    SetFrame,
    Split,
    WallByEdges,
    Window,
)
from linecad.corrections.face_file import FACE_OPERATIONS, face_edit, face_edit_to_json
from linecad.corrections.values import anchor, anchor_to_json, axis, point
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
OPERATIONS = ("label", "axis", "delete", "split", "join", "draw", "length", "frame", *FACE_OPERATIONS)


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
        case Split():
            return {"op": "split", "line": anchor_to_json(edit.line), "at": list(edit.at)}
        case Join():
            return {"op": "join", "lines": [anchor_to_json(line) for line in edit.lines]}
        case Draw():
            return {"op": "draw", "line": anchor_to_json(edit.line)}
        case KnownLength():
            return {"op": "length", "line": anchor_to_json(edit.line), "metres": edit.metres}
        case SetFrame():
            return {"op": "frame", "lines": [anchor_to_json(line) for line in edit.lines]}
        case Region() | Window() | NoWindow() | WallByEdges():
            return face_edit_to_json(edit)
        case _:
            assert_never(edit)


def _corrections(top: Node) -> Corrections:
    if top["format"].value != FORMAT:
        raise top["format"].wrong(f'"{FORMAT}"')
    if top["version"].integer() != VERSION:
        raise JsonError(f"version is {top['version'].value}, but only version {VERSION} can be read here")
    edits, undone = top["edits"].items(), top["undone"].items() if top.get("undone") else []
    if len(edits) + len(undone) > MOST_EDITS:
        raise JsonError(f"there are {len(edits) + len(undone)} edits, at most {MOST_EDITS} are taken")
    return Corrections(
        photo=top["photo"].text(),
        width=top["width"].integer(1, LARGEST_PHOTO),
        height=top["height"].integer(1, LARGEST_PHOTO),
        edits=tuple(map(_edit, edits)),
        undone=tuple(map(_edit, undone)),
    )


def _edit(node: Node) -> Edit:
    match node["op"].one_of(OPERATIONS):
        case "label":
            return LabelCrossing(_two(node["lines"]), point(node["pixel"]), label(node))
        case "axis":
            return SetAxis(anchor(node["line"]), axis(node["axis"]))
        case "delete":
            return Delete(anchor(node["line"]))
        case "split":
            return Split(anchor(node["line"]), point(node["at"]))
        case "join":
            return Join(_two(node["lines"]))
        case "draw":
            return Draw(anchor(node["line"]))
        case "length":
            return KnownLength(anchor(node["line"]), metres(node))
        case "frame":
            return SetFrame(frame_lines(node["lines"], "segment"))
        case _:
            return face_edit(node)


def _two(node: Node) -> tuple[Anchor, Anchor]:
    items = node.items()
    if len(items) != 2:
        raise node.wrong("a list of 2")
    return anchor(items[0]), anchor(items[1])


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
