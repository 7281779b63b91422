"""A made scene file: a wall with a window and two equal ones set back, the ground before it, and its exports."""

import json

import pytest

from expectation import build_expectation
from exporters.formats import export
from linecad.io.scene_file import read_scene

WALL, GROUND = 10.0, -1.6  # where the planes cut y and z
LEFT, RIGHT, TOP, NEAR = -4.0, 5.0, 6.0, 6.0
WINDOW = [[0.0, WALL, 1.0], [2.0, WALL, 1.0], [2.0, WALL, 3.0], [0.0, WALL, 3.0]]
CORNERS = [[LEFT, WALL, GROUND], [RIGHT, WALL, GROUND], [RIGHT, WALL, TOP], [LEFT, WALL, TOP]]
RECESS = 0.4
SILL, HEAD = 3.5, 4.5  # of the two equal windows
NICHES = [(-3.0, -2.0), (3.0, 4.0)]  # from x to x
FLOOR = [[LEFT, NEAR, GROUND], [RIGHT, NEAR, GROUND], [RIGHT, WALL, GROUND], [LEFT, WALL, GROUND]]
FOCAL, CENTRE = 800.0, (390.3, 310.8)  # px


def line(number, start, end, boundary):
    axis = "xyz"[[a != b for a, b in zip(start, end, strict=True)].index(True)]
    segment = [[FOCAL * x / y + CENTRE[0], -FOCAL * z / y + CENTRE[1]] for x, y, z in (start, end)]
    return {"id": number, "axis": axis, "segment": segment, "ends": [start, end], "boundary": boundary,
            "component": 0, "confidence": "proven"}  # fmt: skip


def niche(x):
    return [[x[0], WALL, SILL], [x[1], WALL, SILL], [x[1], WALL, HEAD], [x[0], WALL, HEAD]]


def niche_planes():
    """The panes in a plane, and each reveal in one of its own but for the sills and the heads."""
    back = WALL + RECESS
    planes = [{"id": 3, "axis": "y", "offset": back, "lines": [], "faces": []}]
    planes += [{"id": 4 + n, "axis": "z", "offset": z, "lines": [], "faces": []} for n, z in enumerate((SILL, HEAD))]
    for number, x in enumerate(NICHES):
        pane = [[a, back, c] for a, _, c in niche(x)]
        planes[0]["faces"].append({"id": 10 + 5 * number, "outline": pane, "kind": "window", "opening": number})
        for place, z in enumerate((SILL, HEAD)):
            ring = [[x[0], WALL, z], [x[1], WALL, z], [x[1], back, z], [x[0], back, z]]
            face = {"id": 11 + place + 5 * number, "outline": ring, "kind": "reveal", "opening": number}
            planes[1 + place]["faces"].append(face)
        for place, at in enumerate(x):
            ring = [[at, WALL, SILL], [at, back, SILL], [at, back, HEAD], [at, WALL, HEAD]]
            face = {"id": 13 + place + 5 * number, "outline": ring, "kind": "reveal", "opening": number}
            planes.append({"id": 6 + place + 2 * number, "axis": "x", "offset": at, "lines": [], "faces": [face]})
    return planes


def build_openings():
    told = {"plane": 1, "kind": "window", "v": [SILL, HEAD], "recess": RECESS, "panel": WALL + RECESS, "shape": 2}
    return [{"id": number, "u": list(x), **told} for number, x in enumerate(NICHES)]


def build_scene():
    """As docs/reference/scene-file.md has it; the camera looks along y."""
    edges = [
        (start, end, ring is not WINDOW)
        for ring in (CORNERS, WINDOW, FLOOR)
        for start, end in zip(ring, ring[1:] + ring[:1], strict=True)
        if ring is not FLOOR or start[1] != end[1]
    ]
    edges.append(([LEFT, 8.0, GROUND], [RIGHT, 8.0, GROUND], False))
    return {
        "format": "linecad-scene",
        "version": 1,
        "photo": "wall.jpg",
        "camera": {
            "width": 800,
            "height": 600,
            "K": [[FOCAL, 0.0, CENTRE[0]], [0.0, FOCAL, CENTRE[1]], [0.0, 0.0, 1.0]],
            "source": "file",
            "R_cam_from_world": [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        },
        "metres_per_unit": 2.5,
        "lines": [line(3 * number + 5, *edge) for number, edge in enumerate(edges)],
        "intersections": [],
        "planes": [
            {"id": 1, "axis": "y", "offset": WALL, "lines": [],
             "faces": [{"id": 4, "outline": CORNERS, "holes": [WINDOW, *map(niche, NICHES)], "kind": "wall"}]},
            {"id": 2, "axis": "z", "offset": GROUND, "lines": [],
             "faces": [{"id": 7, "outline": FLOOR, "holes": [], "kind": "ground"}]},
            *niche_planes(),
        ],
        "openings": build_openings(),
        "solve": {"solver": "none", "formulation": "gain", "status": "optimal", "objective": 0.0, "bound": 0.0,
                  "gap": 0.0},
        "notes": [],
    }  # fmt: skip


def with_probabilities(scene):
    """The scene with lines of all bands, and one at the lower end of each."""
    for number, told in enumerate(scene["lines"]):
        told["probability"] = (0.9, 0.5, 0.499, 1.0, 0.0)[number % 5]
    return scene


def with_roles(scene):
    """The scene with lines of all roles."""
    for number, drawn in enumerate(scene["lines"]):
        drawn["role"] = ("outline", "opening", "detail")[number % 3]
    return scene


@pytest.fixture
def drawn():
    """A scene file's content that tells what its lines are drawn for."""
    return json.loads(json.dumps(with_roles(build_scene())))


@pytest.fixture
def told():
    """A scene file's content that tells how likely the depths of its lines are right."""
    return json.loads(json.dumps(with_probabilities(build_scene())))


@pytest.fixture
def document():
    return json.loads(json.dumps(build_scene()))  # which a test may change


@pytest.fixture
def expected():
    return json.loads(json.dumps(build_expectation(build_scene())))  # as a checker has it, from a file


@pytest.fixture(scope="session")
def scene_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "wall.json"
    path.write_text(json.dumps(build_scene()))
    return path


@pytest.fixture
def export_to(scene_file, tmp_path):
    """Write the scene, or that of other content, in the format of a suffix; returns the file."""

    def write(suffix, content=None, by_band=False, by_role=False):
        source = scene_file
        if content is not None:
            source = tmp_path / "other.json"
            source.write_text(json.dumps(content))
        path = tmp_path / f"wall{suffix}"
        export(read_scene(source), path, options={"probability": by_band, "roles": by_role})
        return path

    return write
