"""A made scene: a house with windows and a door on an L-shaped ground, seen by a rolled camera."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from exporters.model import build_model
from linecad.scene import Camera, Face, Intersections, Lines, Opening, Plane, Scene, SolveReport

WIDTH, HEIGHT, FOCAL = 1600, 1200, 1350.0
CENTRE = (879.3, 541.8)  # px, the principal point, far from the middle of the picture
EYE = np.array([-6.5, -15.0, 5.2])  # where the camera stands before the house
TARGET = np.array([2.0, 0.0, 3.4])
ROLL = np.radians(1.5)
ACROSS = {0: (1, 2), 1: (0, 2), 2: (0, 1)}  # the two coordinates of a plane with this normal


def rectangle(low, high):
    return [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]


WINDOWS = [rectangle((1.5, 4.8), (3.2, 6.8)), rectangle((4.8, 4.8), (6.8, 6.8)), rectangle((8.4, 4.8), (10.4, 6.8))]
DOOR = [(5.2, 0), (5.2, 2.6), (6.8, 2.6), (6.8, 0)]

# axis, offset, outline and holes in the two other coordinates; the house has its corner at 0, 0, 0
FLAT = [
    (1, 0.0, [(0, 0), (2.5, 0), *DOOR, (12, 0), (12, 8), (6, 8), (0, 8), (0, 3.4)], WINDOWS),
    (0, 0.0, rectangle((0, 0), (6, 8)), [rectangle((2, 2), (4, 5))]),
    (2, 0.0, [(-4, -5), (13, -5), (13, 0), (12, 0), (0, 0), (0, 6), (-4, 6)], [rectangle((2, -4), (4, -2))]),
    *[(1, 0.3, window, []) for window in WINDOWS],
    (1, 0.3, DOOR, []),
    (2, 4.2, rectangle((8, -1.2), (11, 0)), []),
    (1, -1.2, rectangle((8, 4.2), (11, 4.9)), []),
]
KINDS = ["wall", "wall", "other", "window", "window", "window", "door", "other", "other"]
FLAT_LINES = [
    *[((0, 0, z), (12, 0, z)) for z in (3.4, 7.4)],
    *[((-4, y, 0), (13, y, 0)) for y in (-3.5, -2.0)],
    *[((x, -5, 0), (x, 6, 0)) for x in (-3.0, -1.5)],
    *[((x, 0.3, 4.8), (x, 0.3, 6.8)) for x in (2.35, 5.8, 9.4)],
]


def in_space(axis, offset, ring):
    points = np.full((len(ring), 3), float(offset))
    points[:, ACROSS[axis]] = ring
    return points - EYE


def look():
    """World to camera."""
    forward = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    upright = np.stack([right, np.cross(forward, right), forward])
    cosine, sine = np.cos(ROLL), np.sin(ROLL)
    return np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]]) @ upright


def project(scene, points):
    """px, (M, 2), as the scene counts them: from the centre of the first pixel."""
    ray = np.asarray(points).reshape(-1, 3) @ scene.rotation.T @ scene.camera.matrix.T
    return ray[:, :2] / ray[:, 2:]


def build_planes():
    planes = {}
    for number, (axis, offset, outline, holes) in enumerate(FLAT):
        rings = tuple(in_space(axis, offset, hole) for hole in holes)
        face = Face(number, in_space(axis, offset, outline), rings, KINDS[number])
        planes.setdefault((axis, offset), []).append(face)
    return [
        Plane(id=10 + number, axis=axis, offset=float(offset - EYE[axis]), lines=(), faces=tuple(faces))
        for number, ((axis, offset), faces) in enumerate(planes.items())
    ]


def build_ends(planes):
    """The distinct edges of all faces but the ground, then the lines that are no boundary."""
    edges = {}
    for plane in planes:
        for face in plane.faces:
            for ring in (face.outline, *face.holes) if plane.axis != 2 else ():
                for edge in np.stack([ring, np.roll(ring, -1, axis=0)], axis=1):
                    edges.setdefault(frozenset(map(tuple, edge.round(6).tolist())), edge)
    extra = [np.array(line) - EYE for line in FLAT_LINES]
    return np.array([*edges.values(), *extra]), len(edges)


def build_crossings(ends, segments, ids):
    """Every two lines that meet in space are real; some that cross in the picture only are fake."""
    rows = []
    for i in range(len(ends)):
        for j in range(i + 1, len(ends)):
            for a in range(2):
                for b in range(2):
                    if np.abs(ends[i, a] - ends[j, b]).max() < 1e-9:
                        rows.append(((ids[i], ids[j]), "L", segments[i, a], True))
            if (i + j) % 5 == 0 and (pixel := crossing(segments[i], segments[j])) is not None:
                rows.append(((ids[i], ids[j]), "X", pixel, False))
    return Intersections(
        lines=[row[0] for row in rows],
        kind=[row[1] for row in rows],
        pixel=[row[2] for row in rows],
        real=[row[3] for row in rows],
        in_tree=[False] * len(rows),
        weight=[1.0] * len(rows),
    )


def crossing(first, second):
    """Where two segments cross inside both, or None."""
    along, across = first[1] - first[0], second[1] - second[0]
    base = along[0] * across[1] - along[1] * across[0]
    if abs(base) < 1e-6:
        return None
    start = second[0] - first[0]
    s = (start[0] * across[1] - start[1] * across[0]) / base
    t = (start[0] * along[1] - start[1] * along[0]) / base
    return first[0] + s * along if 0.05 < s < 0.95 and 0.05 < t < 0.95 else None


@pytest.fixture(scope="session")
def scene():
    planes = build_planes()
    ends, boundaries = build_ends(planes)
    count = len(ends)
    rng = np.random.default_rng(1)
    ids = rng.permutation(100 + 7 * np.arange(count))  # neither contiguous nor ascending
    camera = Camera(WIDTH, HEIGHT, [[FOCAL, 0, CENTRE[0]], [0, FOCAL, CENTRE[1]], [0, 0, 1]], "file")
    rotation = look()
    ray = ends @ rotation.T @ camera.matrix.T
    segments = ray[..., :2] / ray[..., 2:]
    lines = Lines(
        id=ids,
        axis=np.abs(ends[:, 1] - ends[:, 0]).argmax(axis=1),
        segment=segments,
        ends=ends,
        is_boundary=np.arange(count) < boundaries,
        component=np.where(np.arange(count) == count - 1, 1, 0),
        confidence=["supported"] * count,
    )
    on_plane = [np.abs(ends[:, :, plane.axis] - plane.offset).max(axis=1) < 1e-9 for plane in planes]
    return Scene(
        photo="Häuschen 家.jpg",
        camera=camera,
        rotation=rotation,
        lines=lines,
        intersections=build_crossings(ends, segments, ids),
        planes=tuple(replace(p, lines=tuple(ids[on].tolist())) for p, on in zip(planes, on_plane, strict=True)),
        solve=SolveReport("SCIP 10.0", "paper", "optimal", 120.5, 120.5, 0.0),
        metres_per_unit=1.0,
    )


@pytest.fixture(scope="session")
def photo(scene):
    """RGB: a sky, and the faces of the scene painted from far to near."""
    rng = np.random.default_rng(2)
    rows = np.linspace(0, 1, HEIGHT)[:, None, None]
    picture = (np.array([120, 160, 215]) * (1 - rows) + np.array([225, 228, 230]) * rows).repeat(WIDTH, axis=1)
    picture = np.ascontiguousarray(picture, dtype=np.uint8)
    stone = [(205, 190, 165), (176, 160, 140), (118, 132, 104), *[(70, 85, 110)] * 3, (96, 70, 52), (190, 190, 186)]
    for number in (2, 3, 4, 5, 6, 0, 1, 7, 8):
        face = next(face for _, face in scene.faces if face.id == number)
        rings = [np.round(project(scene, ring) * 16).astype(np.int32) for ring in (face.outline, *face.holes)]
        cv2.fillPoly(picture, rings, stone[number % len(stone)], cv2.LINE_AA, 4)
    noise = rng.normal(0, 6, (HEIGHT, WIDTH, 1))
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


@pytest.fixture(scope="session")
def model(scene):
    return build_model(scene)


@pytest.fixture(scope="session")
def line_ends(scene):
    """Line id -> its two ends (2, 3) in m."""
    return dict(zip(scene.lines.id.tolist(), scene.lines.ends, strict=True))


@pytest.fixture(scope="session")
def line_pixels(scene):
    """Line id -> its two ends (2, 2) in the photo, counted from the corner of the photo as other programs do."""
    return dict(zip(scene.lines.id.tolist(), scene.lines.segment + 0.5, strict=True))


@pytest.fixture(scope="session")
def told(scene):
    """The scene with the probabilities of its lines: each axis has boundaries of all bands."""
    probability = np.resize([0.99, 0.7, 0.2], len(scene.lines))
    return replace(scene, lines=replace(scene.lines, probability=probability))


@pytest.fixture(scope="session")
def no_faces(scene):
    return replace(scene, planes=())


@pytest.fixture(scope="session")
def one_line(scene):
    lines = scene.lines
    first = {name: getattr(lines, name)[:1] for name in ("id", "axis", "segment", "ends", "is_boundary", "component")}
    empty = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
    return replace(scene, lines=Lines(**first, confidence=["weak"]), intersections=empty, planes=())


@pytest.fixture(scope="session")
def no_lines(scene):
    names = ("id", "axis", "segment", "ends", "is_boundary", "component", "confidence")
    empty = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
    planes = tuple(replace(plane, lines=()) for plane in scene.planes)
    lines = Lines(**{name: getattr(scene.lines, name)[:0] for name in names})
    return replace(scene, lines=lines, intersections=empty, planes=planes)


@pytest.fixture(scope="session")
def grounded(scene):
    """The scene with a ground, EYE's height below the camera: its exports have that at z = 0."""
    planes = [
        replace(plane, faces=tuple(replace(face, kind="ground") if face.id == 2 else face for face in plane.faces))
        for plane in scene.planes
    ]
    return replace(scene, planes=tuple(planes))


