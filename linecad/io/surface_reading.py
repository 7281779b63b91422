"""Planes, faces and openings of scene files."""

from typing import cast

import numpy as np

from linecad.arrays import Float
from linecad.directions import Turns, axis_in_frame
from linecad.io.members import (
    LARGEST_NUMBER,
    count_or_zero,
    distinct_ids,
    known_member,
    line_ids,
    optional_boolean,
    optional_items,
)
from linecad.io.strict_json import JsonError, Node
from linecad.scene import AXES, FACE_KINDS, OPENING_KINDS, Face, FaceKind, Opening, OpeningKind, Plane


def read_planes(nodes: list[Node], known: set[int], openings: set[int], turns: Turns | None) -> tuple[Plane, ...]:
    """The planes with their faces; `known` are the ids of the scene's lines, `openings` those of its openings.

    `turns` are of further frames; None in version 1, in which `tilt` means nothing.
    """
    distinct_ids([node["id"] for node in nodes])
    distinct_ids([face["id"] for node in nodes for face in optional_items(node, "faces")])
    return tuple(
        Plane(
            id=node["id"].integer(),
            axis=read_direction(node, turns or ()),
            offset=node["offset"].number(LARGEST_NUMBER),
            lines=tuple(line_ids(node["lines"], known)),
            faces=tuple(_face(face, openings) for face in optional_items(node, "faces")),
            tilt=0.0 if turns is None else _tilt(node),
        )
        for node in nodes
    )


def read_direction(node: Node, turns: Turns) -> int:
    """The direction of a line or of the normal of a plane; in version 1, without `turns`, `frame` means nothing."""
    letter = node["axis"].one_of(tuple(AXES))
    frame = known_member(node, "frame") if turns else None
    return axis_in_frame(letter, 0 if frame is None else frame.integer(0, len(turns)))


def _tilt(node: Node) -> float:
    """Of the normal of a sloped plane, rad; 0 where none is told."""
    told = known_member(node, "tilt")
    if told is None:
        return 0.0
    if not 0 < told.number() < np.pi or node["axis"].value == "z":
        raise told.wrong("more than 0 and less than pi, beside a level axis")
    return told.number()


def _face(node: Node, openings: set[int]) -> Face:
    opening = known_member(node, "opening")
    if opening is not None and opening.integer() not in openings:
        raise JsonError(f"{opening.place} is {opening.value}, but no opening has this id")
    return Face(
        id=node["id"].integer(),
        outline=_ring(node["outline"]),
        holes=tuple(_ring(hole) for hole in optional_items(node, "holes")),
        kind="other" if (kind := node.get("kind")) is None else cast(FaceKind, kind.one_of(FACE_KINDS)),
        hidden=tuple(_ring(part) for part in optional_items(node, "hidden")),
        opening=None if opening is None else opening.integer(),
    )


def _ring(node: Node) -> Float:
    ring = node.array(None, 3, largest=LARGEST_NUMBER)
    if len(ring) < 3:
        raise node.wrong("at least 3 points")
    return ring


def read_openings(nodes: list[Node], walls: set[int]) -> tuple[Opening, ...]:
    """The openings; `walls` are the ids of the vertical planes."""
    distinct_ids([node["id"] for node in nodes])
    return tuple(_opening(node, walls) for node in nodes)


def _opening(node: Node, walls: set[int]) -> Opening:
    if node["plane"].integer() not in walls:
        raise JsonError(f"{node['plane'].place} is {node['plane'].value}, but no vertical plane has this id")
    u, v = (node[key].array(2, largest=LARGEST_NUMBER).tolist() for key in ("u", "v"))
    for key, (start, end) in (("u", u), ("v", v)):
        if start >= end:
            raise node[key].wrong("two ascending numbers")
    recess, panel = known_member(node, "recess"), known_member(node, "panel")
    if (recess is None) != (panel is None):
        raise JsonError(f"{node.place} has a recess without a panel, or a panel without a recess")
    if recess is not None and recess.number(LARGEST_NUMBER) <= 0:
        raise recess.wrong("a positive number or null")
    return Opening(
        id=node["id"].integer(),
        plane=node["plane"].integer(),
        u0=u[0],
        u1=u[1],
        v0=v[0],
        v1=v[1],
        kind=cast(OpeningKind, node["kind"].one_of(OPENING_KINDS)),
        recess=None if recess is None else recess.number(),
        panel=None if panel is None else panel.number(LARGEST_NUMBER),
        is_completed=optional_boolean(node, "completed"),
        shape=count_or_zero(node.get("shape")),
    )
