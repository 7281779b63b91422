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
from linecad.ties.evidence import part_of_body
from linecad.ties.facts import tie_of
from linecad.ties.placing import BodyPlaces, place_bodies
from linecad.ties.sides import extended, parted_off
from solver.options import SolveOptions

MOVED = 1e-3  # log factor from which a body counts as moved
# Of the search that answers at once; the one behind it, which builds the scene, ends with a proof. With 100 instead, 73
# of 96 facts about South Building end where the proof does, not 66, after up to twice the time (docs/decisions/0114).
NODES = 30


@dataclass(frozen=True, eq=False)
class ShownBodies:
    """The bodies of a scene, and how they have moved since it was built."""

    solved: BodyPlaces  # as in the scene
    now: BodyPlaces  # by all that was said since
    before: Float | None  # (N,) log depths of lines before the last fact; None where none was told yet
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
        return self.moved_from(self.solved)

    def moved_from(self, other: BodyPlaces) -> Float:
        """(B + 1,) the same from where they were at other places, at which some of them were one body."""
        before, own = other.evidence.setting.bodies, self.count
        moved = self.now.log_scale[:own] - extended(other.log_scale[: before.count], before, self.now.evidence)
        ground = self.now.scale_with_ground[own] - other.scale_with_ground[before.count]
        return np.append(moved, ground)

    @cached_property
    def moved_by_last(self) -> Float:
        """(B,) log factors by which the last fact moved bodies."""
        if self.before is None:
            return np.zeros(self.count)
        first = [int(lines[0]) for lines in self.now.evidence.setting.lines]
        return np.asarray((self.now.log_depth - self.before)[first])

    def factor(self, body: int) -> float:
        """By which what belongs to a body is farther than in the scene; 1 for lines of none."""
        return float(np.exp(self.moves[body])) if body >= 0 else 1.0

    def told(self, facts: Sequence[ToldFact]) -> tuple[ToldFact, ...]:
        """Facts by the nodes of the graph; those without lines in it are left out."""
        return tuple(fact for each in facts if (fact := each.by(self.node)))

    def check(self, told: ToldFact) -> None:
        """Raise CorrectionError where a fact, by the ids of its lines, says nothing of these bodies."""
        if any(line not in self.node for line in told.lines):
            raise CorrectionError("a line of it is too short or stands alone; choose one of the wall beside it")
        own = self.told([told])[0]
        if not isinstance(told.fact, Cut):
            part = part_of_body(self.body, own)
            tie_of(parted_off(self.now.evidence, [part]).setting, own)

    def with_facts(self, corrected: CorrectedLines, options: Options) -> "ShownBodies":
        """The bodies where the facts about corrected lines put them; ContradictionError where no places fit."""
        facts = corrected.all_facts
        if facts not in self._tried:
            own, evidence = self.told(facts), self.solved.evidence
            for told in own:
                evidence = parted_off(evidence, [part_of_body(evidence.setting.bodies.body, told)])
            with told_in_the_photo(evidence.setting.graph, corrected):
                near = extended(self.now.placement.log_scale, self.now.evidence.setting.bodies, evidence)
                now = place_bodies(evidence, at_once(options.solve), own, near=near)
            self._tried.clear()
            self._tried[facts] = replace(self, now=now, before=self.now.log_depth, facts=facts)
        return self._tried[facts]

    def preview(self, corrected: CorrectedLines, options: Options) -> dict[int, float]:
        """By which log factor each body would move from where it is shown, and the ground, whose number is `count`.

        Behind that come parts of bodies that would be bodies of their own.
        """
        *bodies, ground = self.with_facts(corrected, options).moved_from(self.now).tolist()
        moved = [*bodies[: self.count], ground, *bodies[self.count :]]
        return {body: by for body, by in enumerate(moved) if abs(by) > MOVED}


def at_once(options: SolveOptions) -> SolveOptions:
    """The options of a search that ends soon: castle photos are proven in a few nodes, others take thousands."""
    return options.within_nodes(NODES)
