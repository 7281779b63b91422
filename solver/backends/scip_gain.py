"""SCIP behind the search of formulation "gain": SoPlex for the relaxations, SCIP with lazy rows for the rest.

The lazy rows come from a constraint handler: one search tree, in which every solution is tested by propagating depths
and every relaxation is searched for broken rows. Measured against solving and cutting in turns, on graphs of the
paper's size: 0.05 to 8 s where the turns take 1 to 32 s, since each turn grows its tree anew.

SCIP does not see the rows that are still to come, so whatever it concludes from the rows that it has must be off:
symmetry, and reductions that only keep some optimal solution (`BLIND`). With them on it can cut off the optimum.
"""

import threading
from collections.abc import Callable

import numpy as np
from pyscipopt import LP, Conshdlr, Constraint, Model, Variable, quicksum
from pyscipopt.scip import PY_SCIP_LPPARAM as SCIP_LPPARAM
from pyscipopt.scip import PY_SCIP_PARAMSETTING as SCIP_PARAMSETTING
from pyscipopt.scip import PY_SCIP_RESULT as SCIP_RESULT
from pyscipopt.scip import Solution

from linecad.arrays import Float
from solver.backends.scip import Watch, run, version
from solver.gain.backend import Integral, Relaxed
from solver.gain.master import Program, Row
from solver.gain.separation import Separation
from solver.options import SolveOptions
from solver.progress import Reporter

BLIND = {"misc/usesymmetry": 0, "misc/allowstrongdualreds": False, "misc/allowweakdualreds": False}

# These programs are degenerate: one trial branching takes a thousand iterations, and at SCIP's own settings 10 of 12 s
# went into the first four nodes. Tried on two graphs of the paper's size, 5 and over 12 s became 4 and 4.
LEAN = {
    "branching/relpscost/inititer": 50,
    "branching/relpscost/initcand": 20,
    "separating/gomory/freq": -1,
    "separating/aggregation/freq": -1,
}


class ScipBackend:
    """SCIP with its LP solver."""

    @property
    def name(self) -> str:
        """Name and version."""
        return version()

    def relaxation(self, program: Program) -> "SoplexRelaxation":
        """A relaxation that starts from its last basis."""
        return SoplexRelaxation(program)

    def solve_integer(
        self,
        program: Program,
        separation: Separation,
        options: SolveOptions,
        start: Float,
        reporter: Reporter,
        stop: threading.Event,
    ) -> Integral:
        """See `solver.gain.backend.Backend`.

        All columns are declared integer: the optimum is the same (`solver.gain.master`), and SCIP can then round its
        bound where weights and rewards have a common measure: most graphs with weights of one are decided at the root.
        """
        model = Model("linecad")
        model.hideOutput()
        x = Columns(model, program)
        for number, row in enumerate(program.rows):
            x.add_row(row, f"row_{number}")
        model.setObjective(quicksum(program.objective[k] * v for k, v in x.free.items()), "maximize")
        model.addObjoffset(program.offset + float(np.dot(program.objective, x.fixed)))
        for name, value in (BLIND | LEAN).items():
            model.setParam(name, value)
        model.setHeuristics(SCIP_PARAMSETTING.OFF)  # they know a part of the rows only; `solver.start` knows all
        handler = LazyRows(separation, x)
        model.includeConshdlr(
            handler,
            "linecad_lazy_rows",
            "cycles that do not balance and pairs that are not planar",
            sepapriority=10,
            enfopriority=-10,
            chckpriority=-10,
            sepafreq=1,
            propfreq=-1,
            eagerfreq=-1,
            maxprerounds=0,
            needscons=False,
        )
        first = model.createSol()
        for k, variable in x.free.items():
            model.setSolVal(first, variable, float(start[k]))
        model.addSol(first)
        outcome = run(model, options, Watch(model, reporter), stop)
        if handler.failure is not None:
            raise handler.failure
        if not outcome.has_solution:
            return Integral(outcome.status, None)
        return Integral(outcome.status, x.values(model.getBestSol()))


