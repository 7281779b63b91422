"""The bodies of a solved photo as the page knows them: where the scene has them, and where later facts put them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linecad.arrays import Float, Int
from linecad.corrections.annotations import rows_of
from linecad.corrections.corrected import CorrectedLines, ToldFact
from linecad.corrections.edits import Cut
from linecad.decide.annotations import told_in_the_photo
from linecad.errors import CorrectionError
from linecad.line_graph import LineGraph
from linecad.options import Options
from linecad.ties.facts import tie_of
from linecad.ties.placing import BodyPlaces, place_bodies
from solver.options import SolveOptions

MOVED = 1e-3  # log factor from which a body counts as moved
# Of the search that answers at once; the one behind it, which builds the scene, ends with a proof. With 100 instead, 73
# of 96 facts about South Building end where the proof does, not 66, after up to twice the time (docs/decisions/0115).
NODES = 30


@dataclass(frozen=True, eq=False)
class ShownBodies:
    """The bodies of a scene, and how they have moved since it was built."""

    solved: BodyPlaces  # as in the scene
    now: BodyPlaces  # by all that was said since
    before: Float | None  # (B,) log scales before the last fact; None where none was told yet
    corrected: CorrectedLines  # that the scene was built for
    facts: tuple[ToldFact, ...]  # by the ids of their lines, that `now` knows of
    ids: tuple[int, ...]  # of the graph's nodes
    # What `with_facts` found last, by the facts: who takes what was tried out waits for no second search.
    _tried: dict[tuple[ToldFact, ...], "ShownBodies"] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(cls, places: BodyPlaces, graph: LineGraph, corrected: CorrectedLines) -> "ShownBodies":
        """The bodies of a scene that was just built of a graph of corrected lines."""
        ids = corrected.ids[rows_of(graph.segments, corrected)]
        return cls(places, places, None, corrected, corrected.all_facts, tuple(ids.tolist()))

    @cached_property
    def node(self) -> dict[int, int]:
        """The graph's node by the id of a line."""
        return {number: own for own, number in enumerate(self.ids)}

    @property
    def count(self) -> int:
        """How many bodies there are; this is also the number of the ground."""
        return self.now.evidence.setting.bodies.count

    @property
    def body(self) -> Int:
        """(N,) the body of each node, -1 for none."""
        return self.now.evidence.setting.bodies.body

    def body_of(self, line: int) -> int:
        """The body of a line by its id, -1 for none."""
        return int(self.body[self.node[line]]) if line in self.node else -1

    @cached_property
    def moves(self) -> Float:
        """(B + 1,) log factors by which bodies and, last, the ground are farther than in the scene."""
        own = self.count
        moved = self.now.log_scale[:own] - self.solved.log_scale[:own]
        ground = self.now.placement.log_scale[own] - self.solved.placement.log_scale[own]
        return np.append(moved, ground)

    def factor(self, body: int) -> float:
        """By which what belongs to a body is farther than in the scene; 1 for lines of none."""
        return float(np.exp(self.moves[body])) if body >= 0 else 1.0

    def told(self, facts: Sequence[ToldFact]) -> tuple[ToldFact, ...]:
        """Facts by the nodes of the graph; those without lines in it are left out."""
        return tuple(
            replace(each, lines=tuple(self.node[line] for line in each.lines))
            for each in facts
            if all(line in self.node for line in each.lines)
        )

    def check(self, told: ToldFact) -> None:
        """Raise CorrectionError where a fact, by the ids of its lines, says nothing of these bodies."""
        if any(line not in self.node for line in told.lines):
            raise CorrectionError("a line of it is too short or stands alone; choose one of the wall beside it")
        own = self.told([told])[0]
        if not isinstance(told.fact, Cut):
            tie_of(self.now.evidence.setting, own)

    def with_facts(self, corrected: CorrectedLines, options: Options) -> "ShownBodies":
        """The bodies where the facts about corrected lines put them; ContradictionError where no places fit."""
        facts, evidence = corrected.all_facts, self.solved.evidence
        if facts not in self._tried:
            with told_in_the_photo(evidence.setting.graph, corrected):
                near = self.now.placement.log_scale
                now = place_bodies(evidence, at_once(options.solve), self.told(facts), near=near)
            self._tried.clear()
            self._tried[facts] = replace(self, now=now, before=self.now.log_scale, facts=facts)
        return self._tried[facts]

    def preview(self, corrected: CorrectedLines, options: Options) -> dict[int, float]:
        """By which log factor each body would move from where it is shown, and the ground, whose number is `count`."""
        moved = self.with_facts(corrected, options).moves - self.moves
        return {body: float(by) for body, by in enumerate(moved.tolist()) if abs(by) > MOVED}


def at_once(options: SolveOptions) -> SolveOptions:
    """The options of a search that ends soon: castle photos are proven in a few nodes, others take thousands."""
    return replace(options, node_limit=min(options.node_limit or NODES, NODES))
