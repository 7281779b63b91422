"""The stages in the paper's order (algorithm 1): a photo becomes a scene."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linecad.agreement import disagreements
from linecad.correcting import CorrectedLines, Said, correct, rows_of, said_of
from linecad.corrections import Corrections, SetFrame
from linecad.errors import ContradictionError, ReconstructionError
from linecad.faces import find_faces
from linecad.geometry import central_camera
from linecad.graph import (
    EXTENSION,
    MIN_LENGTH,
    MIN_TOLERANCE,
    Weights,
    build_line_graph,
    components,
    hinged_nodes,
    spanning_tree,
)
from linecad.grids import find_grid_ties
from linecad.hinges import Held, agreeing, find_held, tied
from linecad.lifting import Lifted, lift
from linecad.pencils import find_pencil_lines
from linecad.photo import Photo
from linecad.planes import find_planes
from linecad.scene import (
    Bool,
    Camera,
    Float,
    Int,
    Intersections,
    LineGraph,
    Lines,
    ManhattanFrame,
    Scene,
    Segments,
    Solution,
    SolveReport,
    Text,
)  # fmt: skip
from linecad.segments import (
    GROUP_ALONG,
    SMALL_WIDTH,
    find_faint_segments,
    find_segments,
    group_segments,
    label_segments,
)
from linecad.support import FITS_FOR_DOUBT, MOST_DOUBT, SUPPORT, SUPPORT_IN_DOUBT, doubt, draw, find_supported
from linecad.ties import join_bodies
from linecad.vanishing import FOCAL_SIGMA, default_focal, find_focal, find_frame, fit_frame
from solver.problem import Progress, SolveOptions, solve
from solver.robust import RobustFit

MIN_COMPONENT = 4  # lines; smaller groups say too little about space to be worth showing
TYPICAL_DEPTH = 10.0  # the median depth of a scene whose scale is not known, so that files open at a handy size
MIN_FRAME_SHARE = 0.3  # of the segment length; a frame that explains less is doubtful
SURE_FACTOR = 2.0  # by which the tolerance of a crossing grows that a person called real
WIDEST_TOLERANCE = float(np.log(100.0))  # of a crossing that a person called real, in log depth
LENGTHS_DISAGREE = 1.05  # ratio of the scales that two known lengths give, above which a note says so
SHIFT_NOTED = 0.005  # rad; lines that had to move more to become exact are worth a note

StageReport = Callable[[str], None]


def _silent(_stage: str) -> None:
    """Report nothing."""


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
WITNESSES_IN_DOUBT = 2


@dataclass(frozen=True)
class ReconstructOptions:
    """What a user can choose about a reconstruction."""

    # px at 3840 px width by which segments are extended to find crossings; None: that of the reach.
    extension: float | None = None
    reach: Reach | None = None  # None: long with formulation gain, middle in doubt; short with the paper's
    weights: Weights | None = None  # None: odds with formulation gain, junctions with the paper's
    collinear: bool = True  # segments on one image line may be one line in space; the paper does not have this
    largest_component: bool = False  # only the largest connected component, as in the paper
    # Lines by which two bodies must be tied to share a scale (linecad.hinges); 1 asks nothing. None: lines must keep
    # their place in resampling (linecad.support) with formulation gain, 1 with the paper's.
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
        """How little agreement is worth in this photo (linecad.support), as a fit at long reach tells."""
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


def reconstruct(
    photo: Photo,
    options: ReconstructOptions,
    on_progress: Callable[[Progress], None] | None = None,
    on_stage: StageReport = _silent,
    corrections: Corrections | None = None,
) -> Scene:
    """The lines, planes and boundaries of a photo's scene. Raises ReconstructionError when it shows too little.

    With `corrections`, lines and crossings are what a person said about them; a ContradictionError where that cannot
    all be true, a note where it names what is not there.
    """
    found = find_lines(photo, on_stage, options.faint, None if corrections is None else corrections.frame)
    if corrections is not None:
        found = found.grouped(options)
        corrected = correct_lines(found, corrections)
        return measured(reconstruct_corrected(photo, found, corrected, options, on_progress, on_stage), corrected)
    whole, graph = connect(found, options)
    on_stage(f"solving {len(graph.segments)} lines with {len(graph.edges)} crossings")
    solution = solve(graph, options.solve, on_progress)
    on_stage("lifting the lines into space")
    return place(photo, found, graph, solution, options, len(whole.segments) - len(graph.segments))


def correct_lines(found: FoundLines, corrections: Corrections) -> CorrectedLines:
    """The lines that were found, grouped, after all edits; `found` must have the frame of the corrections."""
    return correct(found.segments, found.camera, found.frame, corrections)


def reconstruct_corrected(
    photo: Photo,
    found: FoundLines,
    corrected: CorrectedLines,
    options: ReconstructOptions,
    on_progress: Callable[[Progress], None] | None = None,
    on_stage: StageReport = _silent,
) -> Scene:
    """The scene of corrected lines, without the scale that known lengths give (`measured`).

    May raise ReconstructionError, ContradictionError or SolverError.
    """
    found = replace(found, segments=corrected.segments, notes=found.notes + corrected.notes)
    whole, graph = connect(found, options)
    said = said_of(graph, corrected)
    found = replace(found, notes=found.notes + said.notes)
    graph = _believed(graph, said)
    known = replace(
        options.solve,
        real=tuple(np.flatnonzero(said.real).tolist()),
        fake=tuple(np.flatnonzero(said.fake).tolist()),
    )
    on_stage(f"solving {len(graph.segments)} lines with {len(graph.edges)} crossings")
    try:
        solution = solve(graph, known, on_progress)
    except ContradictionError as error:
        raise _named(error, graph, corrected) from None
    on_stage("lifting the lines into space")
    left_out = len(whole.segments) - len(graph.segments)
    return place(photo, found, graph, solution, options, left_out, said.real)


def _named(error: ContradictionError, graph: LineGraph, corrected: CorrectedLines) -> ContradictionError:
    """The same contradiction told by places in the photo, with the ids of the lines."""
    ids = corrected.ids[rows_of(graph.segments, corrected)]
    edge = {pair: number for number, pair in enumerate(map(tuple, graph.edges.tolist()))}
    places = [graph.crossing[edge[pair]].round().astype(int).tolist() for pair in error.crossings]
    where = ", ".join(f"({x}, {y})" for x, y in places)
    return ContradictionError(
        f"the crossings at {where} cannot all be real: no depths fit them; take one of them back",
        tuple(int(ids[line]) for line in error.lines),
        tuple((int(min(ids[i], ids[j])), int(max(ids[i], ids[j]))) for i, j in error.crossings),
    )


def measured(scene: Scene, corrected: CorrectedLines) -> Scene:
    """The scene with the scale that known lengths give it: the geometric mean of what each says.

    Only lengths on component 0 count, since the scales of the others are guesses.
    """
    if not corrected.lengths:
        return scene
    seen = zip(scene.lines.axis.tolist(), scene.lines.segment, strict=True)
    row = {(axis, ends.tobytes()): number for number, (axis, ends) in enumerate(seen)}
    scales, notes = [], []
    for number, metres in corrected.lengths.items():
        own = int(np.flatnonzero(corrected.ids == number)[0])
        key = (int(corrected.segments.axis[own]), corrected.segments.ends[own].tobytes())
        if key not in row or scene.lines.component[row[key]] != 0:
            notes.append(f"a line of known length ({metres:g} m) is not on component 0, so its length says nothing")
            continue
        ends = scene.lines.ends[row[key]]
        scales.append(metres / float(np.linalg.norm(ends[1] - ends[0])))
    if scales and max(scales) > LENGTHS_DISAGREE * min(scales):
        notes.append(f"the known lengths disagree by up to {max(scales) / min(scales) - 1:.0%}; their mean is taken")
    metres_per_unit = float(np.exp(np.mean(np.log(scales)))) if scales else None
    return replace(scene, metres_per_unit=metres_per_unit, notes=scene.notes + tuple(notes))


def _believed(graph: LineGraph, said: Said) -> LineGraph:
    """The graph in which every crossing that a person called real says something about depth, if little.

    Its tolerance is wider: a person is not wrong because a segment is off by a little more than its noise.
    """
    taken = said.real & graph.possible
    wider = np.minimum(SURE_FACTOR * graph.tolerance, WIDEST_TOLERANCE)
    tolerance = np.where(taken, wider, graph.tolerance)
    return replace(graph, tolerance=tolerance, informative=graph.informative | taken)


def find_lines(
    photo: Photo, on_stage: StageReport = _silent, faint: bool = False, drawn: SetFrame | None = None
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
    on_stage: StageReport = _silent,
    faint: bool = False,
    drawn: SetFrame | None = None,
) -> FoundLines:
    """The same from raw segments, as `linecad.segments.find_segments` gives them."""
    on_stage(f"finding the Manhattan frame of {len(raw)} segments")
    camera, notes = _camera(photo, raw)
    if drawn is None:
        frame = find_frame(raw, camera.matrix)
    else:
        ends = np.array([line.ends for line in drawn.lines])
        frame = fit_frame(ends, np.array([line.axis for line in drawn.lines]), camera.matrix, raw)
        notes.append("the Manhattan frame is that of lines drawn by hand")
    if frame.explained < MIN_FRAME_SHARE:
        notes.append(f"only {frame.explained:.0%} of the segment length runs along the three Manhattan directions")
    if faint and photo.width >= SMALL_WIDTH:
        on_stage("finding faint segments")
        raw = raw.joined(find_faint_segments(photo.grey))
    on_stage("following lines along their vanishing points")
    pieces = label_segments(raw, camera, frame).joined(find_pencil_lines(photo.grey, camera, frame))
    return FoundLines(camera, frame, pieces, tuple(notes))


def connect(found: FoundLines, options: ReconstructOptions) -> tuple[LineGraph, LineGraph]:
    """The line graph of all found lines, and the part of it that is solved; ReconstructionError when that is none."""
    whole = connect_all(found, options)
    return whole, _kept(whole, options)


def connect_all(found: FoundLines, options: ReconstructOptions) -> LineGraph:
    """The line graph of all found lines."""
    reach, weights = options.reach_for(found), options.weights_used
    is_widest = reach == LONG_REACH and weights == "odds" and options.collinear
    return found.widest_graph if is_widest else found.graph(reach, weights, options.collinear)


def place(
    photo: Photo,
    found: FoundLines,
    graph: LineGraph,
    solution: Solution,
    options: ReconstructOptions,
    left_out: int = 0,
    sure: Bool | None = None,
) -> Scene:
    """The scene of a solved graph; `left_out` lines of the photo are not in it. May raise ReconstructionError.

    Crossings (E,) that a person is `sure` of tie bodies together, however little else does.
    """
    notes = list(found.notes)
    if left_out:
        notes.append(_left_out(left_out, "touch too few others in the photo", options))
    solution = _within_groups(graph, solution)
    held, firm, why = _held(found, graph, solution, options)
    if held is not None:
        if options.witnesses is None and found.is_doubtful:
            notes.append(
                f"corners in this photo contradict each other often (doubt {found.doubt:.2f}, usual up to "
                f"{MOST_DOUBT}), as where buildings hide each other: lines reach less far, and more is asked of what "
                "hangs together"
            )
        if sure is not None:
            held = tied(held, graph.edges[sure & solution.connected & graph.informative])
        refused = solution.connected & ~held.joins(graph)
        if (refused & graph.informative).any():
            notes.append(
                f"{int(refused.sum())} crossings join bodies of lines that {why}, and are not taken for real: such a "
                "join is often a near edge before a far wall"
            )
        solution = replace(solution, connected=solution.connected & ~refused)
    lifted = lift(graph, solution)
    return _scene(photo, found.camera, found.frame, graph, solution, lifted, notes, options, held, firm)


def _held(
    found: FoundLines, graph: LineGraph, solution: Solution, options: ReconstructOptions
) -> tuple[Held | None, Bool, str]:
    """What holds the lines of a solution, which lines (N,) it holds firmly, and in words what it refuses; or None."""
    witnesses = options.witnesses
    if witnesses == 1 or (witnesses is None and options.is_paper):
        return None, np.ones(len(graph.segments), bool), ""
    agrees = agreeing(graph, solution.connected, solution.log_depth)
    if witnesses is not None:
        held = find_held(graph, agrees, witnesses)
        return held, held.within, f"fewer than {witnesses} lines tie to each other"
    fit = RobustFit(graph)
    draws = draw(graph, lambda present: fit.depths(present=present), options.solve.seed)
    supported = find_supported(graph, agrees, solution.log_depth, draws, found.is_doubtful)
    if not found.is_doubtful:
        return supported.held, supported.firm, _unstable(SUPPORT)
    held = find_held(graph, agrees & supported.held.joins(graph), WITNESSES_IN_DOUBT)
    why = f"{_unstable(SUPPORT_IN_DOUBT)} or that fewer than {WITNESSES_IN_DOUBT} lines tie to each other"
    return held, held.within & supported.firm, why


def _unstable(asked: float) -> str:
    return f"keep their place in less than {asked:.0%} of the fits with some lines left out"


def _camera(photo: Photo, raw: Segments) -> tuple[Camera, list[str]]:
    """The photo's camera, or one whose focal length the vanishing points tell; and the doubts about it."""
    notes = list(photo.notes)
    if photo.camera is not None:
        return photo.camera, notes
    guess = find_focal(raw, photo.width, photo.height)
    if guess.relative_error <= FOCAL_SIGMA:
        notes.append(
            f"focal length guessed from the vanishing points: {guess.focal:.0f} px, "
            f"standard error {guess.relative_error:.1%} or more; principal point assumed in the middle"
        )
        matrix = central_camera(guess.focal, photo.width, photo.height)
        return Camera(photo.width, photo.height, matrix, "vanishing points"), notes
    focal = default_focal(photo.width, photo.height)
    notes.append(
        f"focal length not known and not to be told from the vanishing points; {focal:.0f} px assumed "
        "(28 mm equivalent), so depths may be stretched; give --focal or --camera"
    )
    return Camera(photo.width, photo.height, central_camera(focal, photo.width, photo.height), "default"), notes


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