@pytest.fixture(scope="session")
def free_unit(scene):
    return replace(scene, metres_per_unit=None)


@pytest.fixture(scope="session")
def large_ids(scene):
    """The scene with ids that neither 32 bits nor a float32 hold."""
    empty = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
    planes = tuple(
        replace(plane, lines=(), faces=tuple(replace(face, id=face.id + 2**35) for face in plane.faces))
        for plane in scene.planes
    )
    return replace(scene, lines=replace(scene.lines, id=scene.lines.id + 2**40), intersections=empty, planes=planes)


ROW = [(1.5, 4.8), (4.8, 4.8), (8.4, 4.8)]  # lower left corners of three equal windows in the wall at y = 0
SIZE, DEPTH = (1.2, 1.6), 0.25  # m: width and height, and how far the panes stand behind the wall


def build_row():
    """The faces of the windows of ROW by plane (axis, offset), and the openings; faces count from 0, five a window."""
    flat, openings = {}, []
    for number, (u, z) in enumerate(ROW):
        right, top = u + SIZE[0], z + SIZE[1]
        told = [(1, DEPTH, rectangle((u, z), (right, top)), "window")]
        told += [(0, at, rectangle((0, z), (DEPTH, top)), "reveal") for at in (u, right)]
        told += [(2, at, rectangle((u, 0), (right, DEPTH)), "reveal") for at in (z, top)]
        for place, (axis, offset, ring, kind) in enumerate(told):
            face = Face(5 * number + place, in_space(axis, offset, ring), (), kind, opening=number)
            flat.setdefault((axis, offset), []).append(face)
        low, high = np.array([u, z]) - EYE[[0, 2]], np.array([right, top]) - EYE[[0, 2]]
        sides = (low[0], high[0], low[1], high[1])
        openings.append(Opening(number, 11, *sides, "window", DEPTH, DEPTH - EYE[1], shape=4))
    return flat, openings


@pytest.fixture(scope="session")
def row(scene):
    """A scene of a wall with three equal windows that are set back, faces 0 to 14, and a ground, face 16."""
    flat, openings = build_row()
    holes = tuple(in_space(1, 0.0, rectangle(at, (at[0] + SIZE[0], at[1] + SIZE[1]))) for at in ROW)
    flat[1, 0.0] = [Face(15, in_space(1, 0.0, rectangle((0, 0), (12, 8))), holes, "wall")]
    flat[2, 0.0] = [Face(16, in_space(2, 0.0, rectangle((-4, -5), (13, 0))), (), "ground")]
    planes = []
    for number, ((axis, offset), faces) in enumerate(flat.items()):
        identity = 11 if (axis, offset) == (1, 0.0) else 20 + number
        planes.append(Plane(identity, axis, float(offset - EYE[axis]), lines=(), faces=tuple(faces)))
    empty = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
    return replace(scene, planes=tuple(planes), intersections=empty, openings=tuple(openings), metres_per_unit=None)
