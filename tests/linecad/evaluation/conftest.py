"""Truth records of small scenes, by brute force: every ray against every quad, every edge sampled densely."""

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest
from PIL import Image
from scipy.io import savemat

from linecad.camera.photo import Photo
from linecad.dataset.truth import NOTHING, Truth
from linecad.directions import directions_of, frame_axes
from linecad.evaluation.draughting.shapes import shapes_of
from linecad.geometry import project, world_rays
from linecad.graph.build import build_line_graph
from linecad.line_graph import ManhattanFrame, Segments
from linecad.options import SHORT_REACH
from linecad.scene import Camera, Face, Intersections, Lines, Plane, Scene, SolveReport

BIAS = 1e-3  # of the depth; a quad does not hide its own edges


def cast(quads, rays):
    """The nearest quad (N,) on each ray (N, 3), and its depth (N,)."""
    nearest, which = np.full(len(rays), np.inf), np.full(len(rays), NOTHING)
    for number, corners in enumerate(quads):
        first, second = corners[1] - corners[0], corners[3] - corners[0]
        normal = np.cross(first, second)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = normal @ corners[0] / (rays @ normal)
        to = rays * np.where(np.isfinite(depth), depth, 0)[:, None] - corners[0]
        along, up = to @ first / (first @ first), to @ second / (second @ second)
        inside = (np.abs(along - 0.5) <= 0.5) & (np.abs(up - 0.5) <= 0.5)
        hit = inside & (depth > 0) & (depth < nearest)
        nearest[hit], which[hit] = depth[hit], number
    return which, nearest


def make_truth(camera, rotation, quads, edges, name="made"):
    """The truth of rectangles (Q, 4, 3) and edges (M, 2, 3)."""
    quads, edges = np.array(quads, float), np.array(edges, float)
    row, column = np.mgrid[: camera.height, : camera.width]
    pixels = np.column_stack([column.ravel(), row.ravel()]).astype(float)
    ids, _ = cast(quads, world_rays(pixels, camera.matrix, rotation))
    pieces, piece_edge = [], []
    for number, ends in enumerate(edges):
        image = project(ends, camera.matrix, rotation)
        count = int(2 * np.linalg.norm(image[1] - image[0])) + 2
        points = image[0] + np.linspace(0, 1, count)[:, None] * (image[1] - image[0])
        rays = world_rays(points, camera.matrix, rotation)
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        onto = rays @ along
        depth = (rays @ ends[0] - onto * (along @ ends[0])) / ((rays**2).sum(axis=1) - onto**2)
        _, before = cast(quads, rays)
        inside = ((points >= 0) & (points <= [camera.width - 1, camera.height - 1])).all(axis=1)
        shown = inside & (depth <= before * (1 + BIAS))
        starts = np.flatnonzero(shown & ~np.r_[False, shown[:-1]])
        ends_at = np.flatnonzero(shown & ~np.r_[shown[1:], False])
        for start, end in zip(starts, ends_at, strict=True):
            pieces.append(points[[start, end]])
            piece_edge.append(number)
    return Truth(
        name=name, width=camera.width, height=camera.height, matrix=camera.matrix, rotation=rotation, quads=quads,
        body=np.zeros(len(quads), int), edges=edges, edge_body=np.zeros(len(edges), int),
        pieces=np.array(pieces).reshape(-1, 2, 2), piece_edge=np.array(piece_edge, int),
        ids=ids.reshape(camera.height, camera.width),
    )  # fmt: skip


def rectangle(axis, place, low, high):
    """Corners (4, 3) of the rectangle with coordinate `axis` at `place`; low and high are the two other ranges."""
    ring = [(low[0], high[0]), (low[1], high[0]), (low[1], high[1]), (low[0], high[1])]
    return np.insert(np.array(ring, float), axis, place, axis=1)


def box_faces(x, y, z):
    """The six faces of a box from its three ranges."""
    ranges = [x, y, z]
    return [
        rectangle(axis, place, *(ranges[other] for other in range(3) if other != axis))
        for axis in range(3)
        for place in ranges[axis]
    ]


def box_edges(x, y, z):
    """The twelve edges of a box."""
    ranges, edges = [x, y, z], []
    for axis in range(3):
        first, second = (other for other in range(3) if other != axis)
        for a in ranges[first]:
            for b in ranges[second]:
                ends = np.empty((2, 3))
                ends[:, axis], ends[:, first], ends[:, second] = ranges[axis], a, b
                edges.append(ends)
    return edges


