"""The stages in the paper's order (algorithm 1): a photo becomes a scene."""

from dataclasses import dataclass, replace

from linecad.camera.photo import Photo
from linecad.corrections.annotations import Annotations, as_found, by_hand, facts_of
from linecad.corrections.apply import correct
from linecad.corrections.corrected import CorrectedLines, ToldFact
from linecad.corrections.edits import Corrections
from linecad.decide.annotations import annotate, solve_annotated, told_in_the_photo, with_annotations
from linecad.decide.decision import Decision, decide
from linecad.depth.depth_map import DepthMap
from linecad.depth.intrinsics import note_on_intrinsics
from linecad.errors import DepthMapError, ReconstructionError
from linecad.finding import FoundLines, connect, find_lines
from linecad.line_graph import LineGraph, Segments, Solution
from linecad.model.build import View, build_scene, find_components
from linecad.model.known_lengths import measured
from linecad.model.lifting import Lifted, lift
from linecad.model.regions.roofs import Sketch
from linecad.options import Options
from linecad.progress import StageReport, silent
from linecad.scene import Camera, Scene
from linecad.ties.evidence import Evidence, find_evidence
from linecad.ties.parting import DecidedParts, decide_parts, part_by_map
from linecad.ties.placing import BodyPlaces, Placed, place_on
from linecad.ties.setting import Sight
from solver.options import OnProgress

NO_BODIES = "what was said of bodies is left out, as this program places none; leave --option formulation away"


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """A scene with all that it was made of."""

    whole: LineGraph  # of all lines that were found
    graph: LineGraph  # the part of it that was solved
    solution: Solution  # of the program
    decision: Decision  # about every crossing of the graph
    lifted: Lifted  # the lines of the graph in space, before components are placed
    scene: Scene
    places: BodyPlaces | None  # of its bodies; None for programs without them


def reconstruct(
    photo: Photo,
    options: Options,
    on_progress: OnProgress = None,
    on_stage: StageReport = silent,
    corrections: Corrections | None = None,
    depth: DepthMap | None = None,
) -> Scene:
    """The lines, planes and boundaries of a photo's scene. Raises ReconstructionError when it shows too little.

    With `corrections`, lines and crossings are as a person annotated them; a ContradictionError where that cannot all
    be true, a note where it names what is not there. With `depth`, a map on the photo's pixels
    (`linecad.depth.to_photo`), bodies that crossings leave free stand where the map has them; a DepthMapError where
    its kind cannot be told.
    """
    drawn = None if corrections is None else corrections.frame
    found = find_lines(photo, on_stage, options.faint, drawn, options.uses_face_lines)
    if corrections is None:
        return reconstruct_lines(photo.name, found, options, on_progress, on_stage, depth=depth).scene
    found = found.grouped(options)
    corrected = correct(found.segments, found.camera, found.frame, corrections)
    made = reconstruct_lines(photo.name, found, options, on_progress, on_stage, corrected, depth)
    return measured(made.scene, corrected)


@dataclass(frozen=True, eq=False)
class Prepared:
    """What a photo shows once a person's words about its lines and crossings are known, before bodies are placed."""

    found: FoundLines  # its segments are those after all edits
    whole: LineGraph  # of all lines
    graph: LineGraph  # the part of it that is solved
    annotations: Annotations
    details: Segments | None  # edges that faces can place
    corrected: CorrectedLines | None
    evidence: Evidence | None  # of the places of bodies; None for programs without them
    parts: DecidedParts | None  # by what the photo and its depth map show without that person; None without a map

    def is_for(self, corrected: CorrectedLines) -> bool:
        """Whether it holds after other edits too."""
        return self.corrected is not None and self.corrected.differs_in_places(corrected)

    def facts(self, corrected: CorrectedLines | None) -> tuple[tuple[ToldFact, ...], tuple[str, ...]]:
        """What a person says of the bodies of these lines, by the nodes of the graph; and notes on what is left out."""
        return ((), ()) if corrected is None else facts_of(self.graph, corrected)


def reconstruct_lines(
    photo: str,
    found: FoundLines,
    options: Options,
    on_progress: OnProgress = None,
    on_stage: StageReport = silent,
    corrected: CorrectedLines | None = None,
    depth: DepthMap | None = None,
) -> Reconstruction:
    """The scene of the lines that were found in a photo of that name, or of the same after all edits (`corrected`).

    Raises ReconstructionError, SolverError or, where annotations cannot all be true, ContradictionError. The scale of
    known lengths is not set (`linecad.model.known_lengths.measured`).
    """
    prepared = prepare(found, options, on_stage, corrected, depth)
    return reconstruct_prepared(photo, prepared, options, on_progress, on_stage, corrected)


def prepare(
    found: FoundLines,
    options: Options,
    on_stage: StageReport = silent,
    corrected: CorrectedLines | None = None,
    depth: DepthMap | None = None,
    parts: DecidedParts | None = None,
) -> Prepared:
    """All that comes before bodies are placed; raises as `reconstruct_lines`.

    With `parts`, those are not decided again: they were for the same lines as found, the same map and options.
    """
    details, before = None, found
    if options.uses_face_lines:
        details = found.details_for_faces(taken_away(found.segments, corrected))
    if corrected is not None:
        found = replace(found, segments=corrected.segments)
    whole, graph = connect(found, options)
    graph, annotations = annotate(graph, corrected)
    evidence = None
    if options.uses_bodies:
        sight = Sight(found.camera.matrix, found.frame.axes, found.camera.width, found.pixels, depth)
        changed = corrected is not None and corrected.changes_evidence(before.segments)
        if parts is None and depth is not None:
            parts, evidence = _parts_of(before, sight, options, changed, on_stage)
        if evidence is None or changed:
            evidence = _look(graph, sight, options, annotations, corrected, parts, on_stage)
        evidence = part_by_map(evidence)
    return Prepared(found, whole, graph, annotations, details, corrected, evidence, parts)