def _within_groups(graph: LineGraph, solution: Solution) -> Solution:
    """The solution without chosen crossings between groups of lines that nothing else ties.

    Such a crossing lies so near the horizon that it says nothing about depth; the two groups have scales of their own,
    and a coordinate that they shared would be two numbers.
    """
    group = np.empty(len(graph.segments), np.int64)
    for number, part in enumerate(components(graph, solution.connected & graph.informative)):
        group[part] = number
    i, j = graph.edges.T
    return replace(solution, connected=solution.connected & (group[i] == group[j]))


def _scene(
    photo: Photo,
    camera: Camera,
    frame: ManhattanFrame,
    graph: LineGraph,
    solution: Solution,
    lifted: Lifted,
    notes: list[str],
    options: ReconstructOptions,
    held: Held | None = None,
    firm: Bool | None = None,
) -> Scene:
    """The scene of the lines that a chosen crossing ties to others, each component with its scale."""
    telling = solution.connected & graph.informative
    parts = [part for part in components(graph, telling) if len(part) >= MIN_COMPONENT]
    hinged = hinged_nodes(graph, telling)
    if firm is not None:
        hinged |= ~firm
    if held is not None and parts:
        parts, lifted, tied = _tie_parts(graph, camera, frame, lifted, parts, held)
        hinged |= tied
        if tied[parts[0]].any():
            notes.append(
                f"{int(tied[parts[0]].sum())} lines of component 0 are not connected to the rest of it by crossings: "
                "their place follows from window grids that continue (supported)"
            )
    if not parts:
        raise ReconstructionError(
            "no group of lines was found whose crossings agree in space; check the camera, or raise --extension"
        )
    parts = parts[:1] if options.largest_component else parts
    dropped = len(graph.segments) - sum(map(len, parts))
    component = np.full(len(graph.segments), -1)
    for number, part in enumerate(parts):
        component[part] = number
    kept = np.sort(np.concatenate(parts))
    scale = _component_scales(graph, lifted, parts)
    ends = lifted.ends * scale[component][:, None, None]
    offset = lifted.offset * scale[component][:, None]
    inside = (component[graph.edges] >= 0).all(axis=1)
    real = solution.connected & inside

    new_id = np.cumsum(component >= 0) - 1
    lines = Lines(
        id=np.arange(len(kept)),
        axis=graph.axis[kept],
        segment=graph.segments.ends[kept],
        ends=ends[kept],
        is_boundary=solution.is_boundary[kept],
        component=component[kept],
        confidence=_confidence(solution, component, hinged)[kept],
    )
    intersections = Intersections(
        lines=new_id[graph.edges[inside]],
        kind=graph.kind[inside],
        pixel=graph.crossing[inside],
        real=real[inside],
        in_tree=spanning_tree(graph, real & telling, lifted.residual)[inside],
        weight=graph.weight[inside],
    )
    planes = find_planes(offset[kept], lifted.shared[kept], lines.id)
    planes = find_faces(planes, lines, camera, frame.rotation)
    if dropped:
        notes.append(_left_out(dropped, "meet too few others in space", options))
    notes += _doubts(solution, parts, lifted.shift[kept])
    notes += disagreements(planes, lines, _renumbered(solution.planar_pairs, component, new_id))
    return Scene(
        photo=photo.name,
        camera=camera,
        rotation=frame.rotation,
        lines=lines,
        intersections=intersections,
        planes=planes,
        solve=SolveReport(
            solution.solver, solution.formulation, solution.status, solution.objective, solution.bound, solution.gap,
            solution.seconds, solution.cuts, solution.nodes,
        ),
        notes=tuple(notes),
    )  # fmt: skip


