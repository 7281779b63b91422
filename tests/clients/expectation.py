"""What a program must see that opens an export, from the scene file alone: expectation.py SCENE.json EXPECTATION.json

Reads the file as docs/reference/scene-file.md promises it, without code of linecad, so that no mistake is made twice.
Lengths are metres, 1 unit being 1 m where the scale is not known; pixels count from the top left corner of the photo.
Where the scale and the ground are known, z = 0 is the ground.
"""

import json
import math
import sys
from pathlib import Path

SHORTEST_LINE = 1e-9  # m; a shorter line is a point, and no format has it
HALF_A_PIXEL = 0.5  # from the centre of the first pixel, where the scene counts from, to the corner
UNITARY = 1e-6  # how far the rotation times its transpose may be from the identity

# sRGB. They are part of what users get; whoever changes them in the exporters changes them here, knowingly.
AXIS_COLOUR = {"x": (0.87, 0.16, 0.16), "y": (0.10, 0.62, 0.22), "z": (0.15, 0.36, 0.92)}
# Of x2 and y2, then of x3 and y3; after these they begin again.
FURTHER_COLOUR = [(0.93, 0.55, 0.10), (0.05, 0.60, 0.65), (0.76, 0.20, 0.70), (0.55, 0.60, 0.10)]
WHITE_WHERE_NO_BOUNDARY = 0.5  # share
FACE_COLOUR = (0.80, 0.79, 0.74)
KIND_COLOUR = {"window": (0.49, 0.62, 0.72), "door": (0.56, 0.41, 0.29), "reveal": (0.69, 0.66, 0.60)}

BANDS = {"sure": 0.9, "likely": 0.5, "guess": 0.0}  # the smallest probability of each


def build_expectation(scene, by_band=False, by_role=False):
    """The expectation as a dictionary that JSON can hold; ValueError for what is no scene file.

    `by_band` is for exports with the option probability=on, which part lines by how sure their depth is, `by_role` for
    those with roles=on, which part them by what they are drawn for.
    """
    version, turns = scene.get("version"), scene.get("turns", [])
    if scene.get("format") != "linecad-scene" or version != (2 if turns else 1):
        raise ValueError(f"format {scene.get('format')}, version {version}, {len(turns)} turns: not a scene file")
    metres = scene.get("metres_per_unit") or 1.0
    camera = {**_camera(scene["camera"]), "eye": [0.0, 0.0, _height(scene)]}
    eye = camera["eye"]
    lines = []
    for line in sorted(scene["lines"], key=lambda line: line["id"]):
        ends = [_placed(end, metres, eye) for end in line["ends"]]
        if math.dist(*ends) > SHORTEST_LINE:
            group = f"lines_{_axis(line)}_{'boundary' if line['boundary'] else 'nonboundary'}"
            role = line.get("role", "outline")
            group += f"_{role}" if by_role and role != "outline" else ""  # of outlines the name says nothing
            group += _band(line) if by_band else ""
            pixels = [_project(end, camera) for end in line["ends"]]
            lines.append({"id": line["id"], "group": group, "role": role, "ends": ends, "pixels": pixels})
    openings = {opening["id"]: opening for opening in scene.get("openings", [])}
    faces = [
        _face(plane, face, turns, (metres, eye), openings.get(face.get("opening")))
        for plane in scene["planes"]
        for face in plane.get("faces", [])
    ]
    faces.sort(key=lambda face: face["id"])
    _label(faces, openings)
    points = [end for line in lines for end in line["ends"]] + [c for face in faces for c in face["corners"]]
    return {
        "camera": camera,
        "frame": _centred_frame(camera),
        "lines": lines,
        "groups": _groups(scene["lines"], lines),
        "planes": [{"id": p["id"], "axis": _axis(p), "offset": _offset(p, metres, eye)} for p in scene["planes"]],
        "faces": faces,
        "turns": turns,
        "openings": _openings(faces, openings),
        "box": [[choose(values) for values in zip(*points, strict=True)] for choose in (min, max)],
    }


def _height(scene):
    """m of the camera above the lowest ground; 0 where the scene tells no scale or no ground below the camera."""
    heights = [
        -plane["offset"] * (scene.get("metres_per_unit") or 0.0)
        for plane in scene["planes"]
        for face in plane.get("faces", [])
        if plane["axis"] == "z" and face.get("kind") == "ground"
    ]
    return max([0.0, *heights])


def _band(line):
    """How sure the line's depth is, as the end of its group's name; empty where the scene does not tell."""
    if "probability" not in line:
        return ""
    return next(f"_{band}" for band, least in BANDS.items() if line["probability"] >= least)


def _camera(camera):
    (fx, skew, cx), (zero, fy, cy), last = camera["K"]
    if skew or zero or last != [0, 0, 1] or not math.isclose(fx, fy, rel_tol=1e-9):
        raise ValueError(f"K is {camera['K']}, expected square pixels without skew")
    R = camera["R_cam_from_world"]
    for i, row in enumerate(R):
        for j, other in enumerate(R):
            if abs(_dot(row, other) - (i == j)) > UNITARY:
                raise ValueError("R_cam_from_world is no rotation")
    centre = [cx + HALF_A_PIXEL, cy + HALF_A_PIXEL]
    size = {"width": camera["width"], "height": camera["height"]}
    return {**size, "focal": fx, "principal_point": centre, "rotation": R}


def _project(point, camera):
    x, y, z = (_dot(row, point) for row in camera["rotation"])
    if z <= 0:
        raise ValueError(f"{point} lies behind the camera")
    cx, cy = camera["principal_point"]
    return [camera["focal"] * x / z + cx, camera["focal"] * y / z + cy]