@dataclass(frozen=True)
class Corner:
    """A near box before a far one on flat ground, with a thin panel on the far one's front."""

    camera: Camera
    frame: ManhattanFrame
    truth: Truth

    def segment(self, start, end):
        """The image (2, 2) of a piece of line in space."""
        return project(np.array([start, end], float), self.camera.matrix, self.frame.rotation)

    def segments(self, *lines):
        """Segments of lines, each (axis it is labelled with, start, end)."""
        return Segments([self.segment(start, end) for _, start, end in lines], [axis for axis, _, _ in lines])

    def graph(self, *lines, collinear=False):
        """The line graph of such lines; axis and direction must agree."""
        return build_line_graph(
            self.segments(*lines), self.camera, self.frame, replace(SHORT_REACH, extension=60.0), "ones", collinear
        )


NEAR = ((-3.0, -0.5), (6.0, 8.0), (-1.5, 1.0))
FAR = ((-2.5, 3.0), (10.0, 12.0), (-1.5, 1.5))
PANEL = ((1.0, 2.0), (9.92, 10.0), (-0.5, 0.5))  # 8 cm thick, which at 10 m is neither real nor fake


@pytest.fixture(scope="session")
def corner(made):
    matrix = np.array([[600.0, 0, 479.5], [0, 600.0, 319.5], [0, 0, 1]])
    camera = Camera(960, 640, matrix, "file")
    ground = [rectangle(2, -1.5, (-30.0, 30.0), (2.0, 80.0))]
    boxes = (NEAR, FAR, PANEL)
    quads = [face for box in boxes for face in box_faces(*box)] + ground
    edges = [edge for box in boxes for edge in box_edges(*box)]
    rotation = made.frame.rotation
    return Corner(camera, ManhattanFrame(rotation, 0.0, 1.0), make_truth(camera, rotation, quads, edges))


@pytest.fixture(scope="session")
def made_truth(made):
    """The truth of the made scene of two boxes; all lines of their grids are edges."""
    quads = [
        rectangle(1, 9.0, (-5.4, -2.2), (-1.6, 3.8)), rectangle(0, -2.2, (9.0, 16.0), (-1.6, 3.8)),
        rectangle(1, 7.0, (2.6, 5.6), (-1.5, 2.2)), rectangle(0, 2.6, (7.0, 11.0), (-1.5, 2.2)),
    ]  # fmt: skip
    return make_truth(made.camera, made.frame.rotation, quads, made.ends)


@pytest.fixture(scope="session")
def drawn(made):
    """A photo of the made scene with its true camera."""
    return Photo("drawn.png", np.repeat(made.image()[..., None], 3, axis=2), made.camera)


@pytest.fixture(scope="session")
def york_folder(made, drawn, tmp_path_factory):
    """The made scene as York Urban is published: two photos, one folder each, MATLAB files."""
    folder = tmp_path_factory.mktemp("york")
    focal, centre = made.camera.matrix[0, 0], made.camera.matrix[:2, 2]
    savemat(folder / "cameraParameters.mat", {"focal": focal * 0.009, "pixelSize": 0.009, "pp": centre[None] + 1})
    rotation = made.frame.rotation
    # Label 2 is vertical there; directions are columns with y up, of any sign.
    directions = np.stack([-rotation[:, 0], rotation[:, 2], rotation[:, 1]], axis=1) * [[1.0], [-1.0], [1.0]]
    label = np.array([1, 3, 2])[made.axis]
    for name in ("P1", "P2"):
        (folder / name).mkdir()
        Image.fromarray(drawn.pixels).save(folder / name / f"{name}.png")
        lines = {"lines": made.pixels.reshape(-1, 2) + 1, "vp_association": label[:, None].astype(np.uint8)}
        savemat(folder / name / f"{name}LinesAndVP.mat", lines)
        savemat(folder / name / f"{name}GroundTruthVP_Orthogonal_CamParams.mat", {"vp_orthogonal": directions})
    return folder


