"""What an add-on must show of a photo, from the scene file and from what the command itself leaves out.

Runs in the Pythons of FreeCAD and Blender too, so it needs nothing but the standard library of Python 3.10.
"""

import json
import subprocess
import tempfile
import time
import urllib.request
from collections import Counter
from pathlib import Path

from expectation import BANDS, build_expectation

CONFIDENCE = 0.9  # at which some lines and some faces of the sample are hidden
METRES = 3.5  # that a line is said to be long
SECONDS = 120  # for a command
ROLES = {"outline": "outlines", "opening": "openings", "detail": "details"}


def read(scene_file):
    """The scene as it stands in the file."""
    return json.loads(Path(scene_file).read_text(encoding="utf-8"))


def expected_of(scene):
    """The lines by parts as add-ons name them, without the components behind the names; faces and camera."""
    return build_expectation(scene, by_band=True, by_role=True)


def kept_of(command, scene_file):
    """The same of the lines and faces that `linecad export --confidence` keeps, where they are in the whole scene."""
    with tempfile.TemporaryDirectory() as folder:
        kept_file = Path(folder) / "kept.json"
        words = [command, "export", str(scene_file), "--confidence", str(CONFIDENCE), "--quiet", "-o", str(kept_file)]
        subprocess.run(words, check=True, timeout=SECONDS, stdin=subprocess.DEVNULL)
        kept = read(kept_file)
    ids = {line["id"] for line in kept["lines"]}
    faces = {face["id"] for plane in kept["planes"] for face in plane["faces"]}
    expected = expected_of(read(scene_file))
    groups = {
        name: group | {"ids": [each for each in group["ids"] if each in ids]}
        for name, group in expected["groups"].items()
        if ids & set(group["ids"])
    }
    return expected | {
        "lines": [line for line in expected["lines"] if line["id"] in ids],
        "groups": groups,
        "faces": [face for face in expected["faces"] if face["id"] in faces],
    }


def groups_of(scene, by):
    """How many lines there are in each group by one of an add-on's groupings."""
    if by == "axis":
        names = [f"lines {line['axis']}{line['frame'] + 1 if line.get('frame') else ''}" for line in scene["lines"]]
    elif by == "role":
        names = [ROLES[line.get("role", "outline")] for line in scene["lines"]]
    elif by == "component":
        names = [f"component {line['component']}" for line in scene["lines"]]
    else:
        told = [line["probability"] for line in scene["lines"]]
        names = [next(band for band, least in BANDS.items() if value >= least) for value in told]
    return dict(Counter(names))


def correct(photo, scene):
    """Write what the page would after somebody gave the longest line a length."""
    lines = [line for line in scene["lines"] if line["component"] == 0 and not line.get("by_face")]
    longest = max(lines, key=lambda line: sum(abs(a - b) for a, b in zip(*line["segment"], strict=True)))
    edit = {"op": "length", "line": {"segment": longest["segment"], "axis": longest["axis"]}, "metres": METRES}
    size = {key: scene["camera"][key] for key in ("width", "height")}
    text = json.dumps({"format": "linecad-corrections", "version": 1, "photo": photo.name, **size, "edits": [edit]})
    photo.with_name(f"{photo.name}.corrections.json").write_text(text, encoding="utf-8")


def open_page(running):
    """The title of the page that `linecad edit` serves, once it does; `running` is the add-on's own record of it."""
    end = time.monotonic() + SECONDS
    while not running.result() and time.monotonic() < end:  # an error of the command is raised here
        time.sleep(0.05)
    address = running.result()[0]
    with urllib.request.urlopen(address, timeout=SECONDS) as page:
        return page.read().decode().partition("<title>")[2].partition("</title>")[0]
