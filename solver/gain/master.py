"""The master problem of formulation "gain": a small linear program over Booleans that grows while it is solved.

| what                                                          | column           | rows                           |
| ------------------------------------------------------------- | ---------------- | ------------------------------ |
| b_e, a crossing is real                                       | e, integer       |                                |
| u_i,a, line i meets a line of the other axis a                | from E, real     | u_i,a >= b_e                   |
| B_i, line i is a boundary                                     | after u, real    | u_i,a + u_i,a' <= 1 + B_i      |
| z_kl, the parallel lines k, l lie in one plane                | later, real      | see `Planes`                   |
| unbalanced cycles                                             |                  | sum of b <= length - 1, lazily |

**Only b need be integer.** With b fixed to 0 and 1 the rest falls apart into single lines and pairs, and the best real
value of each is reached by an integer one:

- u_i,a occurs in rows u >= b and, with a positive coefficient, in u + u' <= 1 + B; B_i costs mu_2 >= 0. So the
  smallest u, the largest b of the side, is best, an integer, and then the smallest B, max(0, u + u' - 1), an integer.
- z_kl = pi_kl^e + pi_kl^f, mu_1 >= 0. The paper's rows (12), (15), (16), (17) are upper bounds of either pi that are
  integers for integer b, r_e and r_f, and pi^e + pi^f <= 1. The best sum is min(1, r_e + r_f), an integer, reached by
  an integer pi.

**Nothing is lost by z.** For any b, also a fractional one, the set of pi with pi^e <= r for r in R_e, pi^f <= r for r
in R_f, pi^e + pi^f <= 1, pi >= 0 (all r are >= 0) has as its sums exactly the z with 0 <= z <= 1, z <= r + r' for all
r in R_e and r' in R_f (Fourier and Motzkin). So the pairs of bounds that a solution breaks can be added as rows over b
and z alone, two Booleans of the paper become one number, and a pair that no solution has broken needs no column: it
counts as planar in the offset of the objective. Two bounds from one shared neighbour sum to 1 or more and bind nothing;
a pair with one shared neighbour is planar in every solution.
"""

from dataclasses import dataclass, field

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.line_graph import LineGraph
from solver.families import Families
from solver.options import SolveOptions

LEAST_VIOLATION = 1e-3  # by which a fractional choice must break a row of a plane
ROUNDING = 1e-6  # by which an integral one must


@dataclass(frozen=True)
class Row:
    """sum of coefficients times columns <= right."""

    columns: tuple[int, ...]
    coefficients: tuple[float, ...]
    right: float


@dataclass(eq=False)
class Program:
    """Maximise offset + objective x with 0 <= x <= upper, rows; the first `integers` columns are Booleans."""

    integers: int
    lower: list[float]
    upper: list[float]
    objective: list[float]
    offset: float
    rows: list[Row] = field(default_factory=list)


class Planes:
    """The parallel pairs of family P, and which of their rows a choice breaks."""

    def __init__(self, families: Families, mu: float) -> None:
        self.mu = mu
        self.pairs = families.pairs.subset(np.diff(families.pairs.start) > 1)
        self.column: dict[int, int] = {}  # of the pairs that have a column
        self.first, self.second, self.along = self.pairs.first, self.pairs.second, self.pairs.along
        self.start = self.pairs.start[:-1]

    def broken(self, x: Float, least: float = LEAST_VIOLATION) -> list[tuple[int, Row]]:
        """Pairs whose z is too large for the b in `x`, most broken first, each with its tightest row (z's place is -1).

        `x` are the values of all columns; a pair without a column has z = 1.
        """
        if len(self.pairs) == 0:
            return []
        one, other = x[self.first], x[self.second]
        unequal, both = 1 - np.abs(one - other), 2 - one - other
        bounds = [np.where(self.along, unequal, both), np.where(self.along, both, unequal)]
        allowed = np.minimum.reduceat(bounds[0], self.start) + np.minimum.reduceat(bounds[1], self.start)
        z = np.ones(len(self.pairs))
        for number, column in self.column.items():
            z[number] = x[column]
        excess = z - allowed
        found = []
        for number in np.flatnonzero(excess > least).tolist():
            begin = int(self.start[number])
            end = int(self.pairs.start[number + 1])
            sides = [begin + int(np.argmin(bound[begin:end])) for bound in bounds]
            found.append((number, self._row(sides, x)))
        found.sort(key=lambda entry: -excess[entry[0]])
        return found

    def _row(self, sides: list[int], x: Float) -> Row:
        """z <= r + r' for the tightest bound of either plane."""
        coefficients: dict[int, float] = {-1: 1.0}
        right = 0.0
        for plane, member in enumerate(sides):
            first, second = int(self.first[member]), int(self.second[member])
            if bool(self.along[member]) == (plane == 0):  # r = 1 - |b - b'|
                larger, smaller = (first, second) if x[first] >= x[second] else (second, first)
                terms, bound = ((larger, 1.0), (smaller, -1.0)), 1.0
            else:  # r = 2 - b - b'
                terms, bound = ((first, 1.0), (second, 1.0)), 2.0
            right += bound
            for column, coefficient in terms:
                coefficients[column] = coefficients.get(column, 0.0) + coefficient
        return Row(tuple(coefficients), tuple(coefficients.values()), right)


