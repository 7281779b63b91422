"""The truth about one photo, from each known format, in one record; what a format does not tell stays None."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import assert_never

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.camera.distortion import open_photo
from linecad.camera.intrinsics import read_calibration, undistort_points
from linecad.camera.photo import Photo, read_photo, read_photo_of
from linecad.dataset.store import CAMERA, read_truth
from linecad.dataset.truth import NOTHING, Truth
from linecad.errors import DatasetError
from linecad.evaluation.datasets import Case, read_json
from linecad.evaluation.labels import FAKE, REAL, UNDECIDED, label_crossings
from linecad.evaluation.marks import UNKNOWN_AXIS, MarkedCrossings, label_by_marks
from linecad.io.strict_json import JsonError, Node
from linecad.line_graph import LineGraph
from linecad.scene import AXES, Camera

POINT_STEP = 40.0  # px between the points that are sampled on true edges
GRID = 96  # columns of the grid of pixels for the dense measure
MANHATTAN = np.cos(np.radians(1.0))  # of the angle between a true edge and its axis
SURE_REAL, SURE_FAKE = 0.005, 0.03  # relative gap of surveyed depths at a crossing: below it real, above it fake
LABELS = {"real": REAL, "fake": FAKE, "unsure": UNDECIDED}


@dataclass(frozen=True, eq=False)
class Points:
    """Pixels of the undistorted photo with their true camera depths."""

    pixels: Float  # (M, 2) px
    depth: Float  # (M,) in the truth's unit


@dataclass(frozen=True, eq=False)
class MarkedLines:
    """Lines that were marked in the photo with the axis each runs along."""

    ends: Float  # (M, 2, 2) px
    axis: Int  # (M,) column of the reference's rotation


@dataclass(frozen=True, eq=False)
class Reference:
    """What is known about one photo."""

    rotation: Float | None = None  # (3, 3) columns are the true axes in the camera frame, of free sign and order
    edges: Points | None = None  # on visible Manhattan edges
    dense: Points | None = None  # anywhere
    lines: MarkedLines | None = None
    marks: MarkedCrossings | None = None
    truth: Truth | None = None

    @property
    def has_labels(self) -> bool:
        """Whether crossings can be told real from fake."""
        return self.truth is not None or self.marks is not None

    def label(self, graph: LineGraph, camera: Camera, axes: Float) -> Int:
        """REAL, FAKE or UNDECIDED for each crossing (E,); all undecided where nothing is known."""
        if self.truth is not None:
            return label_crossings(self.truth, graph, axes)
        if self.marks is not None:
            return label_by_marks(self.marks, graph, camera)
        return np.full(len(graph.edges), UNDECIDED, np.int64)


def open_case(case: Case) -> tuple[Photo, Reference]:
    """The photo of a case, undistorted, and its truth in the pixels of that photo.

    Raises PhotoError, CameraError or DatasetError for files that cannot be used.
    """
    try:
        match case.kind:
            case "made":
                return _made(case)
            case "york":
                from linecad.evaluation.york import read_york

                found = read_york(case.truth, case.name)
                photo = read_photo(case.photo)
                camera = Camera(photo.width, photo.height, found.matrix, "file")
                return replace(photo, camera=camera, notes=()), Reference(
                    rotation=found.directions, lines=MarkedLines(found.ends, found.axis)
                )
            case "york-json":
                return _york_json(case)
            case "points":
                return _points(case)
            case "lines":
                return _lines(case)
            case "labels":
                return _labels(case)
            case _:
                assert_never(case.kind)
    except JsonError as error:
        raise DatasetError(f"{case.truth}: {error}; see docs/reference/evaluation.md") from error


def _made(case: Case) -> tuple[Photo, Reference]:
    photo = read_photo(case.photo, case.truth / CAMERA)
    truth = read_truth(case.truth)
    if (photo.width, photo.height) != (truth.width, truth.height):
        raise DatasetError(
            f"{case.photo} has {photo.width} x {photo.height} px, its truth {truth.width} x {truth.height}; "
            "make the dataset again"
        )
    return photo, reference_of(truth)


def reference_of(truth: Truth) -> Reference:
    """Everything that the truth of a made photo tells."""
    return Reference(rotation=truth.rotation, edges=_on_edges(truth), dense=_on_grid(truth), truth=truth)


def _on_edges(truth: Truth) -> Points:
    """Points every POINT_STEP px on the visible pieces of edges that run along an axis, or that a frame has."""
    along = truth.edges[:, 1] - truth.edges[:, 0]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    counted = np.abs(along).max(axis=1) >= MANHATTAN
    if truth.frames is not None:
        counted |= truth.frames.edge != NOTHING
    pixels, edges = [np.zeros((0, 2))], [np.zeros(0, np.int64)]
    for ends, edge in zip(truth.pieces, truth.piece_edge.tolist(), strict=True):
        count = int(np.linalg.norm(ends[1] - ends[0]) / POINT_STEP)
        if counted[edge] and count > 0:
            at = (np.arange(count) + 0.5) / count
            pixels.append(ends[0] + at[:, None] * (ends[1] - ends[0]))
            edges.append(np.full(count, edge))
    where, which = np.concatenate(pixels), np.concatenate(edges)
    rays, unit, start = truth.rays(where), along[which], truth.edges[which, 0]
    # The point of each ray that is nearest to its edge.
    onto = (rays * unit).sum(axis=1)
    depth = ((rays * start).sum(axis=1) - onto * (unit * start).sum(axis=1)) / ((rays**2).sum(axis=1) - onto**2)
    return Points(where, depth)


def _on_grid(truth: Truth) -> Points:
    pixels = pixel_grid(truth.width, truth.height, GRID)
    quads = truth.quad_at(pixels)
    shown = quads != NOTHING
    return Points(pixels[shown], truth.quad_depth(pixels[shown], quads[shown]))


def pixel_grid(width: int, height: int, columns: int) -> Float:
    """(M, 2) px, one pixel of each of `columns` columns of squares over a photo."""
    step = width / columns
    column, row = np.meshgrid(np.arange(step / 2, width, step), np.arange(step / 2, height, step))
    pixels: Float = np.floor(np.column_stack([column.ravel(), row.ravel()]))
    return pixels


def _york_json(case: Case) -> tuple[Photo, Reference]:
    top = read_json(case.truth)
    ends = np.array([[line["p"].array(2), line["q"].array(2)] for line in top["lines"].items()]).reshape(-1, 2, 2)
    axis = np.array([line["label"].integer(1, 3) - 1 for line in top["lines"].items()], np.int64)
    directions = top["vp_dirs_orthogonal"].array(3, 3).T
    photo, straight = _read_with_points(case, ends.reshape(-1, 2))
    return photo, Reference(rotation=directions, lines=MarkedLines(straight.reshape(-1, 2, 2), axis))


def _points(case: Case) -> tuple[Photo, Reference]:
    """Rows u, v in px, X, Y, Z in the camera frame; `on_line` names the rows that lie on Manhattan segments."""
    top = read_json(case.truth)
    rows = [row.array(None) for row in top["points"].items()]
    if not rows or min(map(len, rows)) < 5:
        raise JsonError("points has a row of fewer than 5 numbers, or no row")
    table = np.array([row[:5] for row in rows])
    if not (table[:, 4] > 0).all():
        raise JsonError(f"points[{int(np.argmin(table[:, 4]))}] lies behind the camera")
    on_line = top.get("on_line")
    chosen = (
        np.arange(len(table))
        if on_line is None
        else np.array([node.integer(0, len(table) - 1) for node in on_line.items()], np.int64)
    )
    photo, straight = _read_with_points(case, table[:, :2])
    return photo, Reference(
        rotation=_rotation(top),
        edges=_known(straight[chosen], table[chosen, 4]),
        dense=_known(straight, table[:, 4]),
    )


def _lines(case: Case) -> tuple[Photo, Reference]:
    """Lines with both ends in the image and in the camera frame, and crossings with the depths of their two lines."""
    top = read_json(case.truth)
    image = np.array([[line["p"].array(2), line["q"].array(2)] for line in top["lines"].items()]).reshape(-1, 2, 2)
    space = np.array([[line["P_cam"].array(3), line["Q_cam"].array(3)] for line in top["lines"].items()])
    axis = np.array([line["label"].integer(-1, 2) for line in top["lines"].items()], np.int64)
    pairs = [(c["i"].integer(0, len(image) - 1), c["j"].integer(0, len(image) - 1)) for c in top["crossings"].items()]
    gap = np.array([c["rel_gap"].number() for c in top["crossings"].items()])
    place = np.array([c["xy"].array(2) for c in top["crossings"].items()]).reshape(-1, 2)
    matrix = top["K"].array(3, 3)
    sampled = [_along(space[line], matrix, image[line]) for line in np.flatnonzero(axis >= 0)]
    points = np.concatenate([np.zeros((0, 3)), *sampled])
    photo, straight = _read_with_points(case, np.concatenate([points[:, :2], place, image.reshape(-1, 2)]))
    here, there = len(points), len(points) + len(place)
    ends = straight[there:].reshape(-1, 2, 2)
    which = np.array(pairs, np.int64).reshape(-1, 2)
    marks = MarkedCrossings(
        pixel=straight[here:there],
        segments=ends[which],
        axis=np.full(which.shape, UNKNOWN_AXIS),
        label=np.where(gap < SURE_REAL, REAL, np.where(gap > SURE_FAKE, FAKE, UNDECIDED)),
    )
    return photo, Reference(rotation=_rotation(top), edges=_known(straight[:here], points[:, 2]), marks=marks)


def _along(space: Float, matrix: Float, image: Float) -> Float:
    """Points (M, 3) on a line in space, evenly spaced in the image: u, v and depth."""
    count = max(2, int(np.linalg.norm(image[1] - image[0]) / POINT_STEP))
    at = np.linspace(0.1, 0.9, count)  # not at the ends, which two reconstructions rarely share
    # The share of the far end grows with its nearness.
    share = at * space[0, 2] / (at * space[0, 2] + (1 - at) * space[1, 2])
    points = space[0] + share[:, None] * (space[1] - space[0])
    shown = points @ matrix.T
    return np.column_stack([shown[:, :2] / shown[:, 2:], points[:, 2]])


def _labels(case: Case) -> tuple[Photo, Reference]:
    """Labels made by hand, format linecad-labels."""
    top = read_json(case.truth)
    top["version"].integer(1, 1)
    crossings = top["crossings"].items()
    marks = MarkedCrossings(
        pixel=np.array([c["pixel"].array(2) for c in crossings]).reshape(-1, 2),
        segments=np.array([c["segments"].array(2, 2, 2) for c in crossings]).reshape(-1, 2, 2, 2),
        axis=np.array([_axes(c["axes"]) for c in crossings], np.int64).reshape(-1, 2),
        label=np.array([LABELS[c["label"].one_of(tuple(LABELS))] for c in crossings], np.int64),
    )
    return _labelled_photo(case, top.get("camera")), Reference(marks=marks)


def _axes(node: Node) -> list[int]:
    names = node.items()
    if len(names) != 2:
        raise node.wrong("a list of 2")
    return [AXES.index(name.one_of(tuple(AXES))) for name in names]


def _labelled_photo(case: Case, camera: Node | None) -> Photo:
    """The photo with the camera that the labels name: a calibration beside them, a matrix, or none."""
    if camera is None or camera.value is None:
        return open_photo(case.photo)
    if isinstance(camera.value, str):
        if Path(camera.value).name != camera.value:
            raise camera.wrong("the name of a file beside the labels")
        return read_photo(case.photo, case.truth.with_name(camera.value))
    matrix = camera["K"].array(3, 3)
    photo = read_photo(case.photo)
    bent = camera.get("distortion")
    distortion = () if bent is None else tuple(bent.array(None).tolist())
    try:
        given = Camera(photo.width, photo.height, matrix, "file", distortion)
        return replace(read_photo_of(case.photo, given) if distortion else photo, camera=given, notes=())
    except ValueError as error:
        raise JsonError(f"camera.K is no camera matrix: {error}") from error


def _rotation(top: Node) -> Float | None:
    node = top.get("R_cam_from_manhattan")
    return None if node is None else node.array(3, 3)


def _read_with_points(case: Case, pixels: Float) -> tuple[Photo, Float]:
    """The undistorted photo, and where pixels (M, 2) of the truth lie in it.

    Without a camera file the truth is one, and its pixels are those of the photo as taken.
    """
    if case.camera is not None:
        return read_photo(case.photo, case.camera), pixels
    photo = read_photo(case.photo, case.truth)
    calibration = read_calibration(case.truth)
    straight = undistort_points(pixels, calibration.matrix, calibration.distortion, calibration.square_matrix)
    return photo, straight


def _known(pixels: Float, depth: Float) -> Points:
    """The points that the undistorted photo has a place for."""
    known: Bool = np.asarray(np.isfinite(pixels).all(axis=1))
    return Points(pixels[known], depth[known])
