"""From a photo to its line graph: the camera, the lines along its axes, and what of them is connected."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float
from linecad.camera.frame_labels import label_by_frames
from linecad.camera.horizontal_frames import HorizontalFrames
from linecad.camera.photo import Photo
from linecad.camera.refit import find_calibration
from linecad.corrections.edits import SetFrame
from linecad.decide.stability import FITS_FOR_INCONSISTENCY, MOST_INCONSISTENT, inconsistency_of, resample
from linecad.errors import ReconstructionError
from linecad.graph.build import build_line_graph
from linecad.graph.connectivity import components
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.lines.details import apart_from, find_details, find_whole_details
from linecad.lines.segments import (
    SMALL_WIDTH,
    find_faint_segments,
    find_segments,
    group_segments,
)
from linecad.lines.vanishing_point_lines import find_vanishing_point_lines
from linecad.options import LONG_REACH, MIN_COMPONENT, Options, Reach, Weights
from linecad.progress import StageReport, silent
from linecad.scene import Camera, Certainty
from solver.robust import RobustFit


@dataclass(frozen=True, eq=False)
class FoundLines:
    """What a photo shows before anything is connected: its camera, its axes and the segments that run along them."""

    camera: Camera
    frame: ManhattanFrame
    segments: Segments  # labelled fragments, not grouped yet
    notes: tuple[str, ...]  # what to know about them
    reach: Reach | None = None  # with which the segments were grouped to whole lines; None: they are fragments
    known_inconsistency: float | None = None  # of the photo they come from, where that was asked before
    certainty: Certainty | None = None  # of camera and frame
    pixels: NDArray[np.uint8] | None = None  # (H, W, 3) of the photo, for cues that look at it
    details: Segments | None = None  # labelled fragments too faint or short to build on; None: nobody looked
    raw: Float | None = None  # (N, 2, 2) px, ends of all segments, also of those along no axis

    def grouped(self, options: Options) -> "FoundLines":
        """The whole lines, as the reach in use makes them of the fragments: what a person sees and corrects."""
        reach = self.reach_for(options)
        whole = group_segments(self.segments, self.camera, self.frame, reach.largest_gap)
        known = self.inconsistency if options.needs_inconsistency else None
        return replace(self, segments=whole, reach=reach, known_inconsistency=known)

    def is_like(self, other: "FoundLines") -> bool:
        """Whether lines, camera and axes are the same."""
        return (
            self.segments.is_like(other.segments)
            and np.array_equal(self.camera.matrix, other.camera.matrix)
            and np.array_equal(self.frame.axes, other.frame.axes)
        )

    def reach_for(self, options: Options) -> Reach:
        """The reach in use: that with which these were grouped, else that of the options for this photo."""
        if self.reach is not None:
            return self.reach
        return options.reach_for(options.needs_inconsistency and self.is_inconsistent)

    def graph(self, reach: Reach, weights: Weights, collinear: bool) -> LineGraph:
        """The line graph of these lines."""
        grouped = self.segments
        if self.reach is None:
            grouped = group_segments(self.segments, self.camera, self.frame, reach.largest_gap)
        return build_line_graph(grouped, self.camera, self.frame, reach, weights, collinear, self.pixels)

    def details_for_faces(self, without: Segments) -> Segments | None:
        """The whole lines of all fragments, for faces to place, but not where lines `without` were taken away."""
        if self.details is None:
            return None
        whole = group_segments(self.segments.joined(self.details), self.camera, self.frame)
        return apart_from(whole, without, self.camera.width)

    @cached_property
    def widest_graph(self) -> LineGraph:
        """The line graph at long reach."""
        return self.graph(LONG_REACH, "odds", True)

    @cached_property
    def inconsistency(self) -> float:
        """How often crossings of this photo contradict each other (linecad.decide.stability), at long reach."""
        if self.known_inconsistency is not None:
            return self.known_inconsistency
        graph = self.widest_graph
        fits = resample(graph, fits=FITS_FOR_INCONSISTENCY)
        return inconsistency_of(graph, RobustFit(graph).depths(), fits, self.camera.width)

    @property
    def is_inconsistent(self) -> bool:
        """Whether agreement is worth so little in this photo that more of it is asked."""
        return self.inconsistency > MOST_INCONSISTENT


def find_lines(
    photo: Photo,
    on_stage: StageReport = silent,
    faint: bool = False,
    drawn: SetFrame | None = None,
    with_details: bool = True,
) -> FoundLines:
    """The labelled segments of a photo; raises ReconstructionError when it has no Manhattan frame.

    With `faint`, a second look adds what the grain of a photo hides that is not small. The frame is always that of the
    first look. Lines that a person has `drawn` along the axes give the frame instead of the segments. Only faces
    that place lines ask for details, which are looked for `with_details`.
    """
    on_stage("finding segments")
    return name_lines(photo, find_segments(photo.grey), on_stage, faint, drawn, with_details)


def name_lines(
    photo: Photo,
    raw: Segments,
    on_stage: StageReport = silent,
    faint: bool = False,
    drawn: SetFrame | None = None,
    with_details: bool = True,
) -> FoundLines:
    """The same from raw segments, as `linecad.lines.segments.find_segments` gives them."""
    on_stage(f"finding the Manhattan frame of {len(raw)} segments")
    calibrated = find_calibration(photo, raw, on_stage, drawn)
    camera, frames = calibrated.camera, calibrated.frames.sound
    if faint and photo.width >= SMALL_WIDTH:
        on_stage("finding faint segments")
        raw = raw.joined(find_faint_segments(photo.grey))
    on_stage("following lines along their vanishing points")
    frame = frames.frame
    through_points = find_vanishing_point_lines(photo.grey, camera, frame)
    pieces = _labelled(raw, through_points, camera, frames)
    details = None
    if with_details:
        on_stage("finding details")
        whole = find_whole_details(photo.grey, camera, frame)
        details = _labelled(find_details(photo.pixels, photo.grey), whole, camera, frames)
    return FoundLines(
        camera, frame, pieces, calibrated.notes, certainty=calibrated.certainty, pixels=photo.pixels, details=details,
        raw=raw.ends,
    )  # fmt: skip


def _labelled(raw: Segments, through_points: Segments, camera: Camera, frames: HorizontalFrames) -> Segments:
    """The segments along the directions of the frames, and the lines that were followed through vanishing points.

    A line that was found through the vanishing points of two is one.
    """
    every = raw.joined(through_points)
    axis = label_by_frames(every, camera, frames)
    kept = (axis >= 0) & ((every.axis < 0) | (every.axis == axis))
    return Segments(every.ends, axis).subset(kept)


def connect(found: FoundLines, options: Options) -> tuple[LineGraph, LineGraph]:
    """The line graph of all found lines, and the part of it that is solved; ReconstructionError when that is none."""
    whole = connect_all(found, options)
    return whole, _kept(whole, options)


def connect_all(found: FoundLines, options: Options) -> LineGraph:
    """The line graph of all found lines."""
    reach, weights, collinear = found.reach_for(options), options.weights_used, options.collinear_used
    is_widest = reach == LONG_REACH and weights == "odds" and collinear
    return found.widest_graph if is_widest else found.graph(reach, weights, collinear)


def _kept(graph: LineGraph, options: Options) -> LineGraph:
    """The part of the line graph that is solved: the largest component, or all that are not tiny."""
    parts = components(graph)
    if not parts or len(parts[0]) < MIN_COMPONENT:
        raise ReconstructionError(
            f"the {len(graph.segments)} lines found hardly touch each other: {len(parts[0]) if parts else 0} in the "
            f"largest group, at least {MIN_COMPONENT} are needed; raise --option extension=PX or use a larger photo"
        )
    kept = parts[:1] if options.largest_component else [part for part in parts if len(part) >= MIN_COMPONENT]
    return graph.subset(np.sort(np.concatenate(kept)))
