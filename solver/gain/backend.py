"""What the search of formulation "gain" asks of a solver: linear relaxations in a row, and one integer program."""

import threading
from dataclasses import dataclass
from typing import Protocol

from linecad.arrays import Float
from linecad.line_graph import Status
from solver.gain.master import Program
from solver.gain.separation import Separation
from solver.options import SolveOptions
from solver.progress import Reporter


@dataclass(frozen=True, eq=False)
class Relaxed:
    """An optimum of the linear relaxation; `value` is with the program's offset."""

    value: float
    x: Float
    reduced: Float  # what the objective changes by per unit of each column, away from its bound


@dataclass(frozen=True, eq=False)
class Integral:
    """How an integer program ended; its proven bound and its nodes are in the reporter."""

    status: Status
    x: Float | None  # the best solution that breaks no row, also none of those that were not written down


class Relaxation(Protocol):
    """The linear relaxation of a program that may have grown since the last call."""

    def solve(self, seconds: float) -> Relaxed | None:
        """The optimum, or None when the time was not enough."""


class Backend(Protocol):
    """A solver of linear and integer programs."""

    @property
    def name(self) -> str:
        """Name and version."""

    def relaxation(self, program: Program) -> Relaxation:
        """A relaxation that keeps its basis from one solve to the next."""

    def solve_integer(
        self,
        program: Program,
        separation: Separation,
        options: SolveOptions,
        start: Float,
        reporter: Reporter,
        stop: threading.Event,
    ) -> Integral:
        """Solve with integer Booleans and all rows that `separation` finds, from a solution `start` that breaks none.

        Stops at the limits of `options`, counted from the reporter's beginning.
        """
