"""The paper's program solved by Gurobi under the licence that comes with gurobipy, for comparison only.

That licence takes at most MOST variables and as many rows. gurobipy is no dependency: pip install gurobipy.
"""

import importlib
import tempfile
import time
from pathlib import Path

from linecad.line_graph import LineGraph
from solver.backends.scip import FEASIBILITY_TOLERANCE
from solver.depths import end_ratios
from solver.families import find_families
from solver.options import SolveOptions, relative_gap
from solver.paper.milp import build_model

MOST = 2000  # variables, and rows


class SkippedError(Exception):
    """Gurobi cannot be asked; the message says why, in one line."""


def solve_by_gurobi(graph: LineGraph, options: SolveOptions) -> tuple[str, float, float, int, float]:
    """Status, objective, gap, nodes and seconds with the building of the model, one thread, gap 0, cold start."""
    began = time.monotonic()
    try:
        gurobi = importlib.import_module("gurobipy")
    except ModuleNotFoundError:
        raise SkippedError("gurobipy is not installed") from None
    model = build_model(graph, find_families(graph, options.without), options, end_ratios(graph)).model
    if max(model.getNVars(), model.getNConss()) > MOST:
        raise SkippedError(f"{model.getNVars()} variables and {model.getNConss()} rows, its licence takes {MOST}")
    with tempfile.TemporaryDirectory() as folder:
        file = str(
            Path(folder) / "paper.mps"
        )  # SCIP writes the constant of the objective to LP files as Gurobi does not read it
        model.writeProblem(file, verbose=False)
        try:
            environment = gurobi.Env(params={"OutputFlag": 0, "Threads": 1, "MIPGap": 0.0})
            environment.setParam("FeasibilityTol", FEASIBILITY_TOLERANCE)
            environment.setParam("IntFeasTol", FEASIBILITY_TOLERANCE)
            environment.setParam("TimeLimit", options.seconds - (time.monotonic() - began))
            read = gurobi.read(file, env=environment)
            read.optimize()
        except gurobi.GurobiError as error:
            raise SkippedError(f"gurobipy: {error}") from error
    status = {gurobi.GRB.OPTIMAL: "optimal", gurobi.GRB.TIME_LIMIT: "time limit"}[read.Status]
    gap = relative_gap(read.ObjVal, read.ObjBound)
    return status, read.ObjVal, gap, int(read.NodeCount), time.monotonic() - began
