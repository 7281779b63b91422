"""Photos of known depth with their bodies, the candidates between them and what is true of these; used by ties.py."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from bare_scene import scene_of_lines
from depth_truth import TrueDepth, true_depth
from feet_truth import examples_of
from views import changed

from linecad.arrays import Float, Int
from linecad.decide.stability import resample
from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case
from linecad.evaluation.depth import NO_LINE, depths_of, nearest_lines, score
from linecad.evaluation.references import Reference, open_case
from linecad.finding import FoundLines, connect, find_lines
from linecad.options import LONG_REACH, Options
from linecad.scene import Camera, Lines
from linecad.ties.bodies import RigidBodies, find_rigid_bodies
from linecad.ties.candidates import Candidate, find_candidates
from linecad.ties.evidence import FITS
from linecad.ties.looks import Looks
from linecad.ties.pieces import Pieces, find_pieces
from linecad.ties.seams import Seam, find_seams
from linecad.ties.setting import Setting, Sight
from solver.robust import RobustFit

PARTED = ", parts"  # after the name of a dataset
WIDTH = 0.02  # log scale, half of the window whose points give a body its true scale
LEAST_POINTS, LEAST_AGREEING, AGREEING = 6, 0.6, 0.05
LEAST_AGREED, AGREED = 3, 0.03  # bodies whose feet are the ground of a real photo; log height


@dataclass(frozen=True, eq=False)
class Judged:
    """A photo with its candidates, and what is true of them."""

    dataset: str
    scene: str
    setting: Setting  # without pixels
    candidates: list[Candidate]
    on: Int  # (P,) the line that shows each point of known depth, NO_LINE for none
    log_factor: Float  # (P,) log depth of the point where its line has log depth 0
    log_true: Float  # (P,)
    true_scale: Float  # (B + 1,) log, that of the ground last; NaN where the points do not tell
    true_depth: TrueDepth  # of the photo's pixels
    seams: list[tuple[Seam, float]]  # with by how much the true log scales of their sides differ; NaN where not known
    pieces: Pieces
    true_pieces: Float  # (Q,) log scale of each, as true_scale

    @property
    def is_part(self) -> bool:
        """Whether it is a part of a photo, not a whole one."""
        return self.dataset.endswith(PARTED)

    @property
    def is_made(self) -> bool:
        """Whether it was rendered, and is a scene of its own."""
        return "/" in self.scene

    @cached_property
    def seen(self) -> Int:
        """The points that lines of bodies show."""
        lines = np.flatnonzero(self.setting.bodies.body >= 0)
        return np.flatnonzero(np.isin(self.on, lines))

    def error_of(self, candidate: Candidate) -> float:
        """Log ratio; NaN where it is not known."""
        first, second = candidate.bodies
        return float(abs(self.true_scale[first] - self.true_scale[second] - candidate.log_ratio))

    def score(self, log_depth: Float) -> tuple[float, float]:
        """Recall and precision at 5 % of all lines of bodies at log depths (N,)."""
        found, seen = np.full(len(self.on), np.nan), self.seen
        found[seen] = np.exp(log_depth[self.on[seen]] + self.log_factor[seen])
        result = score(found, np.exp(self.log_true))
        return result.recall_5, result.precision_5


@dataclass(frozen=True, eq=False)
class Seen:
    """A photo with its bodies, and the points whose depth is known."""

    setting: Setting
    camera: Camera
    reference: Reference
    on: Int  # (P,) as in Judged
    log_factor: Float  # (P,)
    log_true: Float  # (P,)
    true_scale: Float  # (B,) log, NaN where the points do not tell


def look_at(case: Case, part: str | None = None) -> Seen | None:
    """The photo of a case, or a part or view of it; None where it has no lines in space, or its truth no depths."""
    photo, reference = open_case(case)
    if part is not None:
        photo, reference = changed(photo, reference, part)
    if reference.edges is None:
        return None
    try:
        found = find_lines(photo)
        graph = connect(found, Options(reach=LONG_REACH))[1]
    except LinecadError as error:
        print(f"{case.name}: {error}", flush=True)
        return None
    log_depth = RobustFit(graph).depths()
    fits = resample(graph, 0, FITS)
    bodies = find_rigid_bodies(graph, log_depth, fits)
    sight = Sight(found.camera.matrix, found.frame.axes, found.camera.width, found.pixels)
    setting = Setting(graph, log_depth, bodies, fits, sight)
    on, log_factor = lines_at(setting, found, reference.edges.pixels)
    log_true = np.log(reference.edges.depth)
    return Seen(
        setting, found.camera, reference, on, log_factor, log_true, true_scales(setting, on, log_true - log_factor)
    )


def scene_of(dataset: str, case: Case) -> str:
    """What is left out at a time: a made scene, or a real place with all its photos."""
    return f"{dataset}/{case.name}" if case.kind == "made" else dataset


def judge(dataset: str, case: Case, part: str | None = None) -> Judged | None:
    """The photo of a case, or a part of it, with its candidates; None where `look_at` sees nothing."""
    seen = look_at(case, part)
    if seen is None:
        return None
    setting, scene = seen.setting, scene_of(dataset, case)
    looks = Looks(setting)
    seams = find_seams(setting, looks)
    pieces = find_pieces(setting, seams, looks)
    candidates = find_candidates(setting, looks)
    if seen.reference.truth is not None:
        examples = examples_of(scene, setting, seen.true_scale, seen.reference.truth)
        feet = [example.log_height for example in examples if np.isfinite(example.log_height)]
    else:
        feet = agreed_feet(candidates, seen.true_scale)
    return Judged(
        dataset if part is None else dataset + PARTED,
        scene,
        replace(setting, sight=replace(setting.sight, pixels=None)),
        candidates,
        seen.on,
        seen.log_factor,
        seen.log_true,
        np.append(seen.true_scale, densest(np.array(feet)) if feet else np.nan),
        true_depth(seen.reference, seen.camera),
        [(seam, _error_of(seam, seen)) for seam in seams],
        pieces,
        _scales_of(seen, pieces.piece, pieces.count),
    )


def _error_of(seam: Seam, seen: Seen) -> float:
    side = np.full(len(seen.setting.log_depth), -1)
    side[seam.larger], side[seam.smaller] = 0, 1
    first, second = _scales_of(seen, side, 2)
    return float(abs(first - second))


def _scales_of(seen: Seen, part: Int, count: int) -> Float:
    """The true log scales (count,) of other parts (N,) of the lines than bodies."""
    parted = replace(seen.setting, bodies=RigidBodies(part, count))
    return true_scales(parted, seen.on, seen.log_true - seen.log_factor)


def lines_at(setting: Setting, found: FoundLines, pixels: Float) -> tuple[Int, Float]:
    """The line (P,) nearest to each pixel, and the log depth (P,) of its ray where that line has log depth 0."""
    graph = setting.graph
    count = len(graph.axis)
    lines = Lines(
        id=np.arange(count),
        axis=graph.axis,
        segment=graph.segments.ends,
        ends=np.repeat(graph.rays[:, None], 2, axis=1),
        is_boundary=np.zeros(count, bool),
        component=np.zeros(count, np.int64),
        confidence=np.full(count, "supported"),
    )
    scene = scene_of_lines(found.camera, found.frame.rotation, lines, found.frame.turns)
    on = nearest_lines(scene, pixels, np.ones(count, bool))
    factor = depths_of(scene, pixels, on)
    before = np.isfinite(factor) & (factor > 0)
    return np.where(before, on, NO_LINE), np.log(np.where(before, factor, 1.0))


def true_scales(setting: Setting, on: Int, log_line_depth: Float) -> Float:
    """The log (B,) by which each body must grow, from the true log depths (P,) of the lines `on` which points lie."""
    scale = np.full(setting.bodies.count, np.nan)
    shift = np.where(on == NO_LINE, 0.0, log_line_depth - setting.log_depth[on])
    for body, lines in enumerate(setting.lines):
        own = shift[np.isin(on, lines)]
        if len(own) >= LEAST_POINTS:
            middle = densest(own)
            agreeing = np.abs(own - middle) < AGREEING
            scale[body] = middle if agreeing.mean() >= LEAST_AGREEING else np.nan
    return scale


def agreed_feet(candidates: list[Candidate], true_scale: Float) -> list[float]:
    """True log heights of the feet that most bodies of one photo agree about; none where fewer than three bodies do.

    Nothing else tells where the ground of a real photo is. Feet that are wrong hardly agree.
    """
    feet = [candidate for candidate in candidates if candidate.kind == "ground"]
    known = [candidate for candidate in feet if np.isfinite(true_scale[candidate.bodies[0]])]
    height = np.array([true_scale[candidate.bodies[0]] - candidate.log_ratio for candidate in known])
    best: list[float] = []
    most = LEAST_AGREED - 1
    for middle in height:
        near = np.abs(height - middle) < AGREED
        bodies = len({candidate.bodies[0] for candidate, is_near in zip(known, near, strict=True) if is_near})
        if bodies > most:
            best, most = height[near].tolist(), bodies
    return best


def densest(values: Float) -> float:
    """The median of the most values that lie within 2 WIDTH."""
    values = np.sort(values)
    count = np.searchsorted(values, values + 2 * WIDTH) - np.arange(len(values))
    first = int(count.argmax())
    return float(np.median(values[first : first + count[first]]))
