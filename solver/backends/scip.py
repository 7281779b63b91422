"""SCIP run to an answer: parameters, limits, progress, and one total table of its statuses.

SCIP works in a thread of its own without Python's lock; the calling thread waits, reports progress and takes Ctrl-C.
SCIP's own handling of SIGINT is off, since it prints to stdout and would act on threads that have no part in it.
"""

import functools
import math
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Literal, assert_never, get_args

from pyscipopt import Eventhdlr, Model
from pyscipopt.scip import PY_SCIP_EVENTTYPE as SCIP_EVENTTYPE
from pyscipopt.scip import PY_SCIP_STAGE as SCIP_STAGE

from linecad.errors import SolverError
from linecad.line_graph import Status
from solver.options import SolveOptions
from solver.progress import Reporter

ScipStatus = Literal[
    "unknown",
    "userinterrupt",
    "nodelimit",
    "totalnodelimit",
    "stallnodelimit",
    "timelimit",
    "memlimit",
    "gaplimit",
    "primallimit",
    "duallimit",
    "sollimit",
    "bestsollimit",
    "restartlimit",
    "optimal",
    "infeasible",
    "unbounded",
    "inforunbd",
    "terminate",
]
SCIP_STATUSES: tuple[ScipStatus, ...] = get_args(ScipStatus)

# SCIP's own 1e-6, times L of up to 1e2, would be a twentieth of the tightest tolerance of an edge. Below 1e-7 SoPlex
# prints that it needs another arithmetic, since SCIP makes it a thousand times stricter where an LP is hard.
FEASIBILITY_TOLERANCE = 1e-7
TICK_S = 0.2  # between looks at progress and Ctrl-C
LEAST_TIME_S = 0.01  # SCIP gets at least this, however long the model took to build


@dataclass(frozen=True)
class Outcome:
    """How SCIP ended; the solution itself is in the model unless it is `found`, bound and nodes are in the reporter."""

    status: Status
    has_solution: bool
    found: dict[str, float] | None = None  # the solution, by the names of the variables, where another solver found it


def status_of(name: str) -> Status:
    """The status of a solution for SCIP's name of its own status; SolverError where there can be no solution."""
    for known in SCIP_STATUSES:
        if known == name:
            return _status_of(known)
    raise SolverError(f"SCIP ended with the unknown status {name!r}; use the SCIP version that linecad asks for")


def _status_of(name: ScipStatus) -> Status:
    match name:
        case "optimal":
            return "optimal"
        case "timelimit":
            return "time limit"
        case "gaplimit":
            return "gap limit"
        case "userinterrupt" | "terminate":
            return "interrupted"
        case "nodelimit" | "totalnodelimit" | "stallnodelimit":
            return "node limit"
        case "memlimit":
            return "memory limit"
        case "infeasible" | "unbounded" | "inforunbd":
            raise SolverError(
                f"SCIP calls the model {name}, which it never is; this is a fault of linecad, please report"
            )
        case "primallimit" | "duallimit" | "sollimit" | "bestsollimit" | "restartlimit":
            raise SolverError(f"SCIP stopped at its {name}, which linecad does not set; remove it from SCIP's settings")
        case "unknown":
            raise SolverError("SCIP ended without a status; try another seed")
        case _:
            assert_never(name)


class Watch(Eventhdlr):
    """Tells a reporter objective, bound and nodes of one model whenever SCIP has found something."""

    def __init__(self, model: Model, reporter: Reporter, bound_only: bool = False) -> None:
        """With `bound_only` the model is a relaxation: its solutions are no solutions of the problem yet."""
        self.reporter = reporter
        self.bound_only = bound_only
        self.nodes_before = reporter.nodes if bound_only else 0
        self.failure: Exception | None = None
        self.is_over = False
        model.includeEventhdlr(self, "linecad_watch", "notes progress")

    def eventinit(self) -> None:
        """Ask SCIP for the events."""
        for kind in (SCIP_EVENTTYPE.BESTSOLFOUND, SCIP_EVENTTYPE.NODESOLVED, SCIP_EVENTTYPE.DUALBOUNDIMPROVED):
            self.model.catchEvent(kind, self)

    def eventexec(self, event: object) -> None:  # noqa: ARG002 - the signature that SCIP calls
        """Note the numbers of the moment."""
        if (
            self.is_over
        ):  # freeing a stopped search sends events too; with no open node left the bound would look proven
            return
        try:
            self.note(self.model)
        except Exception as failure:  # PySCIPOpt would print it and go on; it is raised after the solve instead
            self.failure = failure
            self.model.interruptSolve()

    def note(self, model: Model) -> None:
        """Pass on what SCIP knows."""
        objective = -math.inf if self.bound_only else model.getPrimalbound()
        self.reporter.note(objective, model.getDualbound(), self.nodes_before + model.getNTotalNodes())


def run(model: Model, options: SolveOptions, watch: Watch, stop: threading.Event, has_limit: bool = False) -> Outcome:
    """Solve `model` within the limits of `options`, counted from the reporter's beginning; its progress is reported.

    With `has_limit` its objective has to be better than a limit, and that nothing is counts as optimal. Raises what the
    progress callback raised, and SolverError when SCIP fails or ends without a meaning.
    """
    reporter = watch.reporter
    _set_parameters(model, options, options.seconds - (time.monotonic() - reporter.began))
    reporter.report()
    with ThreadPoolExecutor(max_workers=1) as pool:
        running = pool.submit(model.optimizeNogil)
        try:
            while not running.done():
                wait([running], timeout=TICK_S)
                if stop.is_set():
                    _interrupt(model)
                reporter.report()
        except BaseException:
            _end(model, running)
            raise
    if watch.failure is not None:
        raise watch.failure
    try:
        running.result()
    except Exception as failure:  # PySCIPOpt has no narrower class for the return codes of SCIP
        raise SolverError(f"SCIP failed: {failure}; try another seed") from failure
    watch.note(model)
    watch.is_over = True
    name = model.getStatus()
    if has_limit and name == "infeasible":
        return Outcome("optimal", has_solution=False)
    return Outcome(status_of(name), model.getNSols() > 0)


@functools.cache
def version() -> str:
    """Name and version of the solver, as solutions state it."""
    model = Model()
    return f"SCIP {model.getMajorVersion()}.{model.getMinorVersion()}.{model.getTechVersion()}"


def _end(model: Model, running: "Future[None]") -> None:
    """Interrupt until SCIP has stopped."""
    while not running.done():
        _interrupt(model)
        wait([running], timeout=TICK_S)


def _interrupt(model: Model) -> None:
    """Ask SCIP to stop, if it is in a stage in which it takes that from another thread; else the next tick will."""
    if model.getStage() not in (SCIP_STAGE.PRESOLVING, SCIP_STAGE.SOLVING):
        return
    try:
        model.interruptSolve()
    except Exception:  # a bare one from PySCIPOpt: SCIP has left the stage since the line above
        return


def _set_parameters(model: Model, options: SolveOptions, seconds: float) -> None:
    values: dict[str, bool | int | float] = {
        "misc/catchctrlc": False,
        "limits/time": max(seconds, LEAST_TIME_S),
        "limits/gap": options.gap,
        "limits/memory": options.memory_limit_mb,
        "limits/totalnodes": -1 if options.node_limit is None else options.node_limit,
        "randomization/randomseedshift": options.seed,
        "numerics/feastol": FEASIBILITY_TOLERANCE,
    }
    for name, value in values.items():
        model.setParam(name, value)
