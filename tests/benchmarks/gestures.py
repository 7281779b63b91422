"""What gestures about bodies are worth: python tests/benchmarks/gestures.py DATASET [--only 0015] [--gestures 6]

For photos of known depth: the automatic model, and then one gesture of the page of `linecad edit` after the other, by
somebody who sees which body stands wrong, or which of the parts of a body that the page offers. Each is put at one of
its other places where one of those that the page proposes is right (*next place*), else dragged there, by a hand that
is off by HAND (*move*); of the things that are wrong, that is moved by which most is right where the page shows it
before it is taken. With `--undo` it is undone where the model is worse for it, which is one more gesture: what went
wrong by it may also be what is put right next. Prints recall and precision at 5 % of everything in the file before and
after each.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linecad.arrays import Float, Int
from linecad.corrections.edits import Corrections, PlaceAt
from linecad.editing.bodies import ShownBodies
from linecad.editing.session import Session
from linecad.editing.solving import TaskSolver
from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.depth import DepthScore, score_depth
from linecad.evaluation.references import Points, open_case
from linecad.geometry import distances_to
from linecad.lines.segments import find_segments
from linecad.options import Options
from linecad.ties.alternatives import other_places, other_places_of
from linecad.ties.facts import depth_at
from linecad.ties.sides import parts_of

NEAR = 3.0  # px between a known point and the segment that it is of
RIGHT = 0.05  # log depth
SEEN = 0.03  # log factor by which a proposed place may miss the truth to be taken for it
HAND = 0.02  # log factor, standard deviation, by which a body that is dragged misses its place
LEAST_GAIN = 0.002  # of all points, that a gesture puts right
MOST_TRIED = 8  # things that are looked at for one gesture
MOST_TIMES = 2  # that the same thing is moved
WORSE = 0.005  # of all points: right ones less wrong ones that a gesture loses where it is taken back


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--only", default="", help="photos whose name starts so")
    parser.add_argument("--gestures", type=int, default=6)
    parser.add_argument("--undo", action="store_true", help="what makes the model worse is taken back")
    chosen = parser.parse_args()
    for case in find_dataset(chosen.dataset).cases:
        if not case.name.startswith(chosen.only):
            continue
        photo, reference = open_case(case)
        if reference.edges is None:
            continue
        corrections = Corrections(photo.name, photo.width, photo.height)
        session = Session(photo, find_segments(photo.grey), Options(), corrections, lambda _: None)
        told = steps(session, TaskSolver(photo, Options()), reference.edges, chosen.gestures, chosen.undo)
        print(f"{case.name}: {' -> '.join(told)}", flush=True)


def steps(session: Session, solver: TaskSolver, points: Points, most: int, undoes: bool) -> list[str]:
    """What is right before and after each gesture."""
    random, score = np.random.default_rng(0), solved(session, solver, points)
    told, moved = [in_words(score)], list[int]()
    while len(told) <= most:
        gesture = next_gesture(session, points, moved, random)
        if gesture is None:
            break
        fact, before = gesture.fact, score
        session.edit(session.now().version, lambda _, fact=fact: fact)  # type: ignore[misc]
        score = solved(session, solver, points)
        told.append(f"{gesture.word} {in_words(score)}")
        if undoes and is_worse(score, before):
            session.undo(session.now().version)
            moved += [gesture.line] * MOST_TIMES
            score = solved(session, solver, points)
            told.append(f"undo {in_words(score)}")
    return told


def solved(session: Session, solver: TaskSolver, points: Points) -> DepthScore:
    """The score of the model of all that the session holds."""
    session.take(solver.answer(session.task(session.now().version), lambda _: None))
    now = session.now()
    assert now.model is not None
    assert not now.error, now.error
    return score_depth(now.model.scene, points.pixels, points.depth)


def in_words(score: DepthScore) -> str:
    return f"{score.recall_5:.3f} / {score.precision_5:.3f}"


def is_worse(now: DepthScore, before: DepthScore) -> bool:
    """Whether somebody who sees the model takes a gesture back: other things went wrong by it."""
    return _right_less_wrong(now) < _right_less_wrong(before) - WORSE


def _right_less_wrong(score: DepthScore) -> float:
    return 2 * score.recall_5 - score.recall_5 / max(score.precision_5, 1e-9)


@dataclass(frozen=True, eq=False)
class Thing:
    """A body, or a part of one, that stands wrong."""

    body: int
    lines: Int  # of the part; all of the body
    is_part: bool
    off: float  # log factor by which it must move away
    gain: float  # points that this puts right


@dataclass(frozen=True, eq=False)
class Gesture:
    """What is done next, by a key of the page."""

    thing: Thing
    line: int  # the id of the line by which it is placed
    is_proposed: bool  # by *next place*, else by *move*
    move: float  # log factor
    fact: PlaceAt

    @property
    def word(self) -> str:
        """For the table."""
        return f"{'next place' if self.is_proposed else 'move'}{' of a part' * self.thing.is_part}"


def next_gesture(session: Session, points: Points, moved: list[int], random: np.random.Generator) -> Gesture | None:
    """The gesture that puts most known points right; `moved` are the lines by which things were moved before."""
    model = session.now().model
    assert model is not None
    assert model.bodies is not None
    bodies = model.bodies
    least, tried = LEAST_GAIN * len(points.depth), list[tuple[float, Gesture]]()
    for thing in wrong_things(bodies, points):
        line = max(thing.lines.tolist(), key=lambda own: length(bodies, own))
        if len(tried) == MOST_TRIED:
            break
        if moved.count(bodies.ids[line]) >= MOST_TIMES or contradicts(bodies, thing, moved):
            continue
        found = other_places_of(bodies.now, thing.lines) if thing.is_part else other_places(bodies.now, thing.body)
        best = min((place.move for place in found), key=lambda move: abs(move - thing.off), default=np.inf)
        is_proposed = bool(abs(best - thing.off) < SEEN)
        move = best if is_proposed else thing.off + float(random.normal(0, HAND))
        fact = placed(session, bodies, thing, line, move)
        gain = shown_gain(session, bodies, points, thing, fact)
        tried.append((gain, Gesture(thing, bodies.ids[line], is_proposed, move, fact)))
    if not tried:
        return None
    gain, gesture = max(tried, key=lambda each: each[0])
    if gain < least:
        return None
    moved.append(gesture.line)
    return gesture


def shown_gain(session: Session, bodies: ShownBodies, points: Points, thing: Thing, fact: PlaceAt) -> float:
    """How many more points are right where the page shows things before the fact is taken."""
    moves, conflict, refused = session.preview(session.now().version, lambda _: fact)
    if conflict is not None or refused is not None:
        return -np.inf
    which, off = errors(bodies, points)
    body = bodies.body[which]
    if thing.is_part:
        body = np.where(np.isin(which, thing.lines), bodies.count + 1, body)
    after = (off - np.array([moves.get(own, 0.0) for own in body.tolist()]))[which >= 0]
    before = off[which >= 0]
    return worth(after - middle(after)) - worth(before - middle(before))


def contradicts(bodies: ShownBodies, thing: Thing, moved: list[int]) -> bool:
    """Whether a part holds a line by which its body was placed before."""
    longest = max(thing.lines.tolist(), key=lambda own: length(bodies, own))
    own = {bodies.ids[line] for line in thing.lines.tolist()} - {bodies.ids[longest]}
    return bool(own & set(moved))


def wrong_things(bodies: ShownBodies, points: Points) -> list[Thing]:
    """Bodies, and the parts that the page offers of them, that a move would put right, the most points first."""
    evidence = bodies.now.evidence
    which, off = errors(bodies, points)
    found = []
    for body, lines in enumerate(evidence.setting.lines):
        parts = [(part.lines, True) for part in parts_of(evidence, bodies.now.seams, body)]
        for own, is_part in [(lines, False), *parts] if body != evidence.reference else parts:
            move, gain = best_move(off[np.isin(which, own)])
            found.append(Thing(body, own, is_part, move, gain))
    return sorted(found, key=lambda thing: (-thing.gain, thing.is_part, len(thing.lines)))


def best_move(off: Float) -> tuple[float, float]:
    """The move by which most points are right that are off by these log factors, and how many more that are."""
    if not len(off):
        return 0.0, 0.0
    move = middle(off)
    return move, worth(off - move) - worth(off)


def middle(off: Float) -> float:
    """Where most of some log factors are together."""
    ordered = np.sort(off)
    end = np.searchsorted(ordered, ordered + RIGHT, side="right")
    most = int((end - np.arange(len(ordered))).argmax())
    return float(np.median(ordered[most : end[most]]))


def worth(off: Float) -> float:
    """How many points are right that are off by these log factors; half right where that is by more than half."""
    return float(((np.abs(off) < RIGHT).sum() + (np.abs(off) < RIGHT / 2).sum()) / 2)


def errors(bodies: ShownBodies, points: Points) -> tuple[Int, Float]:
    """(M,) the line that each point is of, -1 for none in a body, and by which log factor that must move away."""
    setting = bodies.now.evidence.setting
    near = distances_to(points.pixels, setting.graph.segments.ends)
    which = near.argmin(axis=1)
    which[(near.min(axis=1) >= NEAR) | (setting.bodies.body[which] < 0)] = -1
    off = np.zeros(len(which))
    for point in np.flatnonzero(which >= 0).tolist():
        depth = depth_at(setting, int(which[point]), points.pixels[point])
        body = setting.bodies.body[which[point]]
        off[point] = np.log(points.depth[point] / depth) - bodies.now.log_scale[body]
    # The largest body stays, so all others are wrong against it.
    off[which >= 0] -= middle(off[(which >= 0) & (setting.bodies.body[which] == bodies.now.evidence.reference)])
    return which, off


def placed(session: Session, bodies: ShownBodies, thing: Thing, line: int, move: float) -> PlaceAt:
    """The fact that a body or a part of one, by one of its lines, stands so much farther than it does."""
    setting = bodies.now.evidence.setting
    others = np.setdiff1d(setting.lines[bodies.now.evidence.reference], thing.lines)
    to = max(others.tolist(), key=lambda own: length(bodies, own))
    depths = [depth_at(setting, own, setting.graph.segments.ends[own].mean(axis=0)) * np.exp(
        bodies.now.log_scale[setting.bodies.body[own]]) for own in (line, to)]  # fmt: skip
    one, other = (session.editing.anchor(bodies.ids[own]) for own in (line, to))
    part = tuple(session.editing.anchor(bodies.ids[own]) for own in thing.lines.tolist()) if thing.is_part else ()
    return PlaceAt(one, other, float(np.log(depths[0] / depths[1]) + move), part)


def length(bodies: ShownBodies, line: int) -> float:
    return float(bodies.now.evidence.setting.graph.segments.length[line])


if __name__ == "__main__":
    main()
