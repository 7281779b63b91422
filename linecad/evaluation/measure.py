"""Everything that is measured on one photo, in one record."""

import base64
from dataclasses import asdict, dataclass, field
from typing import Any

import cv2
import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.camera.photo import Photo
from linecad.depth.depth_map import DepthMap
from linecad.depth.for_photo import open_depth_map
from linecad.directions import MAIN, UP
from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case
from linecad.evaluation.decisions import Decisions, GraphStatistics, compare, count
from linecad.evaluation.drawing import DrawingScore, score_drawing
from linecad.evaluation.frames import nearest_axes, true_axes
from linecad.evaluation.gallery import draw_places
from linecad.evaluation.labels import FAKE, REAL
from linecad.evaluation.methods import ROWS, Run, Settings, proven_gap, run_method
from linecad.evaluation.overlap import find_overlaps, union_length
from linecad.evaluation.planes import PlaneScore, score_planes
from linecad.evaluation.references import MarkedLines, Reference, open_case
from linecad.evaluation.scopes import SceneScore, score_scene
from linecad.evaluation.turned.panels import write_panels
from linecad.finding import FoundLines, connect, find_lines
from linecad.geometry import angle_between_frames
from linecad.line_graph import Formulation, LineGraph
from linecad.pipeline import reconstruct_lines
from linecad.scene import Scene

MARKED_REACH = 3.0  # px between a line marked by hand and a reconstructed one
MARKED_ANGLE = np.radians(3.0)
TURNED = ".jpg"
PICTURE_WIDTH = 720  # px
PICTURE_QUALITY = 75


@dataclass(frozen=True)
class MarkedScore:
    """Reconstructed lines against lines marked by hand."""

    right_axes: int  # marked lines whose nearest axis is the marked one
    lines: int
    covered: float  # px of marked lines along which a reconstructed line of the same axis runs
    length: float  # px of marked lines


@dataclass(frozen=True)
class WholeResult:
    """A photo reconstructed at the default settings, against all that is known about it."""

    lines: int
    planes: int
    seconds: float  # s, of the solver
    status: str
    gap: float | None  # None: nothing was proven
    decisions: Decisions | None  # the final ones, as in the scene; None where no crossing has a label
    rotation_error: float | None  # degrees
    depth: SceneScore | None
    plane_score: PlaneScore | None  # of component 0
    marked: MarkedScore | None
    drawing: DrawingScore


@dataclass(frozen=True)
class Picture:
    """What the report shows of a photo, in its own pixels."""

    width: int
    height: int
    jpeg: str  # base64
    lines: list[tuple[int, int, int, int, int]]  # both ends, and the axis
    fake_taken: list[tuple[int, int]]  # crossings called real that are fake
    real_missed: list[tuple[int, int]]


@dataclass(frozen=True)
class PhotoResult:
    """All measures of one photo, or why there are none."""

    name: str
    error: str | None = None
    statistics: GraphStatistics | None = None  # of the graph of table 1
    methods: dict[Formulation, dict[str, Run]] = field(default_factory=dict)  # by formulation, by row of table 1
    whole: WholeResult | None = None
    picture: Picture | None = None
    places: str | None = None  # SVG of the gallery
    depth_map: str | None = None  # name of the file that the default settings were given; None: they had no map

    def document(self) -> dict[str, Any]:
        """The record as JSON, without the pictures."""
        values = asdict(self)
        del values["picture"], values["places"]
        return values


def measure_photo(case: Case, settings: Settings) -> PhotoResult:
    """Measure one photo; a photo that cannot be used or reconstructed gives a result with the error."""
    try:
        photo, reference = open_case(case)
        depth = None if case.depth is None else open_depth_map(case.depth, photo, settings.reconstruction)
        return measure(case.name, photo, reference, settings, depth)
    except LinecadError as error:
        return PhotoResult(case.name, str(error))


def measure(
    name: str, photo: Photo, reference: Reference, settings: Settings, depth: DepthMap | None = None
) -> PhotoResult:
    """Measure a photo, with a depth map on its pixels or without, against its reference.

    Raises ReconstructionError or SolverError.
    """
    found = find_lines(photo, faint=settings.reconstruction.faint)
    statistics: GraphStatistics | None = None
    methods: dict[Formulation, dict[str, Run]] = {}
    if reference.has_labels:
        everything, graph = connect(found, settings.paper_graph())
        label = reference.label(graph, found.camera, found.frame.axes)
        statistics = count(graph, label)
        length = float(everything.segments.length.sum())
        if settings.ablation:
            methods = {
                formulation: {
                    row: run_method(graph, formulation, row, label, length, settings) for row in ROWS[formulation]
                }
                for formulation in settings.formulations
            }
    whole, picture, places = _whole(name, photo, found, reference, settings, depth)
    used = None if depth is None else depth.name
    return PhotoResult(name, None, statistics, methods, whole, picture, places, used)


