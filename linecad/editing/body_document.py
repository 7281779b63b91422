"""What the page is told of bodies and of facts about them, as JSON."""

from collections.abc import Sequence

import numpy as np

from linecad.arrays import Bool
from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import Cut, Fact, Foot
from linecad.corrections.fact_file import fact_to_json
from linecad.corrections.words import what_is_said
from linecad.directions import UP, letter_of
from linecad.editing.bodies import MOVED, ShownBodies
from linecad.editing.state import Now
from linecad.ties.alternatives import OtherPlace, other_places, other_places_of
from linecad.ties.candidates import Candidate
from linecad.ties.evidence import side_of
from linecad.ties.facts import TOLERANCE
from linecad.ties.sides import parts_of
from linecad.ties.weights import TOLERANCE as TIE_TOLERANCE

GUESS = 0.5  # probability below which a place is a guess
FOLLOWS = TIE_TOLERANCE  # log factor within which a body goes along with another one


def list_bodies(now: Now) -> list[dict[str, object]]:
    """The bodies, the largest share of the photo first; none where the program places none."""
    bodies = None if now.model is None else now.model.bodies
    if bodies is None:
        return []
    places = bodies.now
    setting = places.evidence.setting
    length = setting.graph.segments.length
    share = np.array([length[lines].sum() for lines in setting.lines]) / length.sum()
    found: list[dict[str, object]] = []
    for body in np.argsort(-share, kind="stable").tolist():
        lines = setting.lines[body]
        # Until the scene is built anew a place is as sure as it was: to find that out takes longer than the place.
        probability = float(np.median(bodies.solved.probability[lines]))
        found.append({
            "id": body,
            "lines": [bodies.ids[line] for line in lines.tolist()],
            "share": float(share[body]),
            "reference": body == places.evidence.reference,
            "log_scale": float(places.log_scale[body]),
            "probability": probability,
            "guess": probability < GUESS,
            "by_depth_map": bool(places.by_map[lines].any()),
            "ties": _ties(bodies, body),
        })  # fmt: skip
    return found


def _ties(bodies: ShownBodies, body: int) -> list[dict[str, object]]:
    """What ties a body and what was refused, the heaviest first."""
    ties, count = bodies.now.ties, bodies.count
    missed = ties.misfit(bodies.now.placement.log_scale)
    found: list[dict[str, object]] = []
    for tie in np.flatnonzero((ties.bodies == body).any(axis=1)).tolist():
        first, second = ties.bodies[tie].tolist()
        other, source = second if first == body else first, bodies.now.sources[tie]
        found.append({
            "other": other if other < count else None,
            "kind": _kind(source),
            "words": _words(bodies, source),
            "weight": float(ties.weight[tie]) if isinstance(source, Candidate) or source is None else None,
            "counted": bool(bodies.now.placement.counted[tie]),
            "missed": float(missed[tie]),
        })  # fmt: skip
    return sorted(found, key=lambda tie: (not tie["counted"], -float(str(tie["weight"] or 1e9))))


def _kind(source: Candidate | int | None) -> str:
    if isinstance(source, Candidate):
        return source.kind
    if source is None:
        return "depth map"
    return "crossing" if source >= 0 else "said"


def _words(bodies: ShownBodies, source: Candidate | int | None) -> str:
    if source is None:
        return "the depth map"
    if isinstance(source, Candidate):
        return words_of(source)
    if source >= 0:
        return "a crossing called real"
    told = bodies.told(bodies.facts)
    return what_is_said(told[-1 - source].fact)


def words_of(candidate: Candidate) -> str:
    """What a candidate says, in a few words."""
    match candidate.kind:
        case "bundle":
            pairs = round(float(np.exp(candidate.features["matched"])))
            return f"{pairs} pairs of lines meet" if pairs > 1 else "two lines meet"
        case "plane":
            return "one height" if candidate.normal == UP else f"one plane across {letter_of(candidate.normal)}"
        case "level":
            return f"{round(float(np.exp(candidate.features['matches'])))} equal heights"
        case _:
            return "a foot on the ground"


def places_of(now: Now, body: int) -> list[dict[str, object]]:
    """The other places of a body, the most likely first."""
    bodies = None if now.model is None else now.model.bodies
    if bodies is None or not 0 <= body < bodies.count:
        return []
    return [_place(bodies, place) for place in other_places(bodies.now, body)]


