"""What became of the search and of a depth map, as the scene file tells it."""

from dataclasses import dataclass

from linecad.line_graph import Solution
from linecad.scene.words import DEPTH_KINDS, DepthKind


@dataclass(frozen=True)
class SolveReport:
    """How the answer was found, as it stands in the scene file."""

    solver: str
    formulation: str
    status: str
    objective: float
    bound: float
    gap: float
    cuts: int = 0  # rows added while solving
    nodes: int = 0  # branch-and-bound nodes

    @classmethod
    def of(cls, solution: Solution) -> "SolveReport":
        """What a solution tells."""
        names = ("solver", "formulation", "status", "objective", "bound", "gap", "cuts", "nodes")
        return cls(*(getattr(solution, name) for name in names))


@dataclass(frozen=True)
class DepthMapReport:
    """What became of a depth map that was given with the photo."""

    file: str  # name, without its folder
    left_out: str  # why: one clause, without a full stop; "" where it was used, and then the rest is known
    kind: DepthKind | None = None
    shift: float | None = None  # added to the map's numbers, of kind affine-inverse
    scale: float | None = None  # depth by the map (1 over its number, shifted, if inverse) over depth in the scene
    width: float | None = None  # of the Cauchy error of its bodies, log depth

    def __post_init__(self) -> None:
        told = [self.kind, self.shift, self.scale, self.width]
        if told.count(None) != (len(told) if self.left_out else 0):
            raise ValueError("DepthMapReport must say either why the map was left out, or all about it")
        if self.kind is not None and self.kind not in DEPTH_KINDS:
            raise ValueError(f"DepthMapReport.kind is {self.kind!r}, expected one of {', '.join(DEPTH_KINDS)}")

    @property
    def text(self) -> str:
        """One line for people: the file, and its kind and width or why it was left out."""
        if self.width is None:
            return f"depth map {self.file} left out: {self.left_out}"
        return f"depth map {self.file}: {self.kind}, width of its errors {100 * self.width:.2g} %"