def _whole(
    name: str, photo: Photo, found: FoundLines, reference: Reference, settings: Settings, depth_map: DepthMap | None
) -> tuple[WholeResult, Picture | None, str | None]:
    made = reconstruct_lines(photo.name, found, settings.reconstruction, depth=depth_map)
    graph, solution, scene = made.graph, made.solution, made.scene
    label = reference.label(graph, found.camera, found.frame.axes)
    length = float(made.whole.segments.length.sum())
    depth = None if reference.edges is None else score_scene(scene, reference.edges, reference.dense)
    scale = None if depth is None else depth.component_0.lines.scale
    result = WholeResult(
        lines=len(scene.lines),
        planes=len(scene.planes),
        seconds=solution.seconds,
        status=solution.status,
        gap=proven_gap(solution),
        decisions=compare(graph, made.decision.real, made.lifted.residual, label, length, graph.informative)
        if reference.has_labels
        else None,
        rotation_error=_rotation_error(reference, scene),
        depth=depth,
        plane_score=None if reference.truth is None or scale is None else score_planes(scene, reference.truth, scale),
        marked=None if reference.lines is None else _marked(reference, reference.lines, scene),
        drawing=score_drawing(scene, reference, None if depth is None else depth.face_scale),
    )
    if settings.turned is not None:
        write_panels(scene, photo.pixels, name, settings.turned / f"{name}{TURNED}")
    if not settings.pictures:
        return result, None, None
    places = None if scale is None else draw_places(scene, reference, scale)
    return result, _picture(photo, graph, made.decision.real, label), places


def _rotation_error(reference: Reference, scene: Scene) -> float | None:
    if reference.rotation is None:
        return None
    return float(np.degrees(angle_between_frames(scene.rotation, reference.rotation)[0]))


def covered_length(marked: Float, marked_axis: Int, lines: Float, axis: Int) -> float:
    """Length, px, of marked lines (M, 2, 2) along which lines (N, 2, 2) of the same axis run within MARKED_REACH."""
    covered = 0.0
    for ends, own in zip(marked, marked_axis.tolist(), strict=True):
        along = find_overlaps(ends, lines[axis == own], MARKED_REACH, MARKED_ANGLE)
        covered += union_length(along.start, along.end)
    return covered


def _marked(reference: Reference, marked: MarkedLines, scene: Scene) -> MarkedScore:
    """Coverage and labels of lines that were marked by hand (method: the same axis, within MARKED_REACH)."""
    assert reference.rotation is not None  # who marks lines by axis knows the axes
    names = true_axes(scene.rotation, reference.rotation)
    axis = np.where(scene.lines.axis < MAIN, names[np.minimum(scene.lines.axis, UP)], scene.lines.axis)
    nearest = names[nearest_axes(marked.ends, scene.camera.matrix, scene.rotation)]
    covered = covered_length(marked.ends, marked.axis, scene.lines.segment, axis)
    length = float(np.linalg.norm(marked.ends[:, 1] - marked.ends[:, 0], axis=1).sum())
    return MarkedScore(int((nearest == marked.axis).sum()), len(marked.axis), covered, length)


def _picture(photo: Photo, graph: LineGraph, chosen: Bool, label: Int) -> Picture:
    scale = min(1.0, PICTURE_WIDTH / photo.width)
    size = (max(1, round(photo.width * scale)), max(1, round(photo.height * scale)))
    small = cv2.resize(photo.pixels, size, interpolation=cv2.INTER_AREA)
    _, data = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, PICTURE_QUALITY])

    def points(which: Bool) -> list[tuple[int, int]]:
        return [(round(x), round(y)) for x, y in (graph.crossing[which] * scale).tolist()]

    return Picture(
        width=size[0],
        height=size[1],
        jpeg=base64.b64encode(data.tobytes()).decode("ascii"),
        lines=[
            (round(a), round(b), round(c), round(d), axis)
            for (a, b, c, d), axis in zip(
                (graph.segments.ends.reshape(-1, 4) * scale).tolist(), graph.axis.tolist(), strict=True
            )
        ],
        fake_taken=points(chosen & (label == FAKE)),
        real_missed=points(~chosen & (label == REAL)),
    )