def parts_of_body(now: Now, body: int) -> list[dict[str, object]]:
    """The parts of a body that a person may place by themselves, by the ids of lines, the most doubtful first."""
    bodies = None if now.model is None else now.model.bodies
    if bodies is None or not 0 <= body < bodies.count:
        return []
    return [
        {"lines": [bodies.ids[line] for line in part.lines.tolist()], "probability": part.probability}
        for part in parts_of(bodies.now.evidence, bodies.now.seams, body)
    ]


def places_of_part(now: Now, lines: Sequence[int]) -> list[dict[str, object]]:
    """The other places of a part of a body by the ids of its lines; none of what is no part of one body.

    As in `ShownBodies.preview` the part has the number behind that of the ground.
    """
    bodies = None if now.model is None else now.model.bodies
    own = [] if bodies is None else [bodies.node[line] for line in lines if line in bodies.node]
    if bodies is None or not own:
        return []
    part = side_of(bodies.body, own[0], own)
    if not len(part):
        return []
    found = [(_place(bodies, place), place.moved) for place in other_places_of(bodies.now, part)]
    return [{**shown, "bodies": [*_numbers(moved[: bodies.count]), bodies.count + 1]} for shown, moved in found]


def _numbers(chosen: Bool) -> list[int]:
    return [int(number) for number in np.flatnonzero(chosen)]


def _place(bodies: ShownBodies, place: OtherPlace) -> dict[str, object]:
    moved = _numbers(place.moved[: bodies.count])
    words = list(dict.fromkeys(words_of(reason) for reason in place.reasons))
    return {"move": place.move, "worth": place.worth, "bodies": moved, "words": words}


def facts_of_page(now: Now) -> list[dict[str, object]]:
    """What was said of bodies and was not taken back, with the place of each among the edits."""
    bodies = None if now.model is None else now.model.bodies
    known = {told.fact: told for told in now.lines.corrected.facts}
    number = {edit: own for own, edit in enumerate(now.corrections.edits) if isinstance(edit, Fact)}
    contradicted = () if now.contradiction is None else now.contradiction.facts
    return [
        {
            **{key: value for key, value in fact_to_json(fact).items() if key != "part"},
            "edit": number[fact],
            "words": what_is_said(fact),
            "lines": list(told.lines),
            "bodies": [] if bodies is None else [bodies.body_of(line) for line in told.lines],
            "holds": None if bodies is None else _holds(bodies, told),
            "contradicted": fact in contradicted,
        }
        for fact, told in known.items()
        if fact in number
    ]


def _holds(bodies: ShownBodies, told: ToldFact) -> bool | None:
    """Whether a fact holds where the bodies are shown; None where it says nothing of them."""
    own = [number for number, each in enumerate(bodies.facts) if each.fact == told.fact]
    nodes = bodies.told(bodies.facts)
    if isinstance(told.fact, Cut) or not own or len(nodes) != len(bodies.facts):
        return True if isinstance(told.fact, Cut) else None
    facts = bodies.now.told
    ties = np.flatnonzero(facts.number == own[0])
    if not len(ties):
        return None
    return bool(facts.ties.misfit(bodies.now.placement.log_scale)[ties[0]] <= 2 * TOLERANCE)


def moved_by_last(now: Now) -> list[dict[str, object]]:
    """The bodies that the last fact moved: by which log factor, and whether it asked for that.

    It asks for the moves of the bodies that it names, and of those that go along with them.
    """
    bodies, last = None if now.model is None else now.model.bodies, None
    if now.corrections.edits:
        last = now.corrections.edits[-1]
    if bodies is None or bodies.before is None or not isinstance(last, Fact):
        return []
    moved = bodies.moved_by_last
    lines = next((told.lines for told in bodies.facts if told.fact == last), ())
    own = [moved[body] for line in lines if (body := bodies.body_of(line)) >= 0]
    # Where a foot moves the ground, all that stands on it goes along.
    return [
        {
            "body": body,
            "log_factor": float(by),
            "asked": isinstance(last, Foot) or any(abs(by - other) <= FOLLOWS for other in own),
        }
        for body, by in enumerate(moved.tolist())
        if abs(by) > MOVED
    ]
