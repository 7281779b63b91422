"""Every option of a reconstruction and every default, once: Python, command line, batch, page and evaluation use these.

What most users need are arguments of the command line; the rest, the switches of research, are given as KEY=VALUE. The
table SWITCHES lists them, `linecad options` prints it.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal, get_args

from linecad.errors import OptionError
from linecad.line_graph import Formulation, Program
from linecad.scene import DEPTH_KINDS, DepthKind
from solver.options import (
    BACKENDS,
    DEFAULT_MU_BOUNDARY,
    FAMILIES,
    LARGEST_SEED,
    SolveOptions,
)

Weights = Literal["odds", "junctions", "ones"]
Joins = Literal["stable", "biconnected", "all"]
WEIGHTS: tuple[Weights, ...] = get_args(Weights)
JOINS: tuple[Joins, ...] = get_args(Joins)
PROGRAMS: tuple[Program, ...] = get_args(Program)

MIN_COMPONENT = 4  # lines; smaller groups say too little about space to be worth showing
LARGEST_EXTENSION = 500.0  # px at 3840 px width; the number of crossings grows with its square
LARGEST_VIEW = 999_999
SMALLEST_FACTOR = 1e-12  # units a step
LONGEST_VALUE = 40  # characters of a value that a message repeats


@dataclass(frozen=True)
class Reach:
    """How far evidence is carried along a segment, in px at 3840 px width."""

    extension: float  # by which segments are extended to find crossings
    largest_gap: float  # between fragments of one segment
    least_length: float  # of a line
    least_tolerance: float  # of a crossing, relative depth: errors of frame and lens add up along the way


SHORT_REACH = Reach(30.0, 31.0, 25.0, 0.002)  # as in the paper
# 60, 100 and 15 px on photos 3072 px wide: what measured best on real photos (docs/decisions/0023).
LONG_REACH = Reach(75.0, 125.0, 18.75, 0.0035)
MIDDLE_REACH = Reach(37.5, 62.5, 18.75, 0.002)  # for photos whose crossings contradict each other


_USUAL = SolveOptions()


@dataclass(frozen=True)
class Options:
    """What a user can choose about a reconstruction. None: what suits the formulation, and for the reach the photo."""

    # px at 3840 px width by which segments are extended to find crossings; None: that of the reach.
    extension: float | None = None
    reach: Reach | None = None  # None: long with gain, middle where a photo is inconsistent; short with the paper's
    weights: Weights | None = None  # of crossings; None: odds with gain, junctions with the paper's
    collinear: bool | None = None  # segments on one image line may be one line in space; None: not with the paper's
    largest_component: bool = False  # only the largest connected component, as in the paper
    # What a join of two bodies of lines must show (linecad.decide); None: stable with gain, all with the paper's.
    joins: Joins | None = None
    # Place rigid bodies as wholes; None: unless something is asked for that only programs over crossings know.
    over_bodies: bool | None = None
    faint: bool = False  # a second look for faint segments: more depths, and more wrong ones
    # Draw the edges of faces and what lies on them also where no crossing placed it; where bodies are placed.
    face_lines: bool = True
    roofs: bool = True  # look for roofs between the eaves of walls and the sky
    # How a depth map that is given with the photo is read (linecad.depth); they mean nothing without one.
    depth_kind: DepthKind | None = None  # None: as the file tells, else the one that makes walls flat
    depth_array: str | None = None  # which array of an .npz; None: found by its name
    depth_view: int | None = None  # which photo, from 0, where a file holds the depth of several; None: it holds one
    depth_factor: float | None = None  # of 16-bit pictures, units a step; None: 1/256
    depth_undistorted: bool = False  # the map is of the photo as linecad straightened it, not of the file
    solve: SolveOptions = field(default_factory=SolveOptions)

    @property
    def formulation(self) -> Formulation:
        """The program over all crossings that is in use where bodies are not placed."""
        return self.solve.formulation

    @property
    def uses_bodies(self) -> bool:
        """Whether the scene program places rigid bodies (linecad.ties).

        It does unless `over_bodies` says so, or --fast, the paper's program, joins, weights, a reach or a field of the
        solver's options is chosen that it does not know.
        """
        if self.over_bodies is not None:
            return self.over_bodies
        chosen = replace(
            self.solve, time_limit_s=None, node_limit=None, seed=0, memory_limit_mb=_USUAL.memory_limit_mb,
            real=(), fake=(),
        )  # fmt: skip
        return chosen == _USUAL and (self.joins, self.weights, self.reach, self.collinear) == (None,) * 4

    @property
    def uses_face_lines(self) -> bool:
        """Whether faces place lines: only where bodies are placed, since else groups have scales of their own."""
        return self.uses_bodies and self.face_lines

    @property
    def depth_keys(self) -> tuple[str, ...]:
        """The options about a depth map that were chosen, by key."""
        own = (each for each in fields(self) if each.name.startswith("depth_"))
        return tuple(each.name.replace("_", "-") for each in own if getattr(self, each.name) != each.default)

    @property
    def program(self) -> Program:
        """The program in use, as the scene names it."""
        return "bodies" if self.uses_bodies else self.formulation

    @property
    def is_paper(self) -> bool:
        """Whether what is left open is as in the paper."""
        return self.formulation == "paper"

    @property
    def weights_used(self) -> Weights:
        """`weights` in use."""
        return self.weights if self.weights is not None else "junctions" if self.is_paper else "odds"

    @property
    def collinear_used(self) -> bool:
        """`collinear` in use."""
        return not self.is_paper if self.collinear is None else self.collinear

    @property
    def joins_used(self) -> Joins:
        """`joins` in use."""
        if self.joins is not None:
            return self.joins
        return "all" if self.is_paper or self.uses_bodies else "stable"

    @property
    def needs_inconsistency(self) -> bool:
        """Whether it matters how often the crossings of the photo contradict each other."""
        return self.joins_used == "stable" or (self.reach is None and not self.is_paper and not self.uses_bodies)

    def reach_for(self, is_inconsistent: bool) -> Reach:
        """`reach` and `extension` in use, for a photo that is inconsistent or not."""
        reach = self.reach
        if reach is None:
            shorter = is_inconsistent and not self.uses_bodies
            reach = SHORT_REACH if self.is_paper else MIDDLE_REACH if shorter else LONG_REACH
        return reach if self.extension is None else replace(reach, extension=self.extension)


@dataclass(frozen=True)
class Switch:
    """One option that is given as KEY=VALUE."""

    key: str  # lower case, with hyphens
    usual: str  # the default, for people
    accepted: str  # what a value may be, for people
    phrase: str  # what it does, for people
    read: Callable[[str], Any]  # ValueError for what is not accepted
    of_solver: bool = False  # a field of SolveOptions, else of Options

    @property
    def name(self) -> str:
        """The field that it sets."""
        return self.key.replace("-", "_")


def _word(words: tuple[str, ...]) -> Callable[[str], str]:
    def read(text: str) -> str:
        if text.lower() not in words:
            raise ValueError
        return text.lower()

    return read


def _switched(text: str) -> bool:
    return {"on": True, "off": False}[_word(("on", "off"))(text)]


def _number(least: float, most: float) -> Callable[[str], float]:
    def read(text: str) -> float:
        value = float(text)
        if not (math.isfinite(value) and least <= value <= most):
            raise ValueError
        return value

    return read


def _whole(most: int, least: int = 0) -> Callable[[str], int]:
    def read(text: str) -> int:
        if not (text.isascii() and text.isdecimal() and len(text) <= len(str(most)) and least <= int(text) <= most):
            raise ValueError
        return int(text)

    return read


def _name(text: str) -> str:
    if not text or not text.isprintable():
        raise ValueError
    return text


def _families(text: str) -> frozenset[str]:
    names = frozenset(name for name in text.lower().split(",") if name)
    if not names <= set(FAMILIES):
        raise ValueError
    return names


def _listed(words: Sequence[str]) -> str:
    *others, last = words
    return f"{', '.join(others)} or {last}"


_ANY = 1e6
_NUMBER = "a number from 0 to 1000000"
SWITCHES: tuple[Switch, ...] = (
    Switch("formulation", "bodies", _listed(PROGRAMS), "the program: over rigid bodies, over all crossings (gain, "
           "also where an option below is given that only it knows), or as the paper prints it", _word(PROGRAMS)),
    Switch("backend", "scip", _listed(BACKENDS), "the solver (highs: pip install 'linecad[highs]')",
           _word(BACKENDS), of_solver=True),
    Switch("without", "none", f"one or more of {', '.join(FAMILIES)}", "leave out families of constraints",
           _families, of_solver=True),
    Switch("mu-planarity", "0.5", _NUMBER, "the paper's mu_1, reward of a planar pair of lines",
           _number(0, _ANY), of_solver=True),
    Switch("mu-boundary", "{gain:g}, with paper {paper:g}".format(**DEFAULT_MU_BOUNDARY), _NUMBER,
           "the paper's mu_2, reward of a line off the boundaries", _number(0, _ANY), of_solver=True),
    Switch("gap", "0", _NUMBER, "relative gap at which the solver may stop", _number(0, _ANY), of_solver=True),
    Switch("seed", "0", f"a whole number from 0 to {LARGEST_SEED}", "seed of the solver", _whole(LARGEST_SEED),
           of_solver=True),
    Switch("node-limit", "none", "a whole number from 1 to 1000000000", "branch-and-bound nodes after which the solver "
           "stops, whatever the clock says", _whole(10**9, 1), of_solver=True),
    Switch("weights", "odds, with paper junctions", _listed(WEIGHTS),
           "weights of crossings: log-odds, a table by kind of junction, or all equal", _word(WEIGHTS)),
    Switch("extension", f"{LONG_REACH.extension:g}, with paper {SHORT_REACH.extension:g}",
           f"px from 1 to {LARGEST_EXTENSION:.0f}, at a photo width of 3840 px",
           f"how far segments are extended to find crossings ({MIDDLE_REACH.extension:g} where crossings contradict "
           "each other)", _number(1, LARGEST_EXTENSION)),
    Switch("collinear", "on, with paper off", "on or off", "segments on one image line may be one line in space",
           _switched),
    Switch("joins", "stable, with paper all", _listed(JOINS),
           "what joins two bodies of lines: crossings that keep their place when lines are left out, two lines or "
           "more, or any crossing", _word(JOINS)),
    Switch("faint", "off", "on or off", "look a second time, for segments that the grain hides: more depths, and more "
           "wrong ones", _switched),
    Switch("face-lines", "on", "on or off", "also draw edges of faces and lines on them that no crossing placed (not "
           "with gain and paper)", _switched),
    Switch("roofs", "on", "on or off", "look for sloped roofs between walls and the sky; a scene file with one has "
           "version 2", _switched),
    Switch("largest-component", "off", "on or off", "only the largest connected group of lines", _switched),
    Switch("depth-kind", "as the file tells", _listed(DEPTH_KINDS), "what the depth map measures: along the optical "
           "axis, along the ray of a pixel, 1 / z but for its scale, or but for scale and shift; where the file does "
           "not tell, the one that makes walls flat", _word(DEPTH_KINDS)),
    Switch("depth-array", "found by its name", "a name", "which array of an .npz holds the depth", _name),
    Switch("depth-view", "none", f"a whole number from 0 to {LARGEST_VIEW}",
           "which photo, where the depth map holds those of several", _whole(LARGEST_VIEW)),
    Switch("depth-factor", "1/256", f"a number above 0, at most {_ANY:.0f}",
           "of a depth map in a 16-bit picture, units a step", _number(SMALLEST_FACTOR, _ANY)),
    Switch("depth-undistorted", "off", "on or off", "the depth map is of the photo as linecad straightened it",
           _switched),
)  # fmt: skip
_BY_KEY = {switch.key: switch for switch in SWITCHES}


def is_switch(text: str) -> bool:
    """Whether a text KEY=VALUE sets an option of the reconstruction."""
    return text.partition("=")[0] in _BY_KEY


def read_options(texts: Iterable[str], options: Options | None = None) -> Options:
    """`options`, else the defaults, changed by texts KEY=VALUE; where a key stands twice, the last one counts.

    Raises OptionError for a text of another form, an unknown key or a value that is not accepted.
    """
    options = Options() if options is None else options
    of_solver: dict[str, Any] = {}
    others: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or key not in _BY_KEY:
            found = f"{text[:LONGEST_VALUE]!a} is no option"
            raise OptionError(f"{found}; write KEY=VALUE, `linecad options` lists them all")
        switch = _BY_KEY[key]
        try:
            (of_solver if switch.of_solver else others)[switch.name] = switch.read(value)
        except ValueError:
            raise OptionError(f"option {key} is {value[:LONGEST_VALUE]!a}, expected {switch.accepted}") from None
    program = others.pop("formulation", None)
    if program is not None:
        others["over_bodies"] = program == "bodies"
        of_solver["formulation"] = "gain" if program == "bodies" else program
    return replace(options, **others, solve=replace(options.solve, **of_solver))
