"""Write the scene file of three houses that stand turned against each other: turned_houses.py SCENE.json

As docs/reference/scene-file.md has it, without code of linecad. The camera looks along y.
"""

import json
import math
import sys
from pathlib import Path

TURNS = (0.37, -0.21)  # rad, of the second house and of the third; the first stands along the axes
HOUSES = ((-6.0, -1.0, 14.0), (7.0, 11.0, 15.0), (-21.0, -17.0, 18.0))  # from x to x, and y of the front, in its frame
DEPTH, GROUND, EAVES = 5.0, -1.6, 4.5
WINDOW = (1.0, 2.2, 0.3, 1.8)  # from the house's corner: u from and to; the sill, the head
FOCAL, CENTRE = 700.0, (639.5, 359.5)  # px


def in_world(frame, point):
    """A point in the axes of a frame, in the world."""
    turn = TURNS[frame - 1] if frame else 0.0
    x, y, z = point
    return [x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn), z]


def pixel(point):
    """Where the photo shows a point of the world."""
    x, y, z = point
    return [FOCAL * x / y + CENTRE[0], -FOCAL * z / y + CENTRE[1]]


def build_scene():
    """The document."""
    lines, planes = [], []
    for frame, (x0, x1, y) in enumerate(HOUSES):
        side = x1 if x1 < 0 else x0  # the one that is seen
        front = [(x0, y, GROUND), (x1, y, GROUND), (x1, y, EAVES), (x0, y, EAVES)]
        flank = [(side, y, GROUND), (side, y + DEPTH, GROUND), (side, y + DEPTH, EAVES), (side, y, EAVES)]
        u0, u1, v0, v1 = WINDOW
        hole = [(x0 + u, y, v) for u, v in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))]
        edges = {
            frozenset(edge): edge
            for ring in (front, flank, hole)
            for edge in zip(ring, ring[1:] + ring[:1], strict=True)
        }
        own = [_line(len(lines) + number, frame, *edge) for number, edge in enumerate(edges.values())]
        lines += own
        for axis, offset, rings in (("y", y, (front, hole)), ("x", side, (flank,))):
            faces = [_face(3 * frame + (axis == "x"), frame, "wall", *rings)]
            if axis == "y":
                faces.append(_face(3 * frame + 2, frame, "window", hole) | {"opening": frame})
            told = [line["id"] for line in own if line["axis"] != axis and _lies_in(line, frame, axis, offset)]
            plane = {"id": len(planes), "axis": axis, "offset": offset, "lines": told, "faces": faces}
            planes.append(plane | ({"frame": frame} if frame else {}))
    ground = [(-30.0, 5.0, GROUND), (30.0, 5.0, GROUND), (30.0, 40.0, GROUND), (-30.0, 40.0, GROUND)]
    face = _face(3 * len(HOUSES), 0, "ground", ground)
    planes.append({"id": len(planes), "axis": "z", "offset": GROUND, "lines": [], "faces": [face]})
    return {
        "format": "linecad-scene",
        "version": 2,
        "photo": "houses.jpg",
        "turns": list(TURNS),
        "camera": {
            "width": 1280,
            "height": 720,
            "K": [[FOCAL, 0.0, CENTRE[0]], [0.0, FOCAL, CENTRE[1]], [0.0, 0.0, 1.0]],
            "source": "file",
            "R_cam_from_world": [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        },
        "metres_per_unit": None,
        "lines": lines,
        "intersections": [],
        "planes": planes,
        "openings": [_opening(frame) for frame in range(len(HOUSES))],
        "solve": {"solver": "none", "formulation": "gain", "status": "optimal", "objective": 0.0, "bound": 0.0,
                  "gap": 0.0},
        "notes": [],
    }  # fmt: skip


def _line(number, frame, start, end):
    axis = "xyz"[[a != b for a, b in zip(start, end, strict=True)].index(True)]
    ends = [in_world(frame, point) for point in (start, end)]
    told = {"id": number, "axis": axis, "segment": [pixel(end) for end in ends], "ends": ends, "boundary": True,
            "component": 0, "confidence": "proven"}  # fmt: skip
    return told | ({"frame": frame} if frame and axis != "z" else {})


def _face(number, frame, kind, outline, *holes):
    rings = [[in_world(frame, point) for point in ring] for ring in (outline, *holes)]
    return {"id": number, "outline": rings[0], "holes": rings[1:], "kind": kind}


def _lies_in(line, frame, axis, offset):
    turn = TURNS[frame - 1] if frame else 0.0
    along = {"x": (math.cos(turn), math.sin(turn)), "y": (-math.sin(turn), math.cos(turn))}[axis]
    return all(abs(x * along[0] + y * along[1] - offset) < 1e-9 for x, y, _ in line["ends"])


def _opening(frame):
    x0, (u0, u1, v0, v1) = HOUSES[frame][0], WINDOW
    return {"id": frame, "plane": 2 * frame, "kind": "window", "u": [x0 + u0, x0 + u1], "v": [v0, v1],
            "recess": None, "panel": None, "shape": 0}  # fmt: skip


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(json.dumps(build_scene(), indent=1), encoding="utf-8")
