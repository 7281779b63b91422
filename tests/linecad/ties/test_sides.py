"""Parts of bodies: the sides of seams, and what ties one that stands by itself, known at once from pieces."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import Anchor, PlaceAt
from linecad.ties.alternatives import other_places, other_places_of
from linecad.ties.bodies import RigidBodies
from linecad.ties.candidates import find_candidates
from linecad.ties.depth_kind import DepthReading
from linecad.ties.depth_samples import WallVotes
from linecad.ties.depth_ties import DepthWitness
from linecad.ties.depth_words import BodyWords
from linecad.ties.evidence import Evidence, find_evidence, side_of
from linecad.ties.looks import Looks
from linecad.ties.pieces import Pieces, find_pieces
from linecad.ties.placing import place_bodies
from linecad.ties.seams import find_seams
from linecad.ties.sides import extended, part_off, parted_off, parts_of
from solver.options import SolveOptions


@pytest.fixture(scope="module")
def row(build_town, build_row):
    """Two walls that three courses join, the first a little smaller."""
    first, second = build_row(3)
    return build_town(first[:-4], second)


@pytest.fixture(scope="module")
def evidence(row, build_setting):
    """All of it one body, as where a seam was not seen."""
    none = np.zeros(len(row.graph.edges), bool)
    setting = build_setting(row, body=np.zeros(len(row.part), int))
    looks = Looks(setting)
    seams = find_seams(setting, looks)
    pieces = find_pieces(setting, seams, looks)
    return Evidence(setting, tuple(find_candidates(setting, looks)), tuple(seams), pieces, "", none, none, 0)


@pytest.fixture(scope="module")
def seams(evidence):
    return place_bodies(evidence, SolveOptions()).seams


@pytest.fixture(scope="module")
def part(evidence, seams):
    return parts_of(evidence, seams, 0)[0]


def told(evidence, lines, to, log_ratio):
    """That some lines stand so far from another one."""
    graph = evidence.setting.graph

    def anchor(line):
        (a, b), (c, d) = graph.segments.ends[line].tolist()
        return Anchor(((a, b), (c, d)), int(graph.axis[line]))

    fact = PlaceAt(anchor(lines[0]), anchor(to), log_ratio, tuple(anchor(line) for line in lines))
    return ToldFact(fact, (lines[0], to), part=tuple(lines))


def test_parts_are_sides_of_seams_and_the_most_of_the_reference_stays(evidence, seams, row):
    found = parts_of(evidence, seams, 0)
    sides = [set(side.tolist()) for seam in evidence.seams for side in (seam.larger, seam.smaller)]
    assert found
    for each in found:
        assert set(each.lines.tolist()) in sides
        assert 2 * len(each.lines) <= len(row.part)
    assert [each.probability for each in found] == sorted(each.probability for each in found)


def test_of_another_body_either_side_is_a_part(evidence, seams):
    size = len(evidence.setting.graph.segments)
    elsewhere = replace(evidence, reference=1)
    found = parts_of(elsewhere, seams, 0)
    assert sum(2 * len(each.lines) > size for each in found) >= 1
    assert len({each.lines.tobytes() for each in found}) == len(found)


def test_a_part_that_is_off_is_a_body_of_its_own_and_the_rest_keeps_its_number(evidence, part):
    off = part_off(evidence, part.lines)
    body = off.setting.bodies.body
    assert off.setting.bodies.count == 2
    assert np.flatnonzero(body == 1).tolist() == part.lines.tolist()
    assert (body[np.setdiff1d(np.arange(len(body)), part.lines)] == 0).all()
    assert off.reference == 0
    for piece, own in enumerate(off.pieces.body):
        assert (body[off.pieces.piece == piece] == own).all()


def test_what_ties_it_is_what_was_found_between_pieces(evidence, part):
    """The courses that go through say that both sides stand as they did; the ground is the last body."""
    off = part_off(evidence, part.lines)
    assert {each.bodies for each in off.candidates} <= {(0, 1), (0, 2), (1, 2)}
    bundles = [each for each in off.candidates if each.kind == "bundle"]
    assert bundles
    assert min(abs(each.log_ratio) for each in bundles) < 0.01
    known = {(each.kind, round(abs(each.log_ratio), 12)) for each in evidence.pieces.candidates}
    assert all((each.kind, round(abs(each.log_ratio), 12)) in known for each in off.candidates)


def test_the_larger_side_of_the_reference_is_the_reference_then(evidence, part):
    rest = np.setdiff1d(np.arange(len(evidence.setting.graph.segments)), part.lines)
    assert part_off(evidence, rest).reference == 1


def test_parts_of_nothing_change_nothing(evidence):
    assert parted_off(evidence, [np.zeros(0, int)]) is evidence


def test_scales_go_along_with_lines(evidence, part):
    off = part_off(evidence, part.lines)
    assert extended(np.array([0.3, -0.1]), evidence.setting.bodies, off).tolist() == [0.3, 0.3, -0.1]
    back = extended(np.array([0.3, 0.5, -0.1]), off.setting.bodies, evidence)
    assert back.tolist() == [0.3, -0.1]


def test_a_fact_moves_a_part_alone(evidence, part):
    off = part_off(evidence, part.lines)
    rest = np.setdiff1d(np.arange(len(off.setting.bodies.body)), part.lines).tolist()
    log_depth = evidence.setting.log_depth
    lines = part.lines.tolist()
    apart = float(log_depth[lines[0]] - log_depth[rest[0]])
    fact = told(evidence, lines, rest[0], apart)
    before = place_bodies(off, SolveOptions(), [fact])
    moved = place_bodies(off, SolveOptions(), [replace(fact, fact=replace(fact.fact, log_ratio=apart + 0.4))])
    by = moved.log_depth - before.log_depth
    assert by[lines] == pytest.approx(0.4, abs=0.03)
    assert by[rest] == pytest.approx(0.0)


def test_a_part_can_be_placed_where_a_map_is_heard(evidence, part):
    words = BodyWords(np.zeros(1), np.full(1, 4.0))
    reading = DepthReading("z", 0.0, 0.0, 0.0, np.zeros(1), WallVotes(np.zeros(1, int), np.zeros(1), np.ones(1)))
    told = replace(evidence, heard=DepthWitness(reading, 0.02, 4.0, 4.0, words, 0.02, None))
    places = place_bodies(part_off(told, part.lines), SolveOptions())
    assert len(places.log_scale) == 2
    assert np.isfinite(places.probability).all()


class TestOfBodies:
    """Which lines of a part count where bodies were found anew."""

    body = np.array([0, 0, 0, 1, 1, -1])

    @pytest.mark.parametrize(
        ("line", "lines", "expected"),
        [
            (0, (0, 1), [0, 1]),
            (1, (1, 1, 0), [0, 1]),
            (0, (0, 3, 5), [0]),
            (0, (0, 1, 2), []),
            (5, (5,), []),
        ],
        ids=["as told", "twice", "of another body too", "all of it", "of no body"],
    )
    def test_those_of_the_body_that_is_placed(self, line, lines, expected):
        assert side_of(self.body, line, lines).tolist() == expected


def test_found_anew_a_part_is_the_same_body(build_town, build_row):
    """The scene that is built behind a fact parts the same lines as the answer at once."""
    seen = build_town(*build_row(3))
    alone = find_evidence(seen.graph, seen.sight, SolveOptions())
    body = alone.setting.bodies.body
    own = np.flatnonzero(body == alone.reference)
    lines = own[: len(own) // 3].tolist()
    fact = told(alone, lines, int(own[-1]), 0.0)
    anew = find_evidence(seen.graph, seen.sight, SolveOptions(), [fact])
    at_once = parted_off(alone, [side_of(body, lines[0], lines)])
    assert anew.setting.bodies.body.tolist() == at_once.setting.bodies.body.tolist()
    assert anew.reference == at_once.reference == alone.reference


def test_a_part_has_the_places_that_it_would_have_as_a_body(build_town, build_row):
    """Two bodies, and the same lines as one body of which they are the pieces."""
    first, second = build_row(1, at=(9.5, 12.0), level=True, end=1.7)
    seen = build_town(first, second[:8] + second[12:], yaw=-0.05)
    places = place_bodies(find_evidence(seen.graph, seen.sight, SolveOptions()), SolveOptions())
    evidence, log_scale = places.evidence, places.placement.log_scale
    setting, body = evidence.setting, 1 - evidence.reference
    assert setting.bodies.count == 2

    def at_depths(candidate):
        one, other = candidate.bodies
        return replace(candidate, log_ratio=candidate.log_ratio - log_scale[one] + log_scale[other])

    whole = RigidBodies(np.where(setting.bodies.body < 0, -1, 0), 1)
    pieces = Pieces(setting.bodies.body, np.zeros(2, int), [at_depths(each) for each in evidence.candidates])
    as_one = replace(evidence, setting=replace(setting, bodies=whole, log_depth=places.log_depth), pieces=pieces,
                     candidates=(), reference=0)  # fmt: skip
    standing = place_bodies(as_one, SolveOptions())
    assert other_places(standing, 0) == [], "the whole is the reference"
    expected = other_places(places, body)
    found = other_places_of(standing, setting.lines[body])
    assert expected
    assert {place.moved[1] and not place.moved[0] for place in found} == {True}, "the part is the last body"
    moves = [place.move for place in found]
    for place in expected:
        if any(reason.kind != "ground" for reason in place.reasons):
            assert min(abs(move - place.move) for move in moves) < 0.02
