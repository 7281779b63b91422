"""What a person knows of bodies, as ties that outweigh all that was found in the photo."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float, Int
from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import Anchor, Cut, Foot, Meet, OnePlane, PlaceAt, Point
from linecad.corrections.words import said
from linecad.directions import UP, across, axis_name, common_frame, components, lies_across, partner, third
from linecad.errors import ContradictionError, CorrectionError
from linecad.geometry import PhotoLength, depths_beside, homogeneous, segment_coordinates, world_rays
from linecad.ties.setting import Setting
from solver.bodies.contradiction import find_contradiction
from solver.bodies.ties import Ties

CERTAIN = 1e6  # weight of what a person said
IMPLIED = 1e5  # of what follows from a wall by its edges
TOLERANCE = 0.01  # log ratio by which what a person said may be missed: eaves of one height are built to a centimetre
ONE_LINE = PhotoLength(20.0, floor=6.0)  # between two segments along one axis that are one line
FLATTEST = 1e-3  # of a unit ray across a plane, or of two lines across each other, below which nothing is told


@dataclass(frozen=True, eq=False)
class FactTies:
    """The ties of facts, and the facts that tie nothing."""

    ties: Ties
    number: Int  # (T,) which of the facts each tie is
    cuts: frozenset[tuple[int, int]]  # pairs of bodies that are not connected, the smaller first
    idle: dict[int, str]  # what is in the way of a fact, by its number

    def notes(self, facts: Sequence[ToldFact]) -> tuple[str, ...]:
        """What a reader should know of facts that say nothing."""
        return tuple(
            f'"{said(facts[number].fact)}" is left out: {why}'
            for number, why in self.idle.items()
            if not facts[number].is_implied
        )

    def check(self, facts: Sequence[ToldFact], sure: Ties, crossings: Int) -> None:
        """Raise ContradictionError unless some places fit all facts, and the crossings (S, 2) of the ties `sure`.

        It names facts and crossings none of which can be left out.
        """
        firm = np.array([not facts[number].is_implied for number in self.number.tolist()], bool)
        own, number = self.ties.subset(firm), self.number[firm]
        both = own.joined(sure)
        around = find_contradiction(both.bodies, both.log_ratio, both.tolerance, int(both.bodies.max(initial=-1)) + 1)
        if not around:
            return
        named = [facts[number] for number in sorted({int(number[tie]) for tie in around if tie < len(number)})]
        pairs = [tuple(crossings[tie - len(number)].tolist()) for tie in sorted(around) if tie >= len(number)]
        raise ContradictionError(
            "what was said cannot all hold",
            (*(line for told in named for line in told.lines), *(line for pair in pairs for line in pair)),
            tuple((first, second) for first, second in pairs),
            tuple(told.fact for told in named),
        )


def ties_of_facts(setting: Setting, facts: Sequence[ToldFact]) -> FactTies:
    """What facts about the nodes of the setting's graph say of its bodies; the ground is one more body."""
    bodies, ratios, number = [], [], []
    idle: dict[int, str] = {}
    cuts = set()
    for own, told in enumerate(facts):
        try:
            if isinstance(told.fact, Cut):
                cuts.add(_bodies_of_two(setting, told.lines))
                continue
            pair, log_ratio = tie_of(setting, told)
        except CorrectionError as error:
            idle[own] = str(error)
            continue
        bodies.append(pair)
        ratios.append(log_ratio)
        number.append(own)
    count = len(bodies)
    ties = Ties(
        np.array(bodies, np.int64).reshape(-1, 2), np.array(ratios), np.full(count, TOLERANCE),
        np.array([IMPLIED if facts[own].is_implied else CERTAIN for own in number]), np.full(count, -1),
    )  # fmt: skip
    return FactTies(ties, np.array(number, np.int64), frozenset(cuts), idle)


def tie_of(setting: Setting, told: ToldFact) -> tuple[tuple[int, int], float]:
    """Two bodies and the log scale of the first less that of the second; CorrectionError where a fact ties nothing."""
    match told.fact:
        case Foot():
            body = _body(setting, told.lines[0])
            return (body, setting.bodies.count), -_log_height(setting, told.lines[0], told.fact.pixel)
        case Meet():
            first, second = told.lines
            apart = _apart_at_crossing(setting, first, second)
        case OnePlane():
            first, second = told.lines
            apart = _apart_across(setting, first, second, told.fact.normal)
        case PlaceAt():
            apart = told.fact.log_ratio - _log_depth_of(setting, told.lines[0], told.fact.line)
            apart += _log_depth_of(setting, told.lines[1], told.fact.to)
        case _:
            raise ValueError(f"{type(told.fact).__name__} is no tie")
    return _bodies_of_two(setting, told.lines, apart), apart


def depth_at(setting: Setting, line: int, pixel: Float) -> float:
    """Camera depth at which a line, where its own body has it, passes nearest to the ray of a pixel (2,)."""
    graph = setting.graph
    ray = components(_rays(setting, pixel[None]), graph.turns)
    point = graph.components[[line]] * np.exp(setting.log_depth[line])
    depth = float(depths_beside(ray, point, graph.axis[[line]])[0])
    if not depth > 0:
        raise CorrectionError("the line would be behind the camera there; choose another place")
    return depth


