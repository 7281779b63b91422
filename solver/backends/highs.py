"""HiGHS as a second solver: the paper's MILP from its SCIP model, and relaxations and cuts in turns for "gain".

HiGHS takes no rows while it searches, so that formulation "gain" solves, adds the rows that the answer breaks, and
solves again. Each program is a relaxation of the whole, so each bound is valid; the first answer that breaks nothing is
optimal. HiGHS is optional: the extra `highs`.
"""

import math
import threading
import time
from dataclasses import dataclass

import numpy as np
from pyscipopt import Model

from linecad.arrays import Float
from linecad.errors import SolverError
from linecad.line_graph import Status
from solver.gain.backend import Integral, Relaxed
from solver.gain.master import Program, Row
from solver.gain.separation import Separation
from solver.options import SolveOptions
from solver.progress import Reporter

try:
    import highspy
except ImportError as missing:
    raise SolverError("HiGHS is not installed; install linecad with the extra highs: linecad[highs]") from missing

TICK_S = 0.2  # between looks at Ctrl-C
FEASIBLE = 2  # HiGHS's kSolutionStatusFeasible
LEAST_TIME_S = 0.01  # HiGHS gets at least this, however long the model took to build
FEASIBILITY_TOLERANCE = 1e-7  # as in `solver.backends.scip`

STATUSES: dict[highspy.HighsModelStatus, Status] = {
    highspy.HighsModelStatus.kOptimal: "optimal",
    highspy.HighsModelStatus.kTimeLimit: "time limit",
    highspy.HighsModelStatus.kSolutionLimit: "node limit",
    highspy.HighsModelStatus.kInterrupt: "interrupted",
    highspy.HighsModelStatus.kMemoryLimit: "memory limit",
}


@dataclass(frozen=True, eq=False)
class Answer:
    """How HiGHS ended; `x` is None where it has no solution."""

    status: Status
    bound: float
    x: Float | None
    nodes: int


def version() -> str:
    """Name and version of the solver, as solutions state it."""
    return f"HiGHS {highspy.Highs().version()}"


class HighsBackend:
    """HiGHS behind the search of formulation "gain"."""

    @property
    def name(self) -> str:
        """Name and version."""
        return version()

    def relaxation(self, program: Program) -> "HighsRelaxation":
        """A relaxation that starts from its last basis."""
        return HighsRelaxation(program)

    def solve_integer(
        self,
        program: Program,
        separation: Separation,
        options: SolveOptions,
        start: Float,
        reporter: Reporter,
        stop: threading.Event,
    ) -> Integral:
        """See `solver.gain.backend.Backend`."""
        highs = _new(options)
        _extend(highs, program, 0, 0)
        highs.changeObjectiveSense(highspy.ObjSense.kMaximize)
        highs.changeObjectiveOffset(program.offset)
        columns = np.arange(len(program.objective), dtype=np.int32)
        highs.changeColsIntegrality(len(columns), columns, np.array([highspy.HighsVarType.kInteger] * len(columns)))
        nodes = 0
        while True:
            answer = search(highs, options, start, reporter, stop)
            nodes += answer.nodes
            reporter.note(-math.inf, answer.bound, nodes)
            reporter.report()
            if answer.x is None:
                return Integral(answer.status, None)
            rows = separation.broken_rows(answer.x, exact=True)
            if not rows:
                return Integral(answer.status, answer.x)
            if answer.status not in ("optimal", "gap limit"):
                return Integral(answer.status, None)
            _add_rows(highs, rows)


def search(
    highs: "highspy.Highs", options: SolveOptions, start: Float, reporter: Reporter, stop: threading.Event
) -> Answer:
    """Run a model, which has an objective to maximise, within what is left of the limits."""
    highs.setOptionValue("time_limit", max(LEAST_TIME_S, options.seconds - (time.monotonic() - reporter.began)))
    solution = highspy.HighsSolution()
    solution.col_value = start.tolist()
    highs.setSolution(solution)
    # HiGHS runs in a thread of its own, and this one is free for Ctrl-C and for reports
    highs.HandleKeyboardInterrupt = False
    running = threading.Thread(target=highs.run)
    running.start()
    while running.is_alive():
        running.join(TICK_S)
        if stop.is_set():
            highs.cancelSolve()
        reporter.report()
    found = highs.getModelStatus()
    if found not in STATUSES:
        raise SolverError(f"HiGHS ended with {highs.modelStatusToString(found)}; try the backend scip")
    info = highs.getInfo()
    status = STATUSES[found]
    has_solution = info.primal_solution_status == FEASIBLE
    x = np.array(highs.getSolution().col_value) if has_solution else None
    if status == "optimal" and info.mip_gap > options.gap > 0:
        status = "gap limit"
    bound = info.mip_dual_bound if math.isfinite(info.mip_dual_bound) else math.inf
    return Answer(status, bound, x, max(0, int(info.mip_node_count)))


