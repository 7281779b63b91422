"""From a photo to its line graph: what a user can choose, what was found, and what of it is connected."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linecad.camera.estimate import Calibrated, calibrate, calibrate_again
from linecad.camera.photo import Photo
from linecad.corrections.edits import SetFrame
from linecad.decide.resampling import FITS_FOR_DOUBT, MOST_DOUBT, doubt, draw
from linecad.errors import ReconstructionError
from linecad.graph.build import EXTENSION, MIN_LENGTH, MIN_TOLERANCE, Weights, build_line_graph
from linecad.graph.connectivity import components
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.lines.segments import (
    GROUP_ALONG,
    SMALL_WIDTH,
    find_faint_segments,
    find_segments,
    group_segments,
    label_segments,
)
from linecad.lines.vanishing_point_lines import find_pencil_lines
from linecad.scene import Camera, Certainty
from solver.options import SolveOptions
from solver.robust import RobustFit

MIN_COMPONENT = 4  # lines; smaller groups say too little about space to be worth showing
StageReport = Callable[[str], None]


@dataclass(frozen=True)
class Reach:
    """How far evidence is carried along a segment, in px at 3840 px width."""

    extension: float  # by which segments are extended to find crossings
    largest_gap: float  # between fragments of one segment
    least_length: float  # of a line
    least_tolerance: float  # of a crossing, relative depth: errors of frame and lens add up along the way


SHORT_REACH = Reach(EXTENSION, GROUP_ALONG, MIN_LENGTH, MIN_TOLERANCE)  # as in the paper
# 60, 100 and 15 px on photos 3072 px wide: what measured best on real photos (CONTRIBUTING, 2026-11-21).
LONG_REACH = Reach(75.0, 125.0, 18.75, 0.0035)
MIDDLE_REACH = Reach(37.5, 62.5, 18.75, MIN_TOLERANCE)  # for photos in which little can be believed


@dataclass(frozen=True)
class ReconstructOptions:
    """What a user can choose about a reconstruction."""

    # px at 3840 px width by which segments are extended to find crossings; None: that of the reach.
    extension: float | None = None
    reach: Reach | None = None  # None: long with formulation gain, middle in doubt; short with the paper's
    weights: Weights | None = None  # None: odds with formulation gain, junctions with the paper's
    collinear: bool = True  # segments on one image line may be one line in space; the paper does not have this
    largest_component: bool = False  # only the largest connected component, as in the paper
    # Lines by which two bodies must be tied to share a scale (linecad.decide.rigid_bodies); 1 asks nothing. None: lines
    # must keep their place in resampling (linecad.decide.resampling) with formulation gain, 1 with the paper's.
    witnesses: int | None = None
    faint: bool = False  # a second look for faint segments: more depths, and more wrong ones
    solve: SolveOptions = field(default_factory=SolveOptions)

    @property
    def is_paper(self) -> bool:
        """Whether what is not said is as in the paper."""
        return self.solve.formulation == "paper"

    def reach_for(self, found: "FoundLines") -> Reach:
        """`reach` and `extension` in use."""
        if found.reach is not None:
            return found.reach
        reach = self.reach
        if reach is None:
            reach = SHORT_REACH if self.is_paper else MIDDLE_REACH if found.is_doubtful else LONG_REACH
        return reach if self.extension is None else replace(reach, extension=self.extension)

    @property
    def weights_used(self) -> Weights:
        """`weights` in use."""
        return self.weights if self.weights is not None else "junctions" if self.is_paper else "odds"


@dataclass(frozen=True, eq=False)
class FoundLines:
    """What a photo shows before anything is connected: its camera, its axes and the segments that run along them."""

    camera: Camera
    frame: ManhattanFrame
    segments: Segments  # labelled fragments, not grouped yet
    notes: tuple[str, ...]  # doubts so far
    reach: Reach | None = None  # with which the segments were grouped to whole lines; None: they are fragments
    known_doubt: float | None = None  # about the photo they come from, where that was asked before
    certainty: Certainty | None = None  # of camera and frame

    def grouped(self, options: ReconstructOptions) -> "FoundLines":
        """The whole lines, as the reach in use makes them of the fragments: what a person sees and corrects."""
        reach = options.reach_for(self)
        whole = group_segments(self.segments, self.camera, self.frame, reach.largest_gap)
        return replace(self, segments=whole, reach=reach, known_doubt=None if options.is_paper else self.doubt)

    def graph(self, reach: Reach, weights: Weights, collinear: bool) -> LineGraph:
        """The line graph of these lines."""
        grouped = self.segments
        if self.reach is None:
            grouped = group_segments(self.segments, self.camera, self.frame, reach.largest_gap)
        return build_line_graph(
            grouped, self.camera, self.frame, reach.extension, weights, collinear,
            reach.least_length, reach.least_tolerance,
        )  # fmt: skip

    @cached_property
    def widest_graph(self) -> LineGraph:
        """The line graph at long reach."""
        return self.graph(LONG_REACH, "odds", True)

    @cached_property
    def doubt(self) -> float:
        """How little agreement is worth in this photo (linecad.decide.resampling), as a fit at long reach tells."""
        if self.known_doubt is not None:
            return self.known_doubt
        graph = self.widest_graph
        fit = RobustFit(graph)
        draws = draw(graph, lambda present: fit.depths(present=present), fits=FITS_FOR_DOUBT)
        return doubt(graph, fit.depths(), draws, self.camera.width)

    @property
    def is_doubtful(self) -> bool:
        """Whether agreement is worth so little that more of it is asked."""
        return self.doubt > MOST_DOUBT


def silent(_stage: str) -> None:
    """Report nothing."""


def find_lines(
    photo: Photo, on_stage: StageReport = silent, faint: bool = False, drawn: SetFrame | None = None
) -> FoundLines:
    """The labelled segments of a photo; raises ReconstructionError when it has no Manhattan frame.

    With `faint`, a second look adds what the grain of a photo hides that is not small. The frame is always that of the
    first look. Lines that a person has `drawn` along the axes give the frame instead of the segments.
    """
    on_stage("finding segments")
    return name_lines(photo, find_segments(photo.grey), on_stage, faint, drawn)


def name_lines(
    photo: Photo,
    raw: Segments,
    on_stage: StageReport = silent,
    faint: bool = False,
    drawn: SetFrame | None = None,
) -> FoundLines:
    """The same from raw segments, as `linecad.lines.segments.find_segments` gives them."""
    on_stage(f"finding the Manhattan frame of {len(raw)} segments")
    calibrated = find_calibration(photo, raw, on_stage, drawn)
    camera, frame = calibrated.camera, calibrated.frame
    if faint and photo.width >= SMALL_WIDTH:
        on_stage("finding faint segments")
        raw = raw.joined(find_faint_segments(photo.grey))
    on_stage("following lines along their vanishing points")
    pieces = label_segments(raw, camera, frame).joined(find_pencil_lines(photo.grey, camera, frame))
    return FoundLines(camera, frame, pieces, calibrated.notes, certainty=calibrated.certainty)


def find_calibration(
    photo: Photo, raw: Segments, on_stage: StageReport = silent, drawn: SetFrame | None = None
) -> Calibrated:
    """Camera and frame of a photo with segments `raw`; from vanishing points alone, fitted again to lines that meet.

    Raises ReconstructionError when the photo has no Manhattan frame.
    """
    first = calibrate(photo, raw, drawn)
    if first.prior is None or drawn is not None:
        return first
    on_stage("fitting the camera again to the lines that meet in space")
    pieces = label_segments(raw, first.camera, first.frame)
    graph = FoundLines(first.camera, first.frame, pieces, ()).widest_graph
    agrees = graph.informative & (graph.misfit(RobustFit(graph).depths()) <= graph.tolerance)
    met = [part for part in components(graph, agrees) if len(part) >= MIN_COMPONENT]
    if not met:
        return first
    return calibrate_again(photo, raw, first, graph.segments.subset(np.concatenate(met)))


def connect(found: FoundLines, options: ReconstructOptions) -> tuple[LineGraph, LineGraph]:
    """The line graph of all found lines, and the part of it that is solved; ReconstructionError when that is none."""
    whole = connect_all(found, options)
    return whole, _kept(whole, options)


def connect_all(found: FoundLines, options: ReconstructOptions) -> LineGraph:
    """The line graph of all found lines."""
    reach, weights = options.reach_for(found), options.weights_used
    is_widest = reach == LONG_REACH and weights == "odds" and options.collinear
    return found.widest_graph if is_widest else found.graph(reach, weights, options.collinear)


def _kept(graph: LineGraph, options: ReconstructOptions) -> LineGraph:
    """The part of the line graph that is solved: the largest component, or all that are not tiny."""
    parts = components(graph)
    if not parts or len(parts[0]) < MIN_COMPONENT:
        raise ReconstructionError(
            f"the {len(graph.segments)} lines found hardly touch each other: {len(parts[0]) if parts else 0} in the "
            f"largest group, at least {MIN_COMPONENT} are needed; raise --extension or use a larger photo"
        )
    kept = parts[:1] if options.largest_component else [part for part in parts if len(part) >= MIN_COMPONENT]
    return graph.subset(np.sort(np.concatenate(kept)))