def _tie_parts(
    graph: LineGraph, camera: Camera, frame: ManhattanFrame, lifted: Lifted, parts: list[Int], held: Held
) -> tuple[list[Int], Lifted, Bool]:
    """The parts joined where window grids tie them, each with one scale.

    The one with the most lines in bodies comes first, also where more lines hang together loosely, the others in the
    order of their number of lines. A tied part is scaled as a whole, so that all crossings in it stay exact. The mask
    (N,) tells the lines of parts that are not the largest of those they were joined with.
    """
    joined = join_bodies(find_grid_ties(graph, camera, frame.rotation, parts, lifted.offset), len(parts))
    sizes = [(int(held.within[part].sum()), len(part)) for part in parts]
    scale, tied = np.ones(len(graph.segments)), np.zeros(len(graph.segments), bool)
    groups: list[Int] = []
    for group in np.unique(joined.group).tolist():
        members = np.flatnonzero(joined.group == group).tolist()
        lead = max(members, key=lambda member: sizes[member])
        for member in members:
            scale[parts[member]] = np.exp(joined.log_scale[member] - joined.log_scale[lead])
            tied[parts[member]] = member != lead
        groups.append(np.sort(np.concatenate([parts[member] for member in members])))
    groups.sort(key=lambda lines: (-len(lines), int(lines[0])))
    largest = max(groups, key=lambda lines: int(held.within[lines].sum()))
    groups.sort(key=lambda lines: lines is not largest)
    lifted = replace(lifted, ends=lifted.ends * scale[:, None, None], offset=lifted.offset * scale[:, None])
    return groups, lifted, tied


