"""What of the model the page shows, and so exports: the same choice as that of `linecad export`."""

from collections.abc import Mapping
from typing import cast

from exporters.drawings.facades import number_of_plane
from exporters.format_options import FACADE, FACADE_OF_DRAWING
from exporters.formats import FORMATS
from exporters.model import build_model
from exporters.options import Value
from linecad.corrections.nodes import point
from linecad.editing.state import Now
from linecad.errors import ConfidenceError, CorrectionError, GroupError
from linecad.io.strict_json import Node
from linecad.model.choice import DETAILS, Detail
from linecad.model.groups import GROUPS, Groups
from linecad.model.wanted import Wanted
from linecad.scene import Scene


def read_wanted(node: Node) -> Wanted:
    """What is wanted; what is missing or null is not chosen. JsonError for a value that is not accepted."""
    main, confidence = _given(node, "main"), _given(node, "confidence")
    groups, detail = _given(node, "groups"), _given(node, "detail")
    least = None if confidence is None else confidence.number(1.0)
    if confidence is not None and least is not None and least < 0:
        raise confidence.wrong("a number from 0 to 1")
    which = "all" if groups is None else cast(Groups, groups.one_of(GROUPS))
    drawn = "all" if detail is None else cast(Detail, detail.one_of(DETAILS))
    return Wanted(None if main is None else point(main), None, which, least, drawn)


def document_of_shown(now: Now, wanted: Wanted) -> dict[str, object]:
    """The page's lines and the faces that stay, by ids, and what was left out, in words.

    Where nothing would stay, no ids and the reason. CorrectionError where there is no model.
    """
    if now.model is None:
        raise CorrectionError("there is no model yet; solve first")
    scene = now.model.scene
    try:
        rest = wanted.of(scene)
    except (ConfidenceError, GroupError) as error:
        # The page has no arguments: it has a slider.
        return {"version": now.version, "lines": [], "faces": [], "notes": [], "nothing": _without_dashes(str(error))}
    kept, rows = set(rest.lines.id.tolist()), scene.lines.row_by_look
    looks = zip(now.lines.ids, now.lines.graph.axis.tolist(), now.lines.graph.segments.ends, strict=True)
    places = ((number, rows.get((axis, ends.tobytes()))) for number, axis, ends in looks)
    return {
        "version": now.version,
        "lines": [number for number, row in places if row is not None and int(scene.lines.id[row]) in kept],
        "faces": [face.id for _, face in rest.faces],
        "notes": list(rest.notes[len(scene.notes) :]),
        "nothing": None,
    }


def _without_dashes(text: str) -> str:
    return text.replace(" --", " ")


def values_of(scene: Scene, suffix: str, node: Node | None) -> Mapping[str, Value]:
    """The options of a format: of a drawing the facade in the plane that the page names.

    Raises OutputError for a plane that is no facade of the scene.
    """
    plane = None if node is None else _given(node, "plane")
    if plane is None or suffix not in FORMATS or FACADE_OF_DRAWING not in FORMATS[suffix].options:
        return {}
    return {FACADE: number_of_plane(build_model(scene), plane.integer())}


def _given(node: Node, key: str) -> Node | None:
    member = node.get(key)
    return None if member is None or member.value is None else member
