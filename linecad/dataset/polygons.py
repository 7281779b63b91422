"""Buildings and cameras that are given as JSON: polygons of walls, roofs, windows, and views of them.

docs/reference/datasets.md describes both files. Either may be packed with gzip.
"""

import gzip
import math
import zlib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeVar, get_args

import numpy as np

from linecad.arrays import Float
from linecad.dataset.view import View
from linecad.errors import DatasetError
from linecad.io.strict_json import JsonError, Node, parse

PartKind = Literal[
    "wall", "roof", "ground", "window", "door", "installation", "outer_ceiling", "outer_floor", "closure", "other"
]
PART_KINDS: tuple[PartKind, ...] = get_args(PartKind)
LARGEST_FILE = 400_000_000  # bytes, unpacked
FARTHEST = 1e5  # m from the origin; single precision of renderers and cards ends there
WIDEST = 150.0  # degrees of a camera's field of view
STEEPEST = math.radians(60)  # of a camera's look, up or down
EYE_HEIGHT = 1.6  # m above the ground, where a view does not tell the ground's height
GZIP = b"\x1f\x8b"

Read = TypeVar("Read")


@dataclass(frozen=True, eq=False)
class Polygon:
    """A planar polygon of a building."""

    kind: PartKind
    thing: int | None  # the window, door or installation of the building that it is part of
    rings: tuple[Float, ...]  # each (N, 3), m: the outline, then holes


@dataclass(frozen=True, eq=False)
class Building:
    """The polygons of a building."""

    name: str
    polygons: tuple[Polygon, ...]


@dataclass(frozen=True, eq=False)
class NamedView:
    """A view of the buildings, in their coordinates, and the height of the ground, m."""

    name: str
    view: View
    ground: float


def read_buildings(path: Path) -> tuple[Building, ...]:
    """The buildings in a file. Raises DatasetError."""
    found = _read(path, "buildings", lambda node: tuple(_building(one) for one in node["buildings"].items()))
    _check_names(path, "buildings", [building.name for building in found])
    return found


def read_views(path: Path) -> tuple[NamedView, ...]:
    """The views in a file of cameras. Raises DatasetError."""
    found = _read(path, "cameras", lambda node: tuple(_view(one) for one in node["views"].items()))
    _check_names(path, "views", [view.name for view in found])
    return found


def _check_names(path: Path, what: str, names: list[str]) -> None:
    twice = next((name for name, count in Counter(names).items() if count > 1), None)
    if twice is not None:
        raise DatasetError(f"{path} has two {what} of the name {twice}; give each a name of its own")


def _read(path: Path, what: str, take: Callable[[Node], tuple[Read, ...]]) -> tuple[Read, ...]:
    try:
        data = path.read_bytes()
        if data.startswith(GZIP):
            with gzip.open(path) as stream:
                data = stream.read(LARGEST_FILE + 1)
        if len(data) > LARGEST_FILE:
            raise DatasetError(f"{path} holds more than {LARGEST_FILE // 10**6} MB; give fewer buildings")
        found = take(parse(data.decode("utf-8-sig")))
    except OSError as error:
        reason = error.strerror or "it is damaged"
        raise DatasetError(f"{path} cannot be read: {reason}; give a file of {what}") from error
    except (EOFError, zlib.error, UnicodeDecodeError) as error:
        raise DatasetError(f"{path} is damaged; give a file of {what}, as JSON or packed with gzip") from error
    except JsonError as error:
        raise DatasetError(f"{path}: {error}; docs/reference/datasets.md describes files of {what}") from error
    if not found:
        raise DatasetError(f"{path} holds no {what}; give a file that has some")
    return found


def _building(node: Node) -> Building:
    return Building(node["id"].text(), tuple(_polygon(one) for one in node["polygons"].items()))


def _polygon(node: Node) -> Polygon:
    thing = node.get("object")
    rings = tuple(ring.array(None, 3, largest=FARTHEST) for ring in node["rings"].items())
    if not rings or min(map(len, rings)) < 3:
        raise node["rings"].wrong("rings of 3 points or more")
    return Polygon(
        kind=next(kind for kind in PART_KINDS if kind == node["class"].one_of(PART_KINDS)),
        thing=None if thing is None or thing.value is None else thing.integer(),
        rings=rings,
    )


def _view(node: Node) -> NamedView:
    name = node["id"].text()
    # It becomes the name of a folder.
    if not name or not all(letter.isalnum() or letter in "+-_" for letter in name):
        raise node["id"].wrong("a name of letters, digits, +, - and _")
    eye, look = node["position"].array(3, largest=FARTHEST), node["look"].array(3, largest=FARTHEST)
    up = node.get("up")
    upward = np.array([0.0, 0.0, 1.0]) if up is None else up.array(3, largest=FARTHEST)
    pitch = math.atan2(look[2], math.hypot(look[0], look[1]))
    if not look.any() or abs(pitch) > STEEPEST:
        raise node["look"].wrong(f"a direction at most {math.degrees(STEEPEST):.0f} degrees up or down")
    yaw = math.atan2(look[0], look[1])
    level = View(eye, yaw, pitch, 0.0, 1.0, (0.0, 0.0)).rotation() @ upward
    if level[1] >= 0:
        raise node["up"].wrong("a direction on the upper side of the view")
    width = node["fov_deg"].number(WIDEST)
    if width <= 0:
        raise node["fov_deg"].wrong(f"an angle of up to {WIDEST:.0f} degrees")
    ground = node.get("ground_z")
    return NamedView(
        name=name,
        view=View(
            eye=eye,
            yaw=yaw,
            pitch=pitch,
            roll=math.atan2(level[0], -level[1]),
            focal=0.5 / math.tan(math.radians(width) / 2),
            off_centre=(0.0, 0.0),
        ),
        ground=float(eye[2]) - EYE_HEIGHT if ground is None else ground.number(FARTHEST),
    )
