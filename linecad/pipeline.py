"""The stages in the paper's order (algorithm 1): a photo becomes a scene."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from linecad.camera.photo import Photo
from linecad.corrections.apply import CorrectedLines, Said, correct, rows_of, said_of
from linecad.corrections.edits import Corrections
from linecad.errors import ContradictionError
from linecad.finding import FoundLines, ReconstructOptions, StageReport, connect, find_lines, silent
from linecad.line_graph import LineGraph
from linecad.model.build import place
from linecad.scene import Scene
from solver.options import Progress
from solver.solve import solve

SURE_FACTOR = 2.0  # by which the tolerance of a crossing grows that a person called real
WIDEST_TOLERANCE = float(np.log(100.0))  # of a crossing that a person called real, in log depth
LENGTHS_DISAGREE = 1.05  # ratio of the scales that two known lengths give, above which a note says so


def reconstruct(
    photo: Photo,
    options: ReconstructOptions,
    on_progress: Callable[[Progress], None] | None = None,
    on_stage: StageReport = silent,
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
    on_stage: StageReport = silent,
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