def _renumbered(pairs: Int, component: Int, new_id: Int) -> Int:
    """The planar pairs (P, 3) whose lines are in the scene and in one component, with their numbers there."""
    own = component[pairs[:, :2]]
    inside = pairs[(own[:, 0] >= 0) & (own[:, 0] == own[:, 1])]
    return np.column_stack([new_id[inside[:, :2]], inside[:, 2]])


def _component_scales(graph: LineGraph, lifted: Lifted, parts: list[Int]) -> Float:
    """One factor a component, and 1 at the end for lines of none: component 0 gets TYPICAL_DEPTH as median depth.

    Nothing in the photo ties the others to it, so each is put at the depth of the lines of component 0 that are
    nearest to it in the photo: near enough to be looked at, marked as weak.
    """
    middle = graph.segments.ends.mean(axis=1)
    # Camera depth of a line at its segment's middle, from its two exact coordinates.
    rays = np.where(np.isnan(lifted.offset), 0, graph.rays)
    offset = np.nan_to_num(lifted.offset)
    depth = (rays * offset).sum(axis=1) / (rays**2).sum(axis=1)
    main = parts[0]
    scales = [TYPICAL_DEPTH / float(np.median(depth[main]))]
    for part in parts[1:]:
        distance = np.linalg.norm(middle[part][:, None] - middle[main][None], axis=2)
        beside = main[distance.argmin(axis=1)]
        scales.append(scales[0] * float(np.median(depth[beside] / depth[part])))
    return np.array([*scales, 1.0])


