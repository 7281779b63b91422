"""Put one fault into an expectation or a GLB, which every checker must notice: faults.py FAULT SOURCE TARGET"""

import json
import math
import struct
import sys
from pathlib import Path

CENTIMETRE, PIXEL = 0.01, 1.0
CHUNK = 12  # byte of a GLB at which its first chunk begins: length, kind, the document


def moved_line(expected):
    """A line is a centimetre from where the file has it, and seen there."""
    line = expected["lines"][len(expected["lines"]) // 2]
    line["ends"] = [[x + CENTIMETRE, y, z] for x, y, z in line["ends"]]


def missing_line(expected):
    """The file lacks a line."""
    line = dict(expected["lines"][-1], id=expected["lines"][-1]["id"] + 1)
    expected["lines"].append(line)
    expected["groups"][line["group"]]["ids"].append(line["id"])


def missing_face(expected):
    """The file lacks a face."""
    face = expected["faces"][-1]
    expected["faces"].append(dict(face, id=face["id"] + 1, name=f"face_{face['id'] + 1:04d}"))


def missing_wall(expected):
    """The file lacks a wall, which people call by its number."""
    number = max(face["id"] for face in expected["faces"]) + 1
    face = next(face for face in expected["faces"] if face["kind"] == "wall")
    expected["faces"].append(dict(face, id=number, name=f"face_{number:04d}", thing="wall 99", label="wall 99"))


def missing_hole(expected):
    """The file lacks a hole of a face."""
    face = max(expected["faces"], key=lambda face: len(face["rings"]))
    a, b, c = (face["corners"][number] for number in face["rings"][0][:3])
    first = len(face["corners"])
    face["corners"] += [[(x + y) / 2 for x, y in zip(p, q, strict=True)] for p, q in ((a, b), (b, c), (c, a))]
    face["rings"].append([first, first + 1, first + 2])


def wrong_camera(expected):
    """The file's camera looks a pixel aside."""
    for line in expected["lines"]:
        line["pixels"] = [[u + PIXEL, v] for u, v in line["pixels"]]


def wrong_colour(expected):
    """The lines of a group are paler in the file."""
    group = next(iter(expected["groups"].values()))
    group["srgb"], group["linear"] = ([0.9 * value for value in group[kind]] for kind in ("srgb", "linear"))


def wrong_turn(expected):
    """A frame is turned by a thousandth of a degree more."""
    expected["turns"][0] += math.radians(0.001)


def wrong_bounds(document):
    """An accessor of a GLB says a larger maximum than its numbers have, which only the validator looks at."""
    accessor = next(each for each in document["accessors"] if "max" in each)
    accessor["max"] = [value + 1.0 for value in accessor["max"]]


IN_EXPECTATION = (moved_line, missing_line, missing_face, missing_wall, missing_hole, wrong_camera, wrong_colour)
IN_TURNED = (wrong_turn,)
IN_GLB = (wrong_bounds,)


def change_glb(data, fault):
    """A GLB whose document went through `fault`."""
    length, kind = struct.unpack_from("<I4s", data, CHUNK)
    begin = CHUNK + 8
    document = json.loads(data[begin : begin + length])
    fault(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)  # chunks begin at multiples of four bytes
    body = struct.pack("<I4s", len(text), kind) + text + data[begin + length :]
    return data[:8] + struct.pack("<I", CHUNK + len(body)) + body


def main(name, source, target):
    """Write `source` with the fault of that name to `target`."""
    faults = {fault.__name__.replace("_", "-"): fault for fault in (*IN_EXPECTATION, *IN_TURNED, *IN_GLB)}
    fault, data = faults[name], Path(source).read_bytes()
    if fault in IN_GLB:
        Path(target).write_bytes(change_glb(data, fault))
    else:
        expected = json.loads(data)
        fault(expected)
        Path(target).write_text(json.dumps(expected), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