def _centred_frame(camera):
    """The smallest frame of even size about the principal point that holds the photo; where the photo lies in it."""
    cx, cy = camera["principal_point"]
    width = 2 * math.ceil(max(cx, camera["width"] - cx))
    height = 2 * math.ceil(max(cy, camera["height"] - cy))
    return {"width": width, "height": height, "left": width / 2 - cx, "top": height / 2 - cy}


def _groups(told, lines):
    groups = {}
    kind = {line["id"]: (_axis(line), line["boundary"]) for line in told}
    for line in lines:
        axis, boundary = kind[line["id"]]
        group = groups.setdefault(line["group"], {"axis": axis, "boundary": boundary, "ids": [], "roles": []})
        group["ids"].append(line["id"])
        group["roles"].append(line["role"])
    for group in groups.values():
        white = 0.0 if group["boundary"] else WHITE_WHERE_NO_BOUNDARY
        group["srgb"] = [white + (1 - white) * value for value in _colour(group["axis"])]
        group["linear"] = [_linear(value) for value in group["srgb"]]
    return groups


def _axis(told):
    """x, y or z as exports call it: x2 and y2 in the first further frame, x3 and y3 in the second."""
    frame = told.get("frame") or 0
    return told["axis"] if told["axis"] == "z" or not frame else f"{told['axis']}{frame + 1}"


def _colour(axis):
    if axis in AXIS_COLOUR:
        return AXIS_COLOUR[axis]
    return FURTHER_COLOUR[(2 * (int(axis[1:]) - 2) + "xy".index(axis[0])) % len(FURTHER_COLOUR)]


def _normal(plane, turns):
    """The direction that a plane's axis has in the world."""
    turn = turns[plane["frame"] - 1] if plane.get("frame") else 0.0
    level = {"x": (math.cos(turn), math.sin(turn), 0.0), "y": (-math.sin(turn), math.cos(turn), 0.0)}
    return level.get(plane["axis"], (0.0, 0.0, 1.0))


def _face(plane, face, turns, place, opening):
    """A face by its corners, each place once, and its rings as indices of them.

    `normal` looks along its axis or against it: to the camera, that of a reveal into its opening. `place` is m per
    unit of the scene, and where the camera is.
    """
    metres, eye = place
    rings = [[_placed(point, metres, eye) for point in ring] for ring in (face["outline"], *face.get("holes", []))]
    kind = face.get("kind", "other")
    looks = -1.0 if plane["offset"] > 0 else 1.0
    if opening and kind == "reveal":
        middle = sum(opening["v" if plane["axis"] == "z" else "u"]) / 2
        looks = 1.0 if plane["offset"] < middle else -1.0
    colour = KIND_COLOUR.get(kind, FACE_COLOUR)
    corners = list(dict.fromkeys(tuple(point) for ring in rings for point in ring))
    number = {corner: index for index, corner in enumerate(corners)}
    outline, *holes = map(_area, rings)
    return {
        "id": face["id"],
        "name": f"face_{face['id']:04d}",
        "kind": kind,
        "axis": _axis(plane),
        "frame": None if plane["axis"] == "z" else plane.get("frame") or 0,  # level faces are of all frames
        "offset": _offset(plane, metres, eye),
        "normal": [looks * value for value in _normal(plane, turns)],
        "srgb": colour,
        "linear": [_linear(value) for value in colour],
        "opening": opening and opening["id"],
        "area": outline - sum(holes),
        "corners": corners,
        "rings": [[number[tuple(point)] for point in ring] for ring in rings],
    }


def _label(faces, openings):
    """Give each face what people call it: its kind, with its number among those of its kind where there are more.

    The faces of an opening are one, called by the opening's kind, and its reveals say whose they are.
    """
    things = {}
    for face in faces:
        key = ("face", face["id"]) if face["opening"] is None else ("opening", face["opening"])
        things.setdefault(key, []).append(face)
    kinds = {key: own[0]["kind"] if key[0] == "face" else openings[key[1]]["kind"] for key, own in things.items()}
    for kind in set(kinds.values()):
        alike = [own for key, own in things.items() if kinds[key] == kind]
        for number, own in enumerate(alike, start=1):
            for face in own:
                face["thing"] = kind if len(alike) == 1 else f"{kind} {number}"
                of_opening = face["opening"] is not None and face["kind"] == "reveal"
                face["label"] = f"reveal of {face['thing']}" if of_opening else face["thing"]


def _openings(faces, openings):
    """The openings that have faces, in ascending id, with the names of these."""
    found = []
    for number, opening in sorted(openings.items()):
        own = [face for face in faces if face["opening"] == number]
        if own:
            told = {"id": number, "shape": opening["shape"], "kind": opening["kind"], "label": own[0]["thing"]}
            found.append({**told, "faces": [face["name"] for face in own]})
    return found


def _area(ring):
    total = [0.0, 0.0, 0.0]
    base = ring[0]
    for a, b in zip(ring, [*ring[1:], base], strict=True):
        p, q = [x - y for x, y in zip(a, base, strict=True)], [x - y for x, y in zip(b, base, strict=True)]
        cross = (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])
        total = [sum(pair) for pair in zip(total, cross, strict=True)]
    return math.hypot(*total) / 2


def _linear(value):
    """Linear light from a channel of sRGB, IEC 61966-2-1."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def _placed(point, factor, eye):
    return [value * factor + own for value, own in zip(point, eye, strict=True)]


def _offset(plane, factor, eye):
    return plane["offset"] * factor + eye["xyz".index(plane["axis"])]


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def main(scene_file, target):
    """Read a scene file and write its expectation."""
    scene = json.loads(Path(scene_file).read_text(encoding="utf-8"))
    Path(target).write_text(json.dumps(build_expectation(scene), indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