def _confidence(solution: Solution, component: Int, hinged: Bool) -> Text:
    """How sure the depth of each line is (N,), in the words of docs/scene-file.md."""
    sure = "proven" if solution.status == "optimal" else "supported"
    word = np.where(hinged, "supported", sure)
    return np.asarray(np.where(component == 0, word, "weak"), np.str_)


def _left_out(count: int, why: str, options: ReconstructOptions) -> str:
    other = ", or not the largest group," if options.largest_component else ""
    return f"{count} lines {why}{other} and are left out: a group has at least {MIN_COMPONENT}"


def _doubts(solution: Solution, parts: list[Int], shift: Float) -> list[str]:
    notes = []
    if solution.status == "robust fit":
        notes.append("depths by a robust fit to all crossings, without a search: nothing is proven, the gap is unknown")
    elif solution.status == "heuristic":
        notes.append(f"the time was over before the exact search began; the gap is {solution.gap:.1%}")
    elif solution.status != "optimal":
        ended = "was interrupted" if solution.status == "interrupted" else f"reached its {solution.status}"
        notes.append(f"the solver {ended} with a gap of {solution.gap:.1%}: not proven optimal")
    if len(parts) > 1:
        notes.append(
            f"{len(parts) - 1} smaller groups of lines, each with a scale of its own, are placed at the depth of "
            "their neighbours in the photo and marked weak"
        )
    moved = int((shift > SHIFT_NOTED).sum())
    if moved:
        notes.append(f"{moved} lines moved by up to {np.degrees(shift.max()):.1f} degrees to meet the others exactly")
    return notes
