import json
import os
import signal
import subprocess
import sys
import threading
import time
from itertools import pairwise
from pathlib import Path
from typing import get_args

import pyscipopt
import pytest

from linecad.errors import SolverError
from linecad.line_graph import Status
from solver.backends.scip import SCIP_STATUSES, TICK_S, Watch, run, status_of
from solver.depths import end_ratios
from solver.families import find_families
from solver.options import SolveOptions
from solver.paper.milp import build_model
from solver.progress import Reporter
from solver.solve import solve

HERE = Path(__file__).parents[1]
HARD = frozenset({"planarity", "boundary"})  # off: what is left keeps SCIP busy for minutes on the street
ENOUGH = 5  # reports of progress

EXPECTED = {
    "optimal": "optimal",
    "timelimit": "time limit",
    "gaplimit": "gap limit",
    "userinterrupt": "interrupted",
    "terminate": "interrupted",
    "nodelimit": "node limit",
    "totalnodelimit": "node limit",
    "stallnodelimit": "node limit",
    "memlimit": "memory limit",
}


def test_the_table_knows_every_status_of_scip():
    names = {name.lower() for name in vars(pyscipopt.SCIP_STATUS) if name.isupper()}
    assert len(names) >= 17
    assert names <= set(SCIP_STATUSES)


@pytest.mark.parametrize("name", SCIP_STATUSES)
def test_every_status_is_a_status_of_ours_or_an_error_in_one_line(name):
    if name in EXPECTED:
        assert status_of(name) == EXPECTED[name]
    else:
        with pytest.raises(SolverError) as caught:
            status_of(name)
        assert "\n" not in str(caught.value)


def test_every_status_of_ours_comes_from_scip():
    assert set(EXPECTED.values()) == set(get_args(Status)) - {"heuristic", "robust fit"}


def test_a_status_of_a_later_scip_is_an_error():
    with pytest.raises(SolverError, match="halted"):
        status_of("halted")


@pytest.mark.parametrize(
    ("limits", "status"),
    [
        ({"time_limit_s": 0.6}, "time limit"),
        ({"time_limit_s": 1e-6}, "time limit"),
        ({"gap": 0.6}, "gap limit"),
        pytest.param({"node_limit": 1}, "node limit", marks=pytest.mark.thorough),
        ({"memory_limit_mb": 1.0}, "memory limit"),
    ],
)
def test_a_limit_ends_the_search_with_a_solution(street, limits, status):
    began = time.monotonic()
    found = solve(street, SolveOptions(**{"formulation": "paper", "time_limit_s": 100.0, "without": HARD, **limits}))
    assert found.status == status
    assert found.connected.sum() > 20
    assert found.bound > found.objective > 0
    assert time.monotonic() - began < 90


class PageClosedError(Exception):
    pass


def test_progress_never_gets_worse_and_is_not_told_too_often(street):
    reports = []

    def note(progress):
        reports.append(progress)
        if len(reports) == ENOUGH:
            raise PageClosedError

    with pytest.raises(PageClosedError):
        solve(street, SolveOptions(formulation="paper", time_limit_s=100.0, without=HARD), note)
    for before, after in pairwise(reports):
        assert after.seconds >= before.seconds
        assert after.objective >= before.objective
        assert after.bound <= before.bound
        assert after.nodes >= before.nodes
        assert after.gap == pytest.approx((after.bound - after.objective) / after.objective)
    assert reports[-1].seconds >= (ENOUGH - 3) * TICK_S


def test_numbers_of_scip_that_are_worse_or_infinite_change_nothing():
    reports = []
    reporter = Reporter(time.monotonic(), 5.0, 9.0, reports.append)
    for objective, bound, nodes in [(-1e20, 1e20, 0), (6.0, 8.0, 3), (4.0, 8.5, 1)]:
        reporter.note(objective, bound, nodes)
        reporter.report()
    assert [(told.objective, told.bound, told.nodes) for told in reports] == [(5.0, 9.0, 0), (6.0, 8.0, 3)]


def test_what_the_callback_raises_stops_the_search_and_comes_out(street):
    def fail(progress):
        if progress.seconds > 0.3:
            raise PageClosedError

    began = time.monotonic()
    with pytest.raises(PageClosedError):
        solve(street, SolveOptions(formulation="paper", time_limit_s=100.0, without=HARD), fail)
    assert time.monotonic() - began < 90


def test_a_callback_that_fails_at_once_leaves_the_next_solve_alone(corner):
    def fail(_):
        raise PageClosedError

    with pytest.raises(PageClosedError):
        solve(corner, SolveOptions(formulation="paper"), fail)
    assert solve(corner, SolveOptions(formulation="paper")).status == "optimal"


INTERRUPTED_SOLVE = """
import json, sys
sys.path.insert(0, sys.argv[1])
from conftest import line_graph, street_lines
from solver.depths import end_ratios
from solver.families import find_families
from solver.paper.milp import build_model
from solver.options import SolveOptions
from solver.solve import solve
def told(progress):
    if progress.seconds > 0.3:
        print("searching", file=sys.stderr, flush=True)
hard = SolveOptions(formulation="paper", time_limit_s=100.0, without=frozenset({"planarity", "boundary"}))
found = solve(line_graph(*street_lines(60), tolerance=0.004), hard, told)
print(json.dumps([found.status, int(found.connected.sum()), found.bound > found.objective, found.seconds]))
try:
    import os, signal
    os.kill(os.getpid(), signal.SIGINT)
    sys.exit("the handler of Ctrl-C was not given back")
except KeyboardInterrupt:
    pass
"""


@pytest.mark.skipif(os.name == "nt", reason="a real SIGINT can be sent to a child on POSIX alone")
def test_ctrl_c_keeps_the_best_solution_and_prints_nothing():
    environment = {**os.environ, "PYTHONPATH": str(HERE.parents[2])}
    command = [sys.executable, "-c", INTERRUPTED_SOLVE, str(HERE)]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        assert child.stderr.readline() == "searching\n"
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=150)
    assert child.returncode == 0, err
    assert set(err.splitlines()) <= {"searching"}
    (line,) = out.splitlines()  # SCIP's own handler would print "pressed CTRL-C"
    status, crossings, is_open, seconds = json.loads(line)
    assert status == "interrupted"
    assert crossings > 20
    assert is_open
    assert seconds < 90


def test_freeing_a_stopped_search_proves_nothing(alley):
    """SCIP sends events while it frees its tree; the bound of the emptied tree once ended in "optimal"."""
    options = SolveOptions(formulation="paper", without=HARD, node_limit=1)
    ratios, families = end_ratios(alley), find_families(alley, HARD)
    reporter = Reporter(time.monotonic(), 0.0, 1e6, None)
    model = build_model(alley, families, options, ratios).model
    run(model, options, Watch(model, reporter), threading.Event())
    bound = reporter.bound
    model.freeTransform()
    assert reporter.bound == bound > reporter.objective


def test_options_reach_scip(corner, monkeypatch):
    """The seed is the only option that no other test would miss."""
    import solver.backends.scip

    set_ = {}

    def note(model, options, seconds):
        keep(model, options, seconds)
        set_["seed"] = model.getParam("randomization/randomseedshift")

    keep = solver.backends.scip._set_parameters
    monkeypatch.setattr(solver.backends.scip, "_set_parameters", note)
    solve(corner, SolveOptions(formulation="paper", seed=7))
    assert set_ == {"seed": 7}