def _rays(setting: Setting, pixels: Float) -> Float:
    return world_rays(pixels, setting.sight.matrix, setting.sight.rotation[:, :3])


def _body(setting: Setting, line: int) -> int:
    body = int(setting.bodies.body[line])
    if body < 0:
        raise CorrectionError("a line belongs to no body: hardly anything crosses it; choose one of the wall beside it")
    return body


def _bodies_of_two(setting: Setting, lines: tuple[int, ...], apart: float | None = None) -> tuple[int, int]:
    """The bodies of two lines that stand `apart` by this log ratio, if that is known; CorrectionError if it is one."""
    first, second = (_body(setting, line) for line in lines)
    if first != second:
        return (min(first, second), max(first, second)) if apart is None else (first, second)
    if apart is not None and abs(apart) <= TOLERANCE:
        raise CorrectionError("that holds already: both lines are of one body")
    by = "" if apart is None else f", in which that is missed by {abs(np.expm1(apart)):.1%}"
    raise CorrectionError(f"both lines are of one body{by}; cut it between them first")


def _apart_across(setting: Setting, first: int, second: int, normal: int) -> float:
    graph = setting.graph
    known = graph.components.shape[1]
    for line in (first, second):
        if normal >= known or not lies_across(graph.axis[[line]], normal)[0]:
            raise CorrectionError(
                f"a line along {axis_name(int(graph.axis[line]))} lies in no plane across {axis_name(normal)}"
            )
    one, other = (graph.components[line, normal] for line in (first, second))
    if min(abs(one), abs(other)) < FLATTEST:
        raise CorrectionError("a line is seen edge-on there, so its place in that plane is not told; choose another")
    if one * other < 0:
        raise CorrectionError("the two lines are on opposite sides of the camera, so no plane holds both")
    return float(np.log(other / one) + setting.log_depth[second] - setting.log_depth[first])


def _apart_at_crossing(setting: Setting, first: int, second: int) -> float:
    ends, axis = setting.graph.segments.ends, setting.graph.axis
    if axis[first] == axis[second]:
        one, other = ends[first], ends[second]
        longer, shorter = (one, other) if np.ptp(one, axis=0).sum() >= np.ptp(other, axis=0).sum() else (other, one)
        if np.abs(segment_coordinates(shorter, longer)[1]).max() > ONE_LINE.px(setting.sight.width):
            raise CorrectionError(
                f"two lines along {axis_name(int(axis[first]))} meet only where they are one line in the photo; choose "
                "lines that cross, or say that they lie in one plane"
            )
        pixel = np.concatenate([one, other]).mean(axis=0)
    else:
        one, other = (np.cross(*homogeneous(ends[line])) for line in (first, second))
        through = np.cross(one, other)
        if abs(through[2]) <= FLATTEST * np.abs(through).max() / setting.sight.width:
            raise CorrectionError("the two lines are parallel in the photo; choose lines that cross")
        pixel = through[:2] / through[2]
    return float(np.log(depth_at(setting, second, pixel)) - np.log(depth_at(setting, first, pixel)))


def _log_depth_of(setting: Setting, line: int, anchor: Anchor) -> float:
    """Of a line at the middle of the segment that an anchor names."""
    return float(np.log(depth_at(setting, line, np.mean(anchor.ends, axis=0))))


def _log_height(setting: Setting, line: int, pixel: Point) -> float:
    """Log of how far below the camera the wall of a line is at a pixel, at the scale of its body."""
    graph = setting.graph
    place, axis = np.array(pixel), int(graph.axis[line])
    if axis == UP:
        one, other = graph.segments.ends[line]
        along = (other - one) / np.linalg.norm(other - one)
        place = one + along * float((place - one) @ along)
        depth = depth_at(setting, line, place)
    else:
        normal = int(partner(axis))
        offset = graph.components[line, normal] * np.exp(setting.log_depth[line])
        across = components(_rays(setting, place[None]), graph.turns)[0, normal]
        depth = offset / across if abs(across) > FLATTEST else -1.0
        if not depth > 0:
            raise CorrectionError("the wall of that line does not reach that place of the photo")
    height = -depth * float(_rays(setting, place[None])[0, UP])
    if not height > 0:
        raise CorrectionError("that place is above the camera, where no ground is; choose the foot of the wall")
    return float(np.log(height))


def common_planes(setting: Setting, facts: Sequence[ToldFact]) -> tuple[tuple[int, int, int], ...]:
    """Two lines each, and the normal of a plane that facts say they lie in both."""
    axis = setting.graph.axis
    found = []
    for told in facts:
        if not isinstance(told.fact, Meet | OnePlane):
            continue
        first, second = told.lines
        if isinstance(told.fact, OnePlane):
            normal = told.fact.normal
        elif axis[first] == axis[second]:
            normal = int(across(axis[[first]])[0, 0])
        elif common_frame(axis[first], axis[second]) >= 0:
            normal = int(third(axis[first], axis[second]))
        else:  # level lines of two frames, of which none has the other's coordinates
            continue
        found.append((first, second, normal))
    return tuple(found)