def build_master(graph: LineGraph, families: Families, options: SolveOptions, upper: Float, lower: Float) -> Program:
    """The program without any cycle and any z; `lower` and `upper` (E,) are the bounds of b."""
    edges = len(graph.edges)
    program = Program(
        integers=edges,
        lower=lower.tolist(),
        upper=upper.tolist(),
        objective=graph.weight.tolist(),
        offset=options.mu_planarity * len(families.pairs),
    )
    if "boundary" not in options.without:
        program.offset += options.boundary_reward * len(graph.segments)
    for line in families.two_sides:
        sides = []
        for members in line.sides:
            if len(members) == 1:
                sides.append(members[0])  # u would equal the one b
                continue
            u = add_column(program, 0.0)
            program.rows += [Row((edge, u), (1.0, -1.0), 0.0) for edge in members]
            sides.append(u)
        boundary = add_column(program, -options.boundary_reward)
        program.rows.append(Row((*sides, boundary), (1.0, 1.0, -1.0), 1.0))
    return program


def add_column(program: Program, objective: float) -> int:
    """A new real column between 0 and 1."""
    program.lower.append(0.0)
    program.upper.append(1.0)
    program.objective.append(objective)
    return len(program.objective) - 1


def add_plane_column(program: Program, planes: Planes, number: int) -> None:
    """Give a pair its z; from then on it no longer counts as planar in the offset."""
    if number not in planes.column:
        planes.column[number] = add_column(program, planes.mu)
        program.offset -= planes.mu


def add_planes(program: Program, planes: Planes, broken: list[tuple[int, Row]]) -> None:
    """Take rows of `Planes.broken` into the program; a pair that is new there gets its column."""
    for number, _ in broken:
        add_plane_column(program, planes, number)
    program.rows += join_planes(planes, broken)


def join_planes(planes: Planes, broken: list[tuple[int, Row]]) -> list[Row]:
    """Rows of `Planes.broken` over the columns of pairs that all have one."""
    return [
        Row(tuple(planes.column[number] if k == -1 else k for k in row.columns), row.coefficients, row.right)
        for number, row in broken
    ]


def cycle_row(cycle: tuple[int, ...]) -> Row:
    """Not all crossings of an unbalanced cycle are real."""
    return Row(cycle, (1.0,) * len(cycle), len(cycle) - 1.0)


def fill(program: Program, connected: Bool, planes: Planes, families: Families, planar: Int) -> Float:
    """The values of all columns for a choice of crossings: what a solver is given as its start."""
    x = np.zeros(len(program.objective))
    x[: program.integers] = connected
    column = program.integers
    for line in families.two_sides:
        met = []
        for members in line.sides:
            met.append(bool(connected[list(members)].any()))
            if len(members) > 1:
                x[column] = met[-1]
                column += 1
        x[column] = all(met)
        column += 1
    known = {(first, second) for first, second, _ in planar.tolist()}
    lines = [(first, second) for first, second in planes.pairs.lines.tolist()]
    for number, place in planes.column.items():
        x[place] = lines[number] in known
    return x
