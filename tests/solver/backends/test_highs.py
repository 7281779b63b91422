"""HiGHS finds what SCIP finds, in both formulations, and says so when it is not there."""

import subprocess
import sys

import pytest

from linecad.errors import SolverError
from solver.options import FAMILIES, SolveOptions
from solver.solve import solve

pytest.importorskip("highspy", reason="HiGHS is the extra highs")


@pytest.mark.parametrize("off", [(), ("planarity",), pytest.param(("boundary",), marks=pytest.mark.thorough)])
@pytest.mark.parametrize("mu_boundary", [0.4, 10.0])
def test_formulation_gain_has_one_optimum(alley, off, mu_boundary):
    options = {"without": frozenset(off), "mu_boundary": mu_boundary}
    scip, highs = (solve(alley, SolveOptions(backend=backend, **options)) for backend in ("scip", "highs"))
    assert scip.status == highs.status == "optimal"
    assert highs.objective == pytest.approx(scip.objective)
    assert highs.solver.startswith("HiGHS 1.")


@pytest.mark.parametrize("mu_boundary", [1.0, 10.0])
def test_formulation_paper_has_one_optimum(alley, mu_boundary):
    options = {"formulation": "paper", "mu_boundary": mu_boundary, "time_limit_s": 100.0}
    scip, highs = (solve(alley, SolveOptions(backend=backend, **options)) for backend in ("scip", "highs"))
    assert scip.status == highs.status == "optimal"
    assert highs.objective == pytest.approx(scip.objective)
    assert highs.bound == pytest.approx(scip.bound)


@pytest.mark.parametrize("formulation", ["gain", "paper"])
def test_a_limit_ends_the_search_with_a_gap(street, formulation):
    options = SolveOptions(formulation=formulation, backend="highs", time_limit_s=1.5, without=frozenset(FAMILIES[1:]))
    found = solve(street, options)
    assert found.status == "time limit"
    assert found.bound > found.objective > 20
    assert found.seconds < 60


@pytest.mark.parametrize("formulation", ["gain", "paper"])
def test_facts_hold(corner, formulation):
    found = solve(corner, SolveOptions(formulation=formulation, backend="highs", fake=(1,)))
    assert not found.connected[1]


def test_an_unknown_backend_is_named():
    with pytest.raises(SolverError, match="backend 'other' is unknown"):
        SolveOptions(backend="other")


def test_without_highs_the_extra_is_named():
    code = (
        "import sys; sys.modules['highspy'] = None\n"
        "from linecad.errors import SolverError\n"
        "try:\n    import solver.backends.highs\n"
        "except SolverError as error:\n    sys.exit(str(error))"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.stderr.strip() == "HiGHS is not installed; install linecad with the extra highs: linecad[highs]"
