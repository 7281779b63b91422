"""From a solved line graph to a scene: what hangs together, lifted into space, with planes, faces and doubts."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Bool, Float, Int, Text
from linecad.camera.photo import Photo
from linecad.decide.resampling import MOST_DOUBT, SUPPORT, SUPPORT_IN_DOUBT, draw, find_supported
from linecad.decide.rigid_bodies import Held, agreeing, find_held, tied
from linecad.errors import ReconstructionError
from linecad.finding import MIN_COMPONENT, FoundLines, ReconstructOptions
from linecad.graph.connectivity import components, hinged_nodes, spanning_tree
from linecad.line_graph import LineGraph, ManhattanFrame, Solution
from linecad.model.agreement import disagreements
from linecad.model.body_scales import join_bodies
from linecad.model.faces import find_faces
from linecad.model.lifting import Lifted, lift
from linecad.model.planes import find_planes
from linecad.model.window_grids import find_grid_ties
from linecad.scene import Camera, Intersections, Lines, Scene, SolveReport
from solver.robust import RobustFit

TYPICAL_DEPTH = 10.0  # the median depth of a scene whose scale is not known, so that files open at a handy size
SHIFT_NOTED = 0.005  # rad; lines that had to move more to become exact are worth a note
WITNESSES_IN_DOUBT = 2


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
    scene = _scene(photo, found.camera, found.frame, graph, solution, lifted, notes, options, held, firm)
    return replace(scene, certainty=found.certainty)


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