class Columns:
    """The columns of a program in a SCIP model; those that are fixed are numbers there, not variables."""

    def __init__(self, model: Model, program: Program) -> None:
        self.model = model
        lower, upper = np.array(program.lower), np.array(program.upper)
        is_fixed = lower == upper
        self.fixed: Float = np.where(is_fixed, lower, 0.0)  # 0 for the others
        self.free: dict[int, Variable] = {
            k: model.addVar(f"x_{k}", vtype="I", lb=program.lower[k], ub=program.upper[k])
            for k in np.flatnonzero(~is_fixed).tolist()
        }
        for k, variable in self.free.items():
            if k < program.integers:
                model.chgVarBranchPriority(variable, 1)  # the others follow from these

    def add_row(self, row: Row, name: str) -> None:
        """Write a row of the program as a linear constraint, unless nothing in it is free.

        Such a row holds: the fixed columns have the values of the start, which breaks none.
        """
        terms, right = [], row.right
        for k, coefficient in zip(row.columns, row.coefficients, strict=True):
            if k in self.free:
                terms.append(coefficient * self.free[k])
            else:
                right -= coefficient * float(self.fixed[k])
        if terms:
            self.model.addCons(quicksum(terms) <= right, name, removable=True)

    def values(self, solution: Solution | None) -> Float:
        """The values of all columns in a solution, or in the relaxation for None."""
        found = self.fixed.copy()
        for k, variable in self.free.items():
            found[k] = self.model.getSolVal(solution, variable)
        return found


class LazyRows(Conshdlr):
    """Adds the rows that a solution or a relaxation breaks while SCIP searches."""

    def __init__(self, separation: Separation, x: Columns) -> None:
        self.separation = separation
        self.x = x
        self.failure: Exception | None = None
        self.rows = 0

    def conscheck(self, _constraints: object, solution: Solution, *_: object) -> dict[str, int]:
        """Whether a solution breaks no row."""
        return self._guard(lambda: SCIP_RESULT.INFEASIBLE if self._breaks(solution) else SCIP_RESULT.FEASIBLE)

    def consenfolp(self, *_: object) -> dict[str, int]:
        """Cut off an integral relaxation that breaks a row."""
        return self._guard(lambda: SCIP_RESULT.CONSADDED if self._add(exact=True) else SCIP_RESULT.FEASIBLE)

    def consenfops(self, *_: object) -> dict[str, int]:
        """The same where the relaxation was not solved."""
        return self.consenfolp()

    def conssepalp(self, *_: object) -> dict[str, int]:
        """Cut off a fractional relaxation, if that can be done."""
        nothing = SCIP_RESULT.DIDNOTFIND
        return self._guard(lambda: SCIP_RESULT.CONSADDED if self._add(exact=False) else nothing, nothing)

    def conslock(self, _constraint: Constraint, _kind: int, positive: int, negative: int) -> None:
        """A row may hold any variable back in either direction."""
        for variable in self.x.free.values():
            self.model.addVarLocks(variable, positive + negative, positive + negative)

    def _breaks(self, solution: Solution) -> bool:
        return self.separation.breaks(self.x.values(solution))

    def _add(self, exact: bool) -> int:
        rows = self.separation.broken_rows(self.x.values(None), exact)
        for row in rows:
            self.rows += 1
            self.x.add_row(row, f"lazy_{self.rows}")
        return len(rows)

    def _guard(self, answer: Callable[[], int], after_failure: int = SCIP_RESULT.INFEASIBLE) -> dict[str, int]:
        """A failure in a callback would be printed and passed over; it stops the search and is raised after it."""
        try:
            return {"result": answer()}
        except Exception as failure:
            self.failure = self.failure or failure
            self.model.interruptSolve()
            return {"result": after_failure}


class SoplexRelaxation:
    """The linear relaxation of a program that grows, solved by the dual simplex from its last basis."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.lp = LP("linecad", "maximize")
        self.rows = 0

    def solve(self, seconds: float) -> Relaxed | None:
        """See `solver.gain.backend.Relaxation`."""
        program, lp = self.program, self.lp
        new = slice(lp.ncols(), None)
        if program.objective[new]:
            empty: list[list[tuple[int, float]]] = [[] for _ in program.objective[new]]
            lp.addCols(empty, program.objective[new], program.lower[new], program.upper[new])
        fresh = program.rows[self.rows :]
        if fresh:
            entries = [list(zip(row.columns, row.coefficients, strict=True)) for row in fresh]
            lp.addRows(entries, [-lp.infinity()] * len(fresh), [row.right for row in fresh])
            self.rows = len(program.rows)
        lp.setRealParam(SCIP_LPPARAM.LPTILIM, seconds)
        lp.solve()
        if not lp.isOptimal():
            return None
        return Relaxed(lp.getObjVal() + program.offset, np.array(lp.getPrimal()), np.array(lp.getRedcost()))
