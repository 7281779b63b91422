"""From a decided line graph to a scene: lines lifted into space, components with their scales, planes and faces."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int, Text
from linecad.corrections.edits import FaceEdit
from linecad.decide.decision import Decision
from linecad.errors import ReconstructionError
from linecad.graph.connectivity import components, spanning_tree
from linecad.line_graph import LineGraph, ManhattanFrame, Segments, Solution
from linecad.model.agreement import disagreements
from linecad.model.body_scales import join_bodies
from linecad.model.clean.buried import ending_on_ground, grounds_of
from linecad.model.clean.roles import with_roles
from linecad.model.clean.settling import outlines_of, settled
from linecad.model.clean.sight import Sight
from linecad.model.coplanar import join_planes
from linecad.model.depth_evidence import depths_of, normals_of
from linecad.model.face_lines import add_lines, follow_map, lines_told, without_repeats
from linecad.model.faces import faces_seen_and_going_on, with_roofs
from linecad.model.finishing import finished
from linecad.model.frame_crossings import clean_and_cross, inexact_crossings
from linecad.model.frame_ends import closed_across, ends_that_meet_others
from linecad.model.frames import (
    FramedLines,
    frame_views,
    in_frame,
    in_frames,
    planes_in,
    planes_of,
    sight_in,
)
from linecad.model.groups import with_main_first
from linecad.model.ids import with_ids_by_place
from linecad.model.lifting import Lifted
from linecad.model.openings.corners import rectangles_of
from linecad.model.openings.find import find_openings, look_at_walls
from linecad.model.openings.told import ToldOpenings
from linecad.model.regions.find import Look, find_regions
from linecad.model.regions.roofs import Sketch
from linecad.model.regions.shown import cells_of
from linecad.model.regions.surfaces import GroundOfFeet
from linecad.model.solver_notes import notes_on_solver
from linecad.model.window_grids import find_window_grid_cues
from linecad.options import MIN_COMPONENT
from linecad.scene import Camera, Certainty, DepthMapReport, Intersections, Lines, Opening, Plane, Scene, SolveReport
from linecad.ties.facts import common_planes
from linecad.ties.placing import Placed

TYPICAL_DEPTH = 10.0  # the median depth of a scene whose scale is not known, so that files open at a handy size
SHIFT_NOTED = 0.005  # rad; lines that had to move more to become exact are worth a note


@dataclass(frozen=True, eq=False)
class View:
    """The photo that a scene is seen in."""

    photo: str  # its name
    camera: Camera
    frame: ManhattanFrame
    certainty: Certainty | None  # of both
    lines: int  # that were found in it, also those that are not in the solved graph
    notes: tuple[str, ...]  # what is known so far
    pixels: NDArray[np.uint8] | None = None  # (H, W, 3) RGB, as straight as the lines; None: nothing to look at
    details: Segments | None = None  # edges along the axes that faces can place; None: faces add no lines
    sketch: Sketch | None = None  # of the segments along all directions; None: no roofs are looked for
    faces: tuple[FaceEdit, ...] = ()  # what a person said about faces


@dataclass(frozen=True, eq=False)
class Components:
    """The lines of a graph of N that go into the scene, and the component of each."""

    parts: list[Int]  # lines of each component, component 0 first
    component: Int  # (N,) -1 for lines of none
    by_grids: Bool  # (N,) placed by window grids and not by crossings
    lifted: Lifted  # with one scale for what window grids join
    is_largest_alone: bool  # the others were left out

    @property
    def kept(self) -> Bool:
        """Mask (N,) of the lines of all components."""
        return np.asarray(self.component >= 0)


def find_components(
    view: View, graph: LineGraph, decision: Decision, lifted: Lifted, largest_alone: bool = False
) -> Components:
    """The groups of `lifted` lines that real crossings connect, those joined that window grids join.

    The most important comes first; with `largest_alone` it is the only one. Raises ReconstructionError where no group
    is large enough.
    """
    by_grids = np.zeros(len(graph.segments), bool)
    parts = [part for part in components(graph, decision.real & graph.informative) if len(part) >= MIN_COMPONENT]
    if not parts:
        raise ReconstructionError(
            "no group of lines was found whose crossings agree in space; check the camera, or raise "
            "--option extension=PX"
        )
    if decision.bodies is not None:
        parts, lifted, by_grids = _joined_by_grids(view, graph, lifted, parts, decision.bodies.rigid)
    parts = parts[:1] if largest_alone else parts
    component = np.full(len(graph.segments), -1)
    for number, part in enumerate(parts):
        component[part] = number
    return Components(parts, component, by_grids, lifted, largest_alone)


def build_scene(
    view: View,
    graph: LineGraph,
    solution: Solution,
    decision: Decision,
    found: Components,
    placed: Placed | None = None,
) -> Scene:
    """The scene of the components that were found, with planes and faces.

    Where bodies were `placed`, all components have one scale. Else each is put at the depth of its neighbours.
    """
    found = found if placed is None else _with_planes_joined(found, graph, placed)
    kept = np.flatnonzero(found.kept)
    scales = _component_scales(graph, found.lifted, found.parts, placed is not None)
    scale = scales[found.component]
    lines = _lines(graph, solution, decision, found, scale, placed)
    depth_map = _report_on_map(placed, float(scales[0]))
    new_id = np.cumsum(found.kept) - 1
    sight = Sight.of(view.camera, view.frame.rotation, view.pixels)
    framed = in_frames(lines, (found.lifted.offset * scale[:, None])[kept], graph.home[kept], graph.turns)
    cleaned, framed = clean_and_cross(framed, _intersections(graph, decision, found, new_id), sight, view.camera.width)
    planes, lines = planes_of(framed, cleaned.shared), framed.in_world()
    seen = look_at_walls(frame_views(framed, planes, view.frame.rotation), view.camera, view.pixels)
    look = replace(_look(view, placed, scales), walls=seen.shown)
    regions = find_regions(planes, lines, view.camera, view.frame.rotation, look, graph.turns)
    place = (view.camera, view.frame.rotation, graph.turns)
    whole, going_on = faces_seen_and_going_on(planes, lines, regions, *place)
    seen = look_at_walls(frame_views(framed, whole, view.frame.rotation), view.camera, view.pixels, seen)
    holes = find_openings(seen, whole, view.camera, view.frame.rotation)
    drawn = ToldOpenings(view.faces, whole, lines, *place, going_on)
    planes, openings, told = drawn.opened(holes.openings)
    of_bodies = None if placed is None else cleaned.row[new_id[found.kept & placed.told]]
    said = lines_told(cleaned.intersections, of_bodies)
    on_faces = add_lines(framed, planes, view.details, view.camera, sight, said, regions)
    on_faces = follow_map(on_faces, look.mapped, view.camera, sight, said)
    ended = closed_across(_drawn(on_faces.lines, whole, drawn.among(holes.openings)[0], sight, said), sight)
    framed, planes = without_repeats(ended, on_faces.planes, sight)
    pairs = on_faces.renumbered(_renumbered(decision.planar_pairs, found.component, cleaned.row[new_id]))
    lines = framed.in_world()
    ends = cleaned.note(on_faces.kept, on_faces.lines.lines, ended.lines)
    notes = [*_notes(view, graph, solution, found, depth_map), ends, *regions.notes, *holes.notes, *told]
    scene = Scene(
        photo=view.photo,
        camera=view.camera,
        rotation=view.frame.rotation,
        lines=lines,
        intersections=on_faces.crossings(cleaned.intersections),
        planes=with_roofs(planes, regions.roofs, view.camera, view.frame.rotation, graph.turns),
        solve=SolveReport.of(solution),
        notes=(*filter(None, notes), *disagreements(planes, lines, pairs, graph.turns)),
        certainty=view.certainty,
        depth_map=depth_map,
        openings=openings,
        turns=graph.turns,
        cells=cells_of(regions, view.camera),
    )
    scene = with_main_first(finished(scene, framed, sight))
    last = (inexact_crossings(scene), *on_faces.notes(scene.lines))
    return with_ids_by_place(replace(scene, notes=(*scene.notes, *filter(None, last))))


def _with_planes_joined(found: Components, graph: LineGraph, placed: Placed) -> Components:
    """The components with the planes in common that they nearly have, or that a person told to be one."""
    told = common_planes(placed.setting, placed.places.facts)
    return replace(found, lifted=join_planes(found.lifted, found.component, graph.axis, told))


def _drawn(
    framed: FramedLines, planes: tuple[Plane, ...], openings: tuple[Opening, ...], sight: Sight, said: Int
) -> FramedLines:
    """The lines with ends where they stop, below the ground what is `said` (ids) or a map placed, and their roles."""
    outlines, meets = outlines_of(planes), ends_that_meet_others(framed, sight)
    grounds, told = grounds_of(planes, sight), np.isin(framed.lines.id, said) | framed.lines.by_depth_map

    def draw(lines: Lines, frame: int) -> Lines:
        own_sight = sight_in(sight, frame, framed.turns)
        own = planes_in(planes, frame, framed.turns)
        rows = framed.of(frame)
        ends_there = settled(lines, in_frame(outlines, frame, framed.turns), own_sight, meets[rows])
        ends_there = ending_on_ground(ends_there, grounds, own_sight, meets[rows] | told[rows, None])
        return with_roles(ends_there, own, own_sight.forward, rectangles_of(openings, own))

    return framed.each(draw)


def _lines(
    graph: LineGraph, solution: Solution, decision: Decision, found: Components, scale: Float, placed: Placed | None
) -> Lines:
    kept = np.flatnonzero(found.kept)
    # The scene program proves where bodies are best placed, nothing about single crossings.
    sure = "proven" if solution.status == "optimal" and solution.formulation != "bodies" else "supported"
    word = np.where(decision.is_firm & ~found.by_grids, sure, "supported")
    confidence: Text = np.asarray(np.where(found.component == 0, word, "weak"), np.str_)
    return Lines(
        id=np.arange(len(kept)),
        axis=graph.axis[kept],
        segment=graph.segments.ends[kept],
        ends=(found.lifted.ends * scale[:, None, None])[kept],
        is_boundary=decision.is_boundary[kept],
        component=found.component[kept],
        confidence=confidence[kept],
        probability=() if placed is None else placed.probability[kept],
        by_depth_map=() if placed is None else placed.by_map[kept],
    )


def _intersections(graph: LineGraph, decision: Decision, found: Components, new_id: Int) -> Intersections:
    inside = found.kept[graph.edges].all(axis=1)
    tree = spanning_tree(graph, decision.real & inside & graph.informative, found.lifted.residual)
    return Intersections(
        lines=new_id[graph.edges[inside]],
        kind=graph.kind[inside],
        pixel=graph.crossing[inside],
        real=decision.real[inside],
        in_tree=tree[inside],
        weight=graph.weight[inside],
        reason=decision.reason[inside],
    )


def _joined_by_grids(
    view: View, graph: LineGraph, lifted: Lifted, parts: list[Int], rigid: Bool
) -> tuple[list[Int], Lifted, Bool]:
    """The parts, joined where window grids join them, each with one scale.

    The one with the most lines of `rigid` bodies (N,) comes first, also where more lines are joined loosely, the others
    in the order of their number of lines. A joined part is scaled as a whole, so that all crossings in it stay exact.
    The mask (N,) tells the lines of parts that are not the largest of those they were joined with.
    """
    joined = join_bodies(find_window_grid_cues(graph, view.camera, view.frame.axes, parts, lifted.offset), len(parts))
    sizes = [(int(rigid[part].sum()), len(part)) for part in parts]
    scale, joined_by = np.ones(len(graph.segments)), np.zeros(len(graph.segments), bool)
    groups: list[Int] = []
    for group in np.unique(joined.group).tolist():
        members = np.flatnonzero(joined.group == group).tolist()
        lead = max(members, key=lambda member: sizes[member])
        for member in members:
            scale[parts[member]] = np.exp(joined.log_scale[member] - joined.log_scale[lead])
            joined_by[parts[member]] = member != lead
        groups.append(np.sort(np.concatenate([parts[member] for member in members])))
    groups.sort(key=lambda lines: (-len(lines), int(lines[0])))
    largest = max(groups, key=lambda lines: int(rigid[lines].sum()))
    groups.sort(key=lambda lines: lines is not largest)
    lifted = replace(lifted, ends=lifted.ends * scale[:, None, None], offset=lifted.offset * scale[:, None])
    return groups, lifted, joined_by


def _renumbered(pairs: Int, component: Int, new_id: Int) -> Int:
    """The planar pairs (P, 3) whose lines are in the scene and in one component, with their numbers there."""
    own = component[pairs[:, :2]]
    inside = pairs[(own[:, 0] >= 0) & (own[:, 0] == own[:, 1])]
    return np.column_stack([new_id[inside[:, :2]], inside[:, 2]])


def _look(view: View, placed: Placed | None, scales: Float) -> Look:
    """What the faces are found by, in a scene of which the placed lines are `scales[0]` times as far."""
    scale, camera = float(scales[0]), view.camera
    feet, depths = _ground_of_feet(placed, scale), depths_of(placed, scale, camera.matrix)
    ceiling = None if placed is None else partial(placed.height_of_ceiling, scale)
    return Look(view.pixels, feet, normals_of(placed), view.sketch, depths, view.faces, ceiling)


def _report_on_map(placed: Placed | None, scale: float) -> DepthMapReport | None:
    """What is told of a depth map, in a scene of which the placed lines are `scale` times as far."""
    found = None if placed is None else placed.depth_map
    return found if found is None or found.scale is None else replace(found, scale=found.scale / scale)


def _ground_of_feet(placed: Placed | None, scale: float) -> GroundOfFeet | None:
    """The ground where the feet of walls put it, in a scene of which the placed lines are `scale` times as far."""
    ground = None if placed is None else placed.ground
    return None if ground is None else GroundOfFeet(float(np.exp(ground[0])) * scale, ground[1])


def _component_scales(graph: LineGraph, lifted: Lifted, parts: list[Int], are_placed: bool) -> Float:
    """One factor a component, and 1 at the end for lines of none: component 0 gets TYPICAL_DEPTH as median depth.

    Where the others are placed relative to it they get the same factor. Else nothing in the photo joins them to it, so
    each is put at the depth of the lines of component 0 that are nearest to it in the photo: near enough to be looked
    at, marked as weak.
    """
    middle = graph.segments.ends.mean(axis=1)
    # Camera depth of a line at its segment's middle, from its exact coordinates.
    rays, offset = np.where(np.isnan(lifted.offset), 0, graph.components), np.nan_to_num(lifted.offset)
    depth = (rays * offset).sum(axis=1) / (rays**2).sum(axis=1)
    main = parts[0]
    scales = [TYPICAL_DEPTH / float(np.median(depth[main]))]
    if are_placed:
        return np.array([*(scales * len(parts)), 1.0])
    for part in parts[1:]:
        distance = np.linalg.norm(middle[part][:, None] - middle[main][None], axis=2)
        beside = main[distance.argmin(axis=1)]
        scales.append(scales[0] * float(np.median(depth[beside] / depth[part])))
    return np.array([*scales, 1.0])


def _notes(
    view: View, graph: LineGraph, solution: Solution, found: Components, depth_map: DepthMapReport | None
) -> tuple[str, ...]:
    """What is known so far, and what a reader of the scene should know of lines and solver."""
    notes = list(view.notes)
    other = ", or are not of the largest group," if found.is_largest_alone else ""
    dropped = int((~found.kept).sum())
    by_grids = int(found.by_grids[found.parts[0]].sum())
    for count, why in ((view.lines - len(graph.segments), "in the photo"), (dropped, "in space")):
        if count:
            notes.append(
                f"{count} lines touch too few others {why}{other} and are left out: a group has at least "
                f"{MIN_COMPONENT}"
            )
    if by_grids:
        notes.append(
            f"{by_grids} lines of component 0 are not connected to the rest of it by crossings: their place follows "
            "from window grids that continue (supported)"
        )
    by = "at the depth of their neighbours in the photo"
    if solution.formulation == "bodies":
        is_heard = depth_map is not None and not depth_map.left_out
        by = f"where planes and heights that match{' or the depth map' if is_heard else ''} put them"
    return (*notes, *notes_on_solver(solution), *_placing_notes(found, by))


def _placing_notes(found: Components, by: str) -> list[str]:
    notes = []
    if len(found.parts) > 1:
        notes.append(
            f"{len(found.parts) - 1} smaller groups of lines, which no crossings connect to component 0, are placed "
            f"{by} and marked weak"
        )
    shift = found.lifted.shift[found.kept]
    moved = int((shift > SHIFT_NOTED).sum())
    if moved:
        notes.append(f"{moved} lines moved by up to {np.degrees(shift.max()):.1f} degrees to meet the others exactly")
    return notes
