"""A depth map as a witness of where bodies stand: one more body, to which the map ties each of them and the ground.

The log scale of the map is that of its unit. How far its word goes is estimated from the photo itself: the width of the
Cauchy error of its walls, by how well the ratios that it asks for agree with those that other evidence asks for, each
of which is right with the probability that the table gives it.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.depth.depth_map import DepthMap
from linecad.line_graph import LineGraph
from linecad.scene import DepthMapReport
from linecad.ties.candidates import Candidate
from linecad.ties.depth_corners import jumps_at_corners, width_by_corners
from linecad.ties.depth_ground import ground_of_map
from linecad.ties.depth_kind import DepthReading, read_depth
from linecad.ties.depth_samples import sample_walls, weighted_median
from linecad.ties.depth_words import WITHIN, BodyWords, words_of, worth_within
from linecad.ties.setting import Setting
from linecad.ties.weights import FULL_SIZE, log_odds_of
from solver.bodies.ties import Placement, Ties
from solver.robust import agreeing_with

WIDTHS = np.geomspace(0.004, 0.5, 60)  # log scale, half widths at half maximum of a body's error
LEAST_WIDTH = 0.02  # what few bodies tell of it is not believed below: single walls are off by several widths
WITHIN_BODIES = 0.5  # of the spread inside bodies, that the error of bodies has at least
USUAL_WIDTH, SPREAD = 0.02, 0.5  # before anything is seen: the middle of published networks; log, standard deviation
MOST_WIDTH = 0.06  # of a map of this photo
ELSEWHERE = 0.4  # log ratio, mean by which wrong candidates are off
CONTRADICTED = 0.045  # share of the crossings' weight that contradicts a fit, at which the map counts as it stands
LEAST_WORTH = 2.3  # of the word of one wall, below which the map places only what nothing else ties
LEAST_WORD = 0.2  # log-odds of a body whose walls each say something else
POWER, FEWEST, MOST = 2.0, 0.25, 1.0  # of that share; times that the map counts, which is never more than it is worth


@dataclass(frozen=True, eq=False)
class DepthWitness:
    """What a depth map says of bodies."""

    reading: DepthReading
    width: float  # log scale: of the Cauchy error of a wall
    worth: float  # log-odds of its word for a large body of one wall, and for the ground
    weight: float  # the same against ties of crossings that contradict each other more or less
    words: BodyWords  # of each body
    width_of_parts: float  # log depth, where parts of bodies are looked at: the larger of what bodies and corners tell
    ground: float | None  # log height of the camera above it in the map's unit; None where the map shows none
    parts: frozenset[int] = frozenset()  # bodies that nothing but the map ties, by a decision about parts of bodies

    @property
    def trust(self) -> float:
        """What its word counts against ties of crossings."""
        return self.weight / self.worth

    def with_part_of(self, body: int) -> "DepthWitness":
        """The same with one more body, which comes last: a part of one, of which the map says what it says of that."""
        asked, words = self.reading.log_scale, self.words
        more = BodyWords(np.append(words.log_scale, words.log_scale[body]), np.append(words.worth, words.worth[body]))
        return replace(self, reading=replace(self.reading, log_scale=np.append(asked, asked[body])), words=more)

    def placing(self, body: int, asked: float) -> "DepthWitness":
        """The same where nothing but the map ties a body, which it asks to grow by that log."""
        own = np.arange(len(self.words.log_scale)) == body
        words = BodyWords(np.where(own, asked, self.words.log_scale), np.where(own, self.worth, self.words.worth))
        reading = replace(self.reading, log_scale=np.where(own, asked, self.reading.log_scale))
        return replace(self, reading=reading, words=words, parts=self.parts | {body})


def hear(setting: Setting, candidates: list[Candidate], depth: DepthMap | None) -> DepthWitness | str:
    """What the map says, or one clause that says why it is left out; where none was given, that is nothing.

    Where crossings contradict each other, ties are worth less against the map. Raises DepthMapError where nothing tells
    what it measures.
    """
    if depth is None:
        return ""
    reading = read_depth(depth, sample_walls(setting, depth))
    if isinstance(reading, str):
        return reading
    if not np.isfinite(reading.log_scale[setting.bodies.size.argmax()]):
        return "it says nothing of the largest body, relative to which the others stand"
    by_bodies = estimate_width(reading.log_scale, candidates)
    width = max(LEAST_WIDTH, WITHIN_BODIES * reading.spread, by_bodies)
    if width > MOST_WIDTH:
        return f"it is {np.expm1(width):.0%} off the bodies of this photo, too much to place them"
    worth = worth_within(2 / np.pi * np.arctan(WITHIN), width)
    contradicted = _contradicted(setting.graph, setting.log_depth)
    trust = float(np.clip((contradicted / CONTRADICTED) ** POWER, FEWEST, MOST))
    words = words_of(reading.votes, width, setting.bodies.count)
    ground = ground_of_map(depth, reading.kind, reading.shift, setting.sight)
    jumps = jumps_at_corners(depth, reading.kind, reading.shift, setting.graph.segments, setting.sight)
    # A network may be off alike on both sides of a corner, and bodies of one wall each tell hardly anything.
    return DepthWitness(reading, width, worth, worth * trust, words, max(by_bodies, width_by_corners(jumps)), ground)


def _contradicted(graph: LineGraph, log_depth: Float) -> float:
    """Share of the weight of all crossings that disagree with log depths (N,)."""
    told = graph.informative
    agree = agreeing_with(graph, log_depth)
    return 1 - float(graph.weight[agree & told].sum()) / max(float(graph.weight[told].sum()), 1e-9)


def estimate_width(log_scale: Float, candidates: list[Candidate]) -> float:
    """The most likely width of the map's errors.

    Each candidate is right, and off the map's ratio by the errors of two bodies, or wrong, and off by anything. The
    ground is left out: feet are found far less well than the map could be.
    """
    known = [candidate for candidate in candidates if candidate.kind != "ground"]
    first, second = np.array([candidate.bodies for candidate in known], np.int64).reshape(-1, 2).T
    off = np.abs(log_scale[first] - log_scale[second] - np.array([candidate.log_ratio for candidate in known]))
    log_odds = np.array([log_odds_of(candidate) for candidate in known])[np.isfinite(off)]
    off = off[np.isfinite(off)]
    right, both = 1 / (1 + np.exp(-log_odds)), 2 * WIDTHS[:, None]
    density = right * both / (np.pi * (both**2 + off**2)) + (1 - right) * np.exp(-off / ELSEWHERE) / ELSEWHERE / 2
    likely = np.log(density).sum(axis=1) - 0.5 * (np.log(WIDTHS / USUAL_WIDTH) / SPREAD) ** 2
    return float(WIDTHS[int(likely.argmax())])


def ties_to_map(witness: DepthWitness, size: Int) -> Ties:
    """Ties to the map, which is body B + 1, of the bodies of `size` (B,) lines that it tells of, and of the ground, B.

    None where the map's word is worth less than LEAST_WORTH.
    """
    words, count = witness.words, len(size)
    told = np.flatnonzero(np.isfinite(words.log_scale))
    log_scale = words.log_scale[told]
    worth = np.maximum(words.worth[told], LEAST_WORD) * np.minimum(1.0, size[told] / FULL_SIZE)
    if witness.ground is not None:
        told, log_scale, worth = (
            np.append(told, count),
            np.append(log_scale, witness.ground),
            np.append(worth, witness.worth),
        )
    ties = Ties(
        bodies=np.column_stack([told, np.full(len(told), count + 1)]),
        log_ratio=log_scale,
        tolerance=np.full(len(told), WITHIN * witness.width),
        weight=witness.trust * worth,
        group=np.full(len(told), -1),
        yields=np.ones(len(told), bool),
    )
    return ties.subset(np.full(len(ties), witness.weight >= LEAST_WORTH))


@dataclass(frozen=True, eq=False)
class MapPlaces:
    """Where bodies stand once the map has placed those that nothing else ties."""

    log_scale: Float  # (B,)
    ground: float  # log scale of the ground, which goes with the bodies that stand on it
    of_map: float  # log of the map's depth over that of the bodies
    by_map: Bool  # (B,) bodies that the map alone ties to the reference
    misfit: Float  # (B,) log scale by which bodies are off the map; NaN where it does not tell
    width: float  # as of the witness
    worth: float
    parts: Bool | tuple[()] = ()  # (B,) of by_map, parts of bodies that stand where most lines have the map; or none


def follow_map(witness: DepthWitness, ties: Ties, placement: Placement, reference: int, size: Int) -> MapPlaces:
    """The places of B bodies of `size` lines: as they were placed, and by the map what no counted tie leads to.

    The map must tell of the reference.
    """
    asked, count = witness.words.log_scale, len(placement.log_scale)
    log_scale = placement.log_scale[: len(size)].copy()
    ground = float(placement.log_scale[len(size)])
    parts = ties.parts(placement.counted, count)
    part = parts[: len(size)]
    firm = ties.parts(placement.counted & ~np.asarray(ties.yields), count)
    told = np.isfinite(asked)
    # A part that a person ties to something goes with that.
    alone = np.isin(np.arange(len(size)), list(witness.parts)) & (np.bincount(firm)[firm[: len(size)]] == 1)
    main = told & (part == part[reference]) & ~alone
    of_map = weighted_median((asked - log_scale)[main], size[main].astype(np.float64))
    for number in np.unique(part[told & ~alone]).tolist():
        own = part == number
        if number != part[reference]:
            own_told = own & told & ~alone
            off = weighted_median((asked - log_scale)[own_told], size[own_told].astype(np.float64))
            log_scale[own] += off - of_map
            ground += (off - of_map) * (parts[len(size)] == number)
    # The program ties these to the map where most ties have it, which need not be where most lines do.
    log_scale[alone] = asked[alone] - of_map
    of_told = firm[: len(size)][told]
    if (placement.counted & (ties.bodies == [len(size), len(size) + 1]).all(axis=1)).any():
        of_told = np.append(of_told, firm[len(size)])  # what stands on a ground that the map ties
    firm = firm[: len(size)]
    by_map = (firm != firm[reference]) & np.isin(firm, of_told)
    return MapPlaces(log_scale, ground, of_map, by_map, asked - log_scale - of_map, witness.width, witness.worth, alone)


def report_of(depth: DepthMap, heard: DepthWitness | str, mapped: MapPlaces | None) -> DepthMapReport:
    """What became of a map, its scale that of the depths of the solution."""
    if isinstance(heard, str) or mapped is None:
        return DepthMapReport(depth.name, str(heard))
    reading = heard.reading
    return DepthMapReport(depth.name, "", reading.kind, reading.shift, float(np.exp(mapped.of_map)), heard.width)
