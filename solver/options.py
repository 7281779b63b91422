"""What a solver is asked, and how it tells how far it is: the options with their defaults, the progress on the way."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

from linecad.errors import SolverError
from linecad.line_graph import Formulation

Family = Literal["cycles", "planarity", "boundary"]
FAMILIES: tuple[Family, ...] = get_args(Family)
# The paper's mu_2 keeps so many lines off the boundary that one wall remains of most buildings (docs/decisions/0019).
DEFAULT_MU_BOUNDARY: dict[Formulation, float] = {"gain": 1.0, "paper": 10.0}
# s; gain starts near its end, the paper's program does not.
DEFAULT_TIME_LIMIT_S: dict[Formulation, float] = {"gain": 10.0, "paper": 60.0}
BackendName = Literal["scip", "highs"]
BACKENDS: tuple[BackendName, ...] = get_args(BackendName)
FORMULATIONS: tuple[Formulation, ...] = get_args(Formulation)

LARGEST_SEED = 2**31 - 1  # SCIP takes its seed as a C int
LARGEST_REWARD = 1e6  # of one pair or line; beyond it the crossings drown in the rounding of the objective
LONGEST_TIME_S = 1e9  # thirty years; SCIP refuses numbers that it takes for infinite


@dataclass(frozen=True)
class SolveOptions:
    """How a line graph is solved; SolverError, in one line, for a value that cannot be used."""

    formulation: Formulation = "gain"
    without: frozenset[Family] = frozenset()  # families of constraints switched off, with their term of the objective
    mu_planarity: float = 0.5  # the paper's mu_1, reward of a pair of parallel lines in one Manhattan plane
    # The paper's mu_2, reward of a line that is not at the meeting of two planes; if None, that of the formulation.
    mu_boundary: float | None = None
    time_limit_s: float | None = None  # s, for the whole of `solve`; if None, that of the formulation
    gap: float = 0.0  # (bound - objective) / |objective| at which the solver may stop
    seed: int = 0
    depth_range: float = 100.0  # largest over smallest depth of the near ends; bounds the constant L of "paper" alone
    memory_limit_mb: float = 4096.0  # MB, of the solver itself
    node_limit: int | None = None  # branch-and-bound nodes
    backend: BackendName = "scip"  # the solver; HiGHS is the extra `highs`
    fast: bool = False  # a robust fit instead of a search: tenths of a second, nothing proven
    real: tuple[int, ...] = ()  # edges annotated as real: every answer has them
    fake: tuple[int, ...] = ()  # edges annotated as fake: no answer has them

    def __post_init__(self) -> None:
        if self.formulation not in FORMULATIONS:
            raise SolverError(f"formulation {self.formulation!r} is unknown; use one of {', '.join(FORMULATIONS)}")
        if self.backend not in BACKENDS:
            raise SolverError(f"backend {self.backend!r} is unknown; use one of {', '.join(BACKENDS)}")
        if self.fast and self.formulation != "gain":
            raise SolverError(f"a fast answer has no formulation {self.formulation!r}; leave one of the two out")
        unknown = sorted(set(self.without) - set(FAMILIES))
        if unknown:
            raise SolverError(f"family {unknown[0]!r} is unknown; use {', '.join(FAMILIES)}")
        object.__setattr__(self, "without", frozenset(self.without))
        for name, reward in (("mu_planarity", self.mu_planarity), ("mu_boundary", self.boundary_reward)):
            self._require(name, 0 <= reward <= LARGEST_REWARD, f"a number from 0 to {LARGEST_REWARD:.0f}")
        self._require(
            "time_limit_s",
            0 < self.seconds <= LONGEST_TIME_S,
            f"more than zero seconds, at most {LONGEST_TIME_S:g}",
        )
        self._require("gap", self.gap >= 0, "zero or more")
        self._require("seed", 0 <= self.seed <= LARGEST_SEED, f"an integer from 0 to {LARGEST_SEED}")
        self._require("depth_range", self.depth_range > 1, "more than 1")
        self._require("memory_limit_mb", self.memory_limit_mb > 0, "more than zero megabytes")
        self._require("node_limit", self.node_limit is None or self.node_limit > 0, "more than zero nodes, or none")

    @property
    def boundary_reward(self) -> float:
        """The paper's mu_2 in use."""
        return DEFAULT_MU_BOUNDARY[self.formulation] if self.mu_boundary is None else self.mu_boundary

    def within_nodes(self, most: int) -> "SolveOptions":
        """The same for a search that ends after so many nodes at most."""
        return replace(self, node_limit=min(self.node_limit or most, most))

    @property
    def seconds(self) -> float:
        """The time limit in use, s."""
        return DEFAULT_TIME_LIMIT_S[self.formulation] if self.time_limit_s is None else self.time_limit_s

    def _require(self, name: str, holds: bool, expected: str) -> None:
        value = getattr(self, name)
        if not holds or (value is not None and not math.isfinite(value)):
            raise SolverError(f"{name} is {value}, expected {expected}")


@dataclass(frozen=True)
class Progress:
    """How far a solve has come; the objective never falls and the bound never rises from one report to the next."""

    seconds: float  # s since the start of `solve`
    objective: float  # of the best solution so far
    bound: float  # no solution is better than this
    gap: float  # (bound - objective) / max(|objective|, 1e-9)
    nodes: int  # branch-and-bound nodes so far


OnProgress = Callable[[Progress], None] | None


def relative_gap(objective: float, bound: float) -> float:
    """The gap as `Solution` and `Progress` state it; a bound below the objective by rounding counts as zero."""
    return max(0.0, bound - objective) / max(abs(objective), 1e-9)