def prepared_for(
    prepared: Prepared, options: Options, corrected: CorrectedLines, on_stage: StageReport = silent
) -> Prepared:
    """The same after other edits that only say something of bodies (`CorrectedLines.differs_in_facts`)."""
    graph, known = prepared.graph, prepared.evidence
    if known is None or prepared.is_for(corrected):
        return replace(prepared, corrected=corrected)
    sight = known.setting.sight
    evidence = _look(graph, sight, options, prepared.annotations, corrected, prepared.parts, on_stage)
    return replace(prepared, corrected=corrected, evidence=part_by_map(evidence))


def _parts_of(
    found: FoundLines, sight: Sight, options: Options, changed: bool, on_stage: StageReport
) -> tuple[DecidedParts, Evidence] | tuple[None, None]:
    """The parts of bodies that a photo's depth map has elsewhere, and what the photo by itself tells, which decides.

    None where the photo by itself gives no scene; raises what is in the way where it is not `changed` by corrections.
    """
    try:
        graph, annotations = annotate(connect(found, options)[1], None)
        evidence = _look(graph, sight, options, annotations, None, None, on_stage)
    except (ReconstructionError, DepthMapError):
        if changed:  # which may have mended it
            return None, None
        raise
    parts = decide_parts(evidence, options.solve, on_stage)
    return parts, replace(evidence, parts=parts.parts)


def _look(
    graph: LineGraph,
    sight: Sight,
    options: Options,
    annotations: Annotations,
    corrected: CorrectedLines | None,
    parts: DecidedParts | None,
    on_stage: StageReport,
) -> Evidence:
    """What the photo tells of the bodies of a graph's lines, before parts are parted off."""
    limits = with_annotations(options.solve, annotations)
    facts = () if corrected is None else facts_of(graph, corrected)[0]
    known = ((), ()) if parts is None else parts.now(as_found(graph, corrected))
    with told_in_the_photo(graph, corrected):
        return find_evidence(graph, sight, limits, facts, on_stage, *known)


def reconstruct_prepared(
    photo: str,
    prepared: Prepared,
    options: Options,
    on_progress: OnProgress = None,
    on_stage: StageReport = silent,
    corrected: CorrectedLines | None = None,
) -> Reconstruction:
    """The scene of a photo of that name by what was prepared, and the facts of `corrected`, for which it must be.

    Raises as `reconstruct_lines`.
    """
    found, graph, annotations, evidence = prepared.found, prepared.graph, prepared.annotations, prepared.evidence
    facts, on_facts = prepared.facts(corrected)
    placed = None
    if evidence is not None:
        limits = with_annotations(options.solve, annotations)
        with told_in_the_photo(graph, corrected):
            placed = place_on(evidence, graph, limits, facts, on_progress, on_stage)
        placed = replace(placed, by_hand=by_hand(graph, corrected))
        solution = placed.solution
        on_facts += placed.places.told.notes(facts)
    else:
        on_stage(f"solving {len(graph.segments)} lines with {len(graph.edges)} crossings")
        solution = solve_annotated(graph, options.solve, annotations, corrected, on_progress)
        on_facts += (NO_BODIES,) * bool(facts)
    on_stage("deciding which crossings are real")
    inconsistency = found.inconsistency if options.joins_used == "stable" else None
    decision = decide(graph, solution, options, inconsistency, annotations)
    on_stage("lifting the lines into space")
    depth = None if evidence is None else evidence.setting.sight.depth
    on_edits = () if corrected is None else corrected.notes
    notes = (
        found.notes
        + on_edits
        + annotations.notes
        + on_facts
        + decision.notes
        + _notes_on_map(depth, placed, found.camera)
    )
    whole, details = prepared.whole, prepared.details
    sketch = None if found.raw is None or not options.roofs else Sketch(found.raw, whole.segments.ends, whole.axis)
    view = View(
        photo, found.camera, found.frame, found.certainty, len(whole.segments), notes, found.pixels, details, sketch,
        () if corrected is None else corrected.faces,
    )  # fmt: skip
    lifted = lift(graph, decision.real, solution.log_depth)
    found_components = find_components(view, graph, decision, lifted, options.largest_component)
    if options.largest_component:
        decision = decision.within(found_components.kept, graph)
    on_stage("building planes and faces")
    scene = build_scene(view, graph, solution, decision, found_components, placed)
    places = None if placed is None else placed.places
    return Reconstruction(whole, graph, solution, decision, lifted, scene, places)


def taken_away(found: Segments, corrected: CorrectedLines | None) -> Segments:
    """The segments that a person took away or changed."""
    if corrected is None:
        return Segments.none()
    return found.subset(corrected.segments.rows(found) < 0)


def _notes_on_map(depth: DepthMap | None, placed: Placed | None, camera: Camera) -> tuple[str, ...]:
    """What to know about the depth map that was given."""
    if depth is None or placed is None or placed.depth_map is None:
        return ()
    if placed.depth_map.left_out:
        return (f"the depth map {depth.name} was left out: {placed.depth_map.left_out}",)
    return note_on_intrinsics(depth, camera)