@pytest.fixture(scope="session")
def labels_folder(made, drawn, tmp_path_factory):
    """The made scene with labels as a person would make them: a photo, its calibration, crossings with segments."""
    folder = tmp_path_factory.mktemp("labelled")
    Image.fromarray(drawn.pixels).save(folder / "boxes.png")
    camera = {"width": made.camera.width, "height": made.camera.height, "K": made.camera.matrix.tolist()}
    (folder / "camera.json").write_text(json.dumps(camera))
    graph = made.graph(extension=100.0)
    crossings = [
        {
            "pixel": pixel,
            "segments": graph.segments.ends[[i, j]].tolist(),
            "axes": ["xyz"[graph.axis[i]], "xyz"[graph.axis[j]]],
            "label": "real" if real else "fake",
        }
        for pixel, (i, j), real in zip(
            graph.crossing.tolist(), graph.edges.tolist(), made.truly_real(graph).tolist(), strict=True
        )
    ]
    labels = {
        "format": "linecad-labels", "version": 1, "photo": "boxes.png", "camera": "camera.json", "crossings": crossings,
    }  # fmt: skip
    (folder / "boxes.json").write_text(json.dumps(labels))
    return folder


@pytest.fixture(scope="session")
def scene_of():
    """A function that makes a scene of level lines at given depths; `fields` are those of Lines, such as component."""
    camera = Camera(1000, 800, np.array([[500.0, 0, 500], [0, 500, 400], [0, 0, 1]]), "file")
    frontal = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # x right, y away, z up

    def make(depths, **fields):
        # Each runs across the photo from u = 100 to u = 900, at rows 100, 200, ...
        count = len(depths)
        segment = np.array([[[100.0, 100.0 + 100 * i], [900.0, 100.0 + 100 * i]] for i in range(count)])
        ends = np.array(depths, float)[:, None, None] * world_rays(segment, camera.matrix, frontal)
        lines = Lines(
            id=range(count), axis=np.zeros(count), segment=segment, ends=ends, is_boundary=np.zeros(count, bool),
            component=np.zeros(count), confidence=["proven"] * count,
        )  # fmt: skip
        none = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
        report = SolveReport("none", "paper", "optimal", 0.0, 0.0, 0.0)
        return Scene("a.jpg", camera, frontal, replace(lines, **fields), none, (), report)

    return make


LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # world to camera
DRAWN_BY = Camera(960, 640, [[600.0, 0, 479.5], [0, 600.0, 319.5], [0, 0, 1]], "file")


def draw_scene(lines=(), faces=(), components=None):
    """A scene before a level camera that looks along y.

    Lines are (start, end), faces (axis, offset, outline, hole ...) with rings in the coordinates of their planes.
    """
    ends = np.array(lines, float).reshape(-1, 2, 3)
    count = len(ends)
    planes = []
    for number, (axis, offset, *rings) in enumerate(faces):
        world = [np.insert(np.array(ring, float), axis, offset, axis=1) for ring in rings]
        planes.append(Plane(number, axis, offset, (), (Face(number, world[0], tuple(world[1:])),)))
    return Scene(
        "a.jpg", DRAWN_BY, LEVEL,
        Lines(
            range(count), np.abs(ends[:, 1] - ends[:, 0]).argmax(axis=1), project(ends, DRAWN_BY.matrix, LEVEL), ends,
            [False] * count, [0] * count if components is None else components, ["proven"] * count,
        ),
        Intersections(np.zeros((0, 2)), [], np.zeros((0, 2)), [], [], []), tuple(planes),
        SolveReport("none", "gain", "optimal", 0.0, 0.0, 0.0),
    )  # fmt: skip


def corners(low, high):
    """Corners of a rectangle."""
    (a, b), (c, d) = low, high
    return [(a, b), (c, b), (c, d), (a, d)]


@pytest.fixture(scope="session")
def drawing():
    """A function from lines and faces to a scene and its shapes."""

    def build(lines=(), faces=(), components=None):
        scene = draw_scene(lines, faces, components)
        return scene, shapes_of(scene)

    return build


@pytest.fixture(scope="session")
def outline():
    """A function from two opposite corners to the outline of a rectangle."""
    return corners


@pytest.fixture(scope="session")
def turned():
    """A function that turns a drawn scene and its camera about the upright, so that it is of a second frame."""

    def turn(scene, angle):
        axes = frame_axes(1)
        vectors = directions_of((angle,))[axes]

        def moved(face):
            return replace(face, outline=face.outline @ vectors, holes=tuple(hole @ vectors for hole in face.holes))

        planes = [replace(each, axis=axes[each.axis], faces=tuple(map(moved, each.faces))) for each in scene.planes]
        lines = replace(scene.lines, axis=np.array(axes)[scene.lines.axis], ends=scene.lines.ends @ vectors)
        return replace(scene, lines=lines, planes=tuple(planes), rotation=scene.rotation @ vectors, turns=(angle,))

    return turn
