"""What the scene file tells of lines and faces, and the groups that they belong to.

Like running.py this is written into the add-on for Blender and the macro for FreeCAD.
"""

import json
import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from exporters.addons.running import AddonError, Request

BANDS = (("sure", 0.9), ("likely", 0.5), ("guess", 0.0))  # words and the smallest probability of each
BAND_NOT_TOLD = "not told"
SAME_HEIGHT = 1e-6  # of the scene's size, as linecad.scene has it: corners of one eave, in one wall
ROLES = {"outline": "outlines", "opening": "openings", "detail": "details"}
GROUPINGS = (
    ("axis", "Axis", "by the axis that they run along"),
    ("role", "Role", "outlines, sides of openings, details"),
    ("confidence", "Confidence", "sure, likely, guess"),
    ("component", "Component", "what crossings hold together; 0 is the largest"),
)


def write_photo(request: Request) -> Path:
    """Write the photo as linecad measured it beside the other files of a request; AddonError where that fails."""
    path = request.output(".photo.jpg")
    try:
        path.write_bytes(photo_of_fspy(request.output(".fspy").read_bytes()))
    except OSError as error:
        raise AddonError(f"{error.filename}: {error.strerror}; the photo cannot be shown") from error
    return path


def photo_of_fspy(project: bytes) -> bytes:
    """The JPEG in an fSpy project: the photo as linecad measured it, straightened where it had to be."""
    header = struct.Struct("<4sIII")  # magic, version, sizes of the state and of the picture in bytes
    magic, version, state, picture = header.unpack_from(project)
    if (magic, version) != (b"fspy", 1) or len(project) != header.size + state + picture:
        raise AddonError("the photo could not be taken out of the fSpy project; is linecad newer than this add-on?")
    return project[header.size + state :]


@dataclass(frozen=True)
class Line:
    """What the scene file tells about a line."""

    axis: str  # name of its direction
    is_boundary: bool
    role: str
    component: int
    probability: float | None  # that its depth is right; None: not told
    ends: tuple[tuple[float, ...], ...]  # (2, 3) m from the camera

    @property
    def band(self) -> str:
        """How sure it is, as a word."""
        return band_of(self.probability)

    @property
    def base(self) -> str:
        """The name that exports give to the group of its axis and kind."""
        return f"lines_{self.axis}_{'boundary' if self.is_boundary else 'nonboundary'}"

    @property
    def part(self) -> str:
        """The name of the part that it belongs to: lines of one axis, kind, role, band and component."""
        words = [self.base]
        words += [self.role] * (self.role != "outline")
        words += [self.band] * (self.probability is not None)
        return "_".join(words) + f" component {self.component}" * (self.component > 0)

    def groups(self) -> dict[str, str]:
        """The group that it belongs to by each of GROUPINGS."""
        return {
            "axis": f"lines {self.axis}",
            "role": ROLES.get(self.role, self.role),
            "confidence": self.band,
            "component": f"component {self.component}",
        }


@dataclass(frozen=True)
class Face:
    """What the scene file tells about a face."""

    kind: str
    probability: float | None  # of the surest line that shows its plane; None: it always stays, or not told


@dataclass(frozen=True)
class SceneFile:
    """What the scene file tells that exports do not, or not all of them."""

    lines: dict[int, Line]  # by id
    faces: dict[int, Face]  # by id
    camera: dict[str, Any]  # `camera` as it stands in the file


def band_of(probability: float | None) -> str:
    """The word for a probability."""
    if probability is None:
        return BAND_NOT_TOLD
    return next(word for word, least in BANDS if probability >= least)


def is_shown(probability: float | None, confidence: float) -> bool:
    """Whether a line or face is shown where so much confidence is asked for: `--confidence` leaves out the others."""
    return probability is None or probability >= confidence