def from_scip(model: Model, options: SolveOptions) -> tuple["highspy.Highs", list[str]]:
    """The same program in HiGHS, with the names of its columns in order; all rows of `model` are linear."""
    variables = model.getVars()
    place = {variable.name: k for k, variable in enumerate(variables)}
    rows = []
    for constraint in model.getConss():
        terms = model.getValsLinear(constraint)
        columns = tuple(place[name] for name in terms)
        right, left = model.getRhs(constraint), model.getLhs(constraint)
        if not model.isInfinity(right):
            rows.append(Row(columns, tuple(terms.values()), right))
        if not model.isInfinity(-left):
            rows.append(Row(columns, tuple(-value for value in terms.values()), -left))
    program = Program(
        integers=0,
        lower=[variable.getLbOriginal() for variable in variables],
        upper=[variable.getUbOriginal() for variable in variables],
        objective=[variable.getObj() for variable in variables],
        offset=model.getObjoffset(),
        rows=rows,
    )
    highs = _new(options)
    _extend(highs, program, 0, 0)
    highs.changeObjectiveSense(highspy.ObjSense.kMaximize)
    highs.changeObjectiveOffset(program.offset)
    whole = np.array([k for k, variable in enumerate(variables) if variable.vtype() == "BINARY"], np.int32)
    highs.changeColsIntegrality(len(whole), whole, np.array([highspy.HighsVarType.kInteger] * len(whole)))
    return highs, list(place)


class HighsRelaxation:
    """The linear relaxation of a program that grows, solved from its last basis."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.highs = highspy.Highs()
        self.highs.silent()
        self.highs.changeObjectiveSense(highspy.ObjSense.kMaximize)
        self.rows = 0

    def solve(self, seconds: float) -> Relaxed | None:
        """See `solver.gain.backend.Relaxation`."""
        _extend(self.highs, self.program, self.highs.getNumCol(), self.rows)
        self.rows = len(self.program.rows)
        self.highs.setOptionValue("time_limit", self.highs.getRunTime() + seconds)
        self.highs.run()
        if self.highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        found = self.highs.getSolution()
        value = self.highs.getObjectiveValue() + self.program.offset
        return Relaxed(value, np.array(found.col_value), np.array(found.col_dual))


def _new(options: SolveOptions) -> "highspy.Highs":
    highs = highspy.Highs()
    highs.silent()
    values: dict[str, float | int] = {
        "random_seed": options.seed,
        "mip_rel_gap": options.gap,
        "mip_abs_gap": 1e-6,
        "mip_feasibility_tolerance": FEASIBILITY_TOLERANCE,
        "primal_feasibility_tolerance": FEASIBILITY_TOLERANCE,
        "threads": 1,
    }
    if options.node_limit is not None:
        values["mip_max_nodes"] = options.node_limit
    for name, value in values.items():
        highs.setOptionValue(name, value)
    return highs


def _extend(highs: "highspy.Highs", program: Program, column: int, row: int) -> None:
    """Give HiGHS what the program has gained since it had so many columns and rows."""
    new = slice(column, None)
    count = len(program.objective[new])
    none = np.zeros(0, np.int32)
    if count:
        highs.addCols(
            count, np.array(program.objective[new]), np.array(program.lower[new]), np.array(program.upper[new]),
            0, np.zeros(count, np.int32), none, np.zeros(0),
        )  # fmt: skip
    _add_rows(highs, program.rows[row:])


def _add_rows(highs: "highspy.Highs", rows: list[Row]) -> None:
    if not rows:
        return
    sizes = [len(row.columns) for row in rows]
    start = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int32)
    columns = np.array([k for row in rows for k in row.columns], np.int32)
    values = np.array([a for row in rows for a in row.coefficients])
    right = np.array([row.right for row in rows])
    highs.addRows(len(rows), np.full(len(rows), -highspy.kHighsInf), right, len(columns), start, columns, values)
