"""`place`: ties in, the scales of all bodies out."""

import time
from dataclasses import replace

import numpy as np

from linecad.arrays import Float, Int
from linecad.line_graph import Status
from solver.backends.scip import Watch, run, version
from solver.bodies.local_search import climb, improve, margins
from solver.bodies.program import FARTHEST, build
from solver.bodies.ties import ROUNDING, Placement, Ties
from solver.least_squares import shortest_solution
from solver.options import LONGEST_TIME_S, OnProgress, SolveOptions, relative_gap
from solver.progress import Reporter, catch_interrupt

MOST_NODES = 4_000  # where the options name no limit: half a minute at worst; most photos take up to some hundred


def place(
    ties: Ties,
    count: int,
    reference: int,
    options: SolveOptions,
    on_progress: OnProgress = None,
    near: Float | None = None,
) -> Placement:
    """The log scales of `count` bodies at which ties of the most weight hold at once, 0 for the `reference`.

    Exact within `FARTHEST` of the reference, by SCIP; the same ties and seed give the same answer, since no clock
    ends the search unless the options name a time. Bodies that no counted tie leads to keep their scale. The search
    begins by a climb from `near` (B,), where the best is likely, else by several from places of its own. Raises
    SolverError.
    """
    began = time.monotonic()
    start = np.zeros(count) if near is None else near
    if len(ties):
        start = improve(ties, start, options.seed) if near is None else climb(ties, start)[0]
    start = _about(ties, start, reference)
    objective = ties.value(start)
    log_scale, bound, nodes = start, objective, 0
    status: Status = "optimal"
    if len(ties):
        program = build(ties, count, reference)
        # A start beyond what is looked at is none of the program's solutions, but still what they have to beat.
        is_beyond = bool(np.abs(start).max() > FARTHEST)
        if is_beyond:
            program.model.setObjlimit(objective)
        else:
            program.offer(ties, start)
        reporter = Reporter(began, objective, float(ties.weight.sum()), on_progress)
        watch = Watch(program.model, reporter)
        limits = replace(
            options,
            time_limit_s=options.time_limit_s or LONGEST_TIME_S,
            node_limit=options.node_limit or MOST_NODES,
        )
        with catch_interrupt() as stop:
            outcome = run(program.model, limits, watch, stop, is_beyond)
        found = _about(ties, program.log_scale(), reference) if outcome.has_solution else start
        if ties.value(found) > objective:
            log_scale, objective = found, ties.value(found)
        status, nodes = outcome.status, reporter.nodes
        bound = objective if status == "optimal" else max(objective, reporter.bound)
    log_scale = _about(ties, _refined(ties, log_scale), reference)
    return Placement(
        log_scale=log_scale,
        counted=ties.counted(log_scale),
        objective=objective,
        bound=bound,
        gap=relative_gap(objective, bound),
        status=status,
        nodes=nodes,
        solver=version(),
        margin=margins(ties, log_scale, reference),
    )


def _about(ties: Ties, log_scale: Float, reference: int) -> Float:
    """The same scales with 0 for the reference, and for the first body of each part that no counted tie leads to.

    What is left of the evidence says nothing about such a part, so its largest body stays where the fit has it.
    """
    part = ties.parts(ties.counted(log_scale), len(log_scale))
    lead = np.array([int(np.argmax(part == number)) for number in range(part.max(initial=-1) + 1)], np.int64)
    lead[part[reference]] = reference
    about: Float = log_scale - log_scale[lead[part]]
    return about


def _refined(ties: Ties, log_scale: Float) -> Float:
    """The middle of what counts: weighted least squares, as far as the counted ties still hold on the way there.

    The program knows intervals only, and its answer lies at their ends. Ties that yield come after all others: they
    shift as wholes what these hold together, and may cease to hold.
    """
    counted, yields = ties.counted(log_scale), np.asarray(ties.yields)
    firm = ties.subset(counted & ~yields)
    refined, part = log_scale, np.arange(len(log_scale))
    while True:
        step = _step(firm, refined, part)
        share, tie = _way(firm, refined, step)
        refined = refined + share * step
        if tie is None:
            break
        one, other = part[firm.bodies[tie]]  # at the end of this interval: its bodies go on together
        part = np.where(part == other, one, part)
    part = ties.parts(counted & ~yields, len(log_scale))
    return refined + _step(ties.subset(counted & yields), refined, part)


def _way(ties: Ties, log_scale: Float, step: Float) -> tuple[float, int | None]:
    """The share of a step (B,) for which all ties still hold, and the tie at the end of whose interval it ends."""
    first, second = ties.bodies.T
    moved = step[first] - step[second]
    missed = ties.log_ratio - (log_scale[first] - log_scale[second])
    with np.errstate(divide="ignore"):
        room = np.maximum(ties.tolerance + np.sign(moved) * missed, 0.0) / np.abs(moved)
    room = np.where(np.abs(moved) > ROUNDING, room, np.inf)
    tie = int(room.argmin()) if len(room) else None
    return (1.0, None) if tie is None or room[tie] >= 1.0 else (float(room[tie]), tie)


def _step(ties: Ties, log_scale: Float, part: Int) -> Float:
    """By how much each body (B,) moves so that all of the ties are met best, each `part` (B,) as a whole.

    The shortest step of all, so that what no tie holds stays. By the rows themselves and not their squares: what a
    person called real weighs so much that the normal equations are singular to machine precision.
    """
    if not len(ties):
        return np.zeros(len(log_scale))
    first, second = ties.bodies.T
    rows, at = np.zeros((len(ties), len(log_scale))), np.arange(len(ties))
    rows[at, first], rows[at, second] = 1.0, -1.0
    weight = np.sqrt(ties.weight) / ties.tolerance
    missed = weight * (ties.log_ratio - rows @ log_scale)
    of_parts = rows @ (part[:, None] == np.arange(part.max() + 1)).astype(np.float64)
    return shortest_solution(weight[:, None] * of_parts, missed)[part]