def read_scene_file(path: Path) -> SceneFile:
    """Read a scene file; AddonError where that fails."""
    try:
        top = json.loads(path.read_text(encoding="utf-8"))
        metres = top.get("metres_per_unit") or 1.0
        lines = {line["id"]: _line(line, metres) for line in top["lines"]}
        return SceneFile(lines, _faces(top, lines), top["camera"])
    except (OSError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise AddonError(f"{path} could not be read as a scene file: {error}") from error


def _line(told: dict[str, Any], metres: float) -> Line:
    frame = told.get("frame") or 0
    axis = told["axis"] if not frame or told["axis"] == "z" else f"{told['axis']}{frame + 1}"
    ends = tuple(tuple(metres * value for value in end) for end in told["ends"])
    role, probability = told.get("role", "outline"), told.get("probability")
    return Line(axis, told["boundary"], role, told["component"], probability, ends)


def _faces(top: dict[str, Any], lines: Mapping[int, Line]) -> dict[int, Face]:
    """A face is as sure as the surest line of its plane; parts of an opening and roofs are as sure as their wall.

    The ground always stays.
    """
    surest: dict[int, float | None] = {}
    for plane in top["planes"]:
        told = [] if _shows_ground(plane) else [lines[line].probability for line in plane["lines"]]
        surest[plane["id"]] = max((each for each in told if each is not None), default=None)
    surest |= {plane["id"]: surest[_carrier(plane, top)] for plane in top["planes"] if plane.get("tilt")}
    wall = {opening["id"]: opening["plane"] for opening in top.get("openings", ())}
    return {
        face["id"]: Face(face.get("kind", ""), surest[wall.get(face.get("opening"), plane["id"])])
        for plane in top["planes"]
        for face in plane["faces"]
    }


def _shows_ground(plane: dict[str, Any]) -> bool:
    faces = plane["faces"]
    return plane["axis"] == "z" and plane["offset"] < 0 and any(face.get("kind") == "ground" for face in faces)


def _carrier(roof: dict[str, Any], top: dict[str, Any]) -> int:
    """The id of the wall in which the eave of a sloped plane lies, its own where there is none."""
    corners = [corner for face in roof["faces"] for corner in face["outline"]]
    if not corners:
        return int(roof["id"])
    turn = (0.0, *top.get("turns", ()))[roof.get("frame") or 0] + (math.pi / 2 if roof["axis"] == "y" else 0.0)
    low = min(corner[2] for corner in corners)
    size = max((abs(value) for line in top["lines"] for end in line["ends"] for value in end), default=1.0)
    eave = [corner for corner in corners if corner[2] <= low + SAME_HEIGHT * size]
    along = [corner[0] * math.cos(turn) + corner[1] * math.sin(turn) for corner in eave]
    walls = {
        max(abs(each - plane["offset"]) for each in along): plane["id"]
        for plane in top["planes"]
        if (plane["axis"], plane.get("frame") or 0) == (roof["axis"], roof.get("frame") or 0)
        and not plane.get("tilt")
        and plane["lines"]
    }
    nearest = min(walls, default=math.inf)
    return int(walls[nearest] if nearest <= SAME_HEIGHT * size else roof["id"])


def groups_of(parts: Mapping[str, Mapping[str, str]], by: str) -> dict[str, list[str]]:
    """The names of `parts` by the group that each belongs to by one of GROUPINGS, in order of their names."""
    found: dict[str, list[str]] = {}
    for name in sorted(parts):
        found.setdefault(parts[name][by], []).append(name)
    return {group: found[group] for group in sorted(found, key=lambda group: (_rank(group), group))}


def _rank(group: str) -> int:
    """Sure lines before guesses, outlines before details, components by their numbers."""
    words = [word for word, _ in BANDS] + [BAND_NOT_TOLD]
    if group in words:
        return words.index(group)
    if group in ROLES.values():
        return list(ROLES.values()).index(group)
    last = group.rpartition(" ")[2]
    return int(last) if last.isdecimal() else 0
