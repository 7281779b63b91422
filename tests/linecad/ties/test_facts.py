"""What a person says of bodies: true words ask for the true scales, impossible ones are told, and they outweigh all."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import Anchor, Cut, Foot, Meet, OnePlane, PlaceAt
from linecad.errors import ContradictionError, CorrectionError
from linecad.geometry import project
from linecad.ties.evidence import cut_bodies, find_evidence
from linecad.ties.facts import CERTAIN, TOLERANCE, depth_at, tie_of, ties_of_facts
from linecad.ties.links import TOLD
from linecad.ties.placing import place_bodies, place_on
from solver.bodies.ties import Ties
from solver.options import SolveOptions

NEAR, FAR = 9.5, 12.0
UPRIGHTS = 12  # of each wall; its courses follow
NO_TIES = Ties(np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0))


@pytest.fixture(scope="module")
def street(build_town, build_row):
    """Two walls of equal heights, the second set back; nothing joins them."""
    return build_town(*build_row(0, at=(NEAR, FAR), level=True), yaw=-0.05)


@pytest.fixture(scope="module")
def corner(build_town, build_wall):
    """Two walls that meet in an edge, whose courses meet there in points."""
    heights = np.linspace(-2.4, 2.1, 7)
    across, away = np.linspace(2.0, 3.6, 6), np.array([6.0, 6.6, 7.4, 8.4, 10.0, 13.0])
    return build_town(build_wall(1, 6.0, across, heights), build_wall(0, 2.0, away, heights)[1:])


def anchor(seen, line):
    (a, b), (c, d) = seen.graph.segments.ends[line].tolist()
    return Anchor(((a, b), (c, d)), int(seen.graph.axis[line]))


def two(seen, kind, first, second, *more):
    return ToldFact(kind((anchor(seen, first), anchor(seen, second)), *more), (first, second))


def place_at(seen, first, second, log_ratio):
    return ToldFact(PlaceAt(anchor(seen, first), anchor(seen, second), log_ratio), (first, second))


def asked(seen, build_setting, told, moved):
    """By how much the tie of a fact is off, where the bodies of true walls have moved by so much each."""
    setting = build_setting(seen, moved)
    (first, second), log_ratio = tie_of(setting, told)
    by = np.append(moved, 0.0)
    return log_ratio - (by[second] - by[first])


moves = st.lists(st.floats(-1, 1), min_size=2, max_size=2).map(np.array)


@given(moves, st.integers(0, UPRIGHTS - 1), st.integers(0, UPRIGHTS - 1))
@settings(max_examples=25, deadline=None)
def test_levels_of_one_height_ask_for_the_true_scales(street, build_setting, moved, first, second):
    heights = street.graph.components[:, 2] * np.exp(street.log_depth)
    one, other = UPRIGHTS + first, 3 * UPRIGHTS + first
    assert heights[one] == pytest.approx(heights[other])
    assert asked(street, build_setting, two(street, OnePlane, one, other, 2), moved) == pytest.approx(0, abs=1e-9)
    turned = asked(street, build_setting, two(street, OnePlane, other, one, 2), moved)
    assert turned == pytest.approx(0, abs=1e-9), "the order of the two is free"
    wrong = 3 * UPRIGHTS + second
    if abs(np.log(abs(heights[wrong] / heights[one]))) > 0.01 and heights[wrong] * heights[one] > 0:
        assert abs(asked(street, build_setting, two(street, OnePlane, one, wrong, 2), moved)) > 0.005


@given(moves, st.integers(0, 6), st.integers(0, 4))
@settings(max_examples=25, deadline=None)
def test_lines_that_meet_ask_for_the_true_scales(corner, build_setting, moved, course, upright):
    """A course of the first wall meets the edge at the corner; so do the second wall's courses, each at its height."""
    first = 6 + course
    second = 13 + 5 + course
    assert corner.part[[first, second]].tolist() == [0, 1]
    assert asked(corner, build_setting, two(corner, Meet, first, second), moved) == pytest.approx(0, abs=1e-6)
    with pytest.raises(CorrectionError, match="one line in the photo"):
        tie_of(build_setting(corner, moved), two(corner, Meet, 1, 13 + upright))


@given(moves, st.integers(0, 2 * UPRIGHTS - 1), st.integers(2 * UPRIGHTS, 4 * UPRIGHTS - 1))
@settings(max_examples=25, deadline=None)
def test_a_place_asks_for_its_ratio(street, build_setting, moved, first, second):
    true = street.log_depth[first] - street.log_depth[second]
    told = place_at(street, first, second, true)
    assert asked(street, build_setting, told, moved) == pytest.approx(0, abs=1e-6)
    farther = place_at(street, first, second, true + 0.3)
    assert asked(street, build_setting, farther, moved) == pytest.approx(0.3, abs=1e-6)


@given(moves, st.floats(-5.0, 4.5), st.booleans())
@settings(max_examples=25, deadline=None)
def test_feet_ask_for_one_ground(street, build_setting, moved, across, of_second):
    """Where the ground is 4.2 below the camera, and the wall of any line meets it somewhere in the photo."""
    setting = build_setting(street, moved)
    part = int(of_second)
    place = np.array([across, FAR if of_second else NEAR, -4.2])
    pixel = tuple(project(place[None], street.sight.matrix, street.sight.rotation)[0].tolist())
    line = 2 * UPRIGHTS * part + UPRIGHTS + 3
    told = ToldFact(Foot(anchor(street, line), pixel), (line,))
    bodies, log_ratio = tie_of(setting, told)
    assert bodies == (part, setting.bodies.count)
    assert -log_ratio == pytest.approx(np.log(4.2) + moved[part], abs=1e-6)


def test_an_upright_stands_on_the_ground_at_its_own_foot(street, build_setting):
    setting, line = build_setting(street), 3
    foot = street.graph.segments.ends[line][np.argmax(street.graph.segments.ends[line][:, 1])]
    beside = tuple((foot + np.array([30.0, 2.0])).tolist())
    (_, ground), log_ratio = tie_of(setting, ToldFact(Foot(anchor(street, line), beside), (line,)))
    assert ground == 2
    assert np.exp(-log_ratio) == pytest.approx(3.0, abs=0.25), "the wall's uprights end about 3 below the camera"


@pytest.mark.parametrize(
    ("fact", "message"),
    [
        (lambda seen: two(seen, OnePlane, 0, 30, 2), "a line along z lies in no plane across z"),
        (lambda seen: two(seen, OnePlane, 12, 36, 7), "lies in no plane across"),
        (lambda seen: two(seen, OnePlane, 12, 47, 2), "opposite sides of the camera"),
        (lambda seen: two(seen, OnePlane, 12, 13, 2), "one body, in which that is missed by"),
        (lambda seen: two(seen, OnePlane, 12, 14, 1), "that holds already"),
        (lambda seen: two(seen, Meet, 12, 36), "one line in the photo"),
        (lambda seen: ToldFact(Foot(anchor(seen, 12), (1900.0, 200.0)), (12,)), "above the camera"),
    ],
)
def test_words_that_ask_for_nothing_are_refused(street, build_setting, fact, message):
    with pytest.raises(CorrectionError, match=message):
        tie_of(build_setting(street), fact(street))
    told = ties_of_facts(build_setting(street), [fact(street)])
    assert len(told.ties) == 0
    assert message.split("|")[0] in told.notes([fact(street)])[0] or "is left out" in told.notes([fact(street)])[0]


def test_a_line_of_no_body_is_told(street, build_setting):
    body = np.where(np.arange(len(street.part)) == 12, -1, street.part)
    with pytest.raises(CorrectionError, match="belongs to no body"):
        tie_of(build_setting(street, body=body), two(street, OnePlane, 12, 36, 2))


def test_depths_are_those_of_the_line(street, build_setting):
    setting = build_setting(street)
    for line in (0, 13, 30, 40):
        for end in range(2):
            true = (
                (street.graph.end_rays[line, end] / street.graph.rays[line])[1] if street.graph.axis[line] != 1 else 1
            )
            found = depth_at(setting, line, street.graph.segments.ends[line, end])
            distance = NEAR if street.part[line] == 0 else FAR
            assert found * street.graph.end_rays[line, end, 1] == pytest.approx(distance, rel=1e-6), true


@pytest.fixture(scope="module")
def evidence(street):
    return find_evidence(street.graph, street.sight, SolveOptions())


def log_ratio(seen, places):
    """How the two walls stand against the truth."""
    error = places.log_depth - seen.log_depth
    return float(np.median(error[seen.part == 0]) - np.median(error[seen.part == 1]))


def test_a_fact_outweighs_what_was_found(street, evidence):
    free = place_bodies(evidence, SolveOptions())
    assert len(free.ties) > 0
    assert abs(log_ratio(street, free)) < 0.005
    there = place_bodies(evidence, SolveOptions(), [place_at(street, 0, 30, 1.0)])
    assert there.log_depth[0] - there.log_depth[30] == pytest.approx(1.0, abs=0.002)
    assert there.ties.weight.max() == CERTAIN
    assert there.sources[-1] == -1
    placed = there.evidence.setting.bodies.body != there.evidence.reference
    assert there.probability[placed].max() > 0.9 * TOLD, "what was said is sure"


def test_places_without_pixels_are_those_with_them(evidence):
    with_photo, without = (place_bodies(each, SolveOptions()) for each in (evidence, evidence.without_photo()))
    assert with_photo.log_depth.tobytes() == without.log_depth.tobytes()


def test_facts_that_contradict_each_other_are_named_and_no_other(street, evidence):
    true = street.log_depth[0] - street.log_depth[30]
    facts = [
        two(street, OnePlane, 12, 36, 2),
        place_at(street, 0, 30, true),
        place_at(street, 0, 30, true + 0.5),
    ]
    with pytest.raises(ContradictionError, match="cannot all hold") as caught:
        place_bodies(evidence, SolveOptions(), facts)
    named = caught.value.facts
    assert len(named) == 2
    assert facts[2].fact in named
    place_bodies(evidence, SolveOptions(), facts[:2])


def test_a_fact_may_contradict_a_crossing_called_real(build_town, build_row):
    seen = build_town(*build_row(1, at=(NEAR, FAR), level=True, end=1.7), yaw=-0.05)
    body = find_evidence(seen.graph, seen.sight, SolveOptions()).setting.bodies.body
    apart = np.diff(body[seen.graph.edges])[:, 0] != 0
    edge = int(np.flatnonzero(apart & seen.graph.informative)[2])
    found = find_evidence(seen.graph, seen.sight, SolveOptions(real=(edge,)))
    assert found.setting.bodies.body.tolist() == body.tolist(), "a word about two bodies changes none"
    told = two(seen, OnePlane, 12, 38, 2)
    with pytest.raises(ContradictionError) as caught:
        place_bodies(found, SolveOptions(real=(edge,)), [told])
    assert caught.value.facts == (told.fact,)
    assert caught.value.crossings == (tuple(seen.graph.edges[edge].tolist()),)


def test_within_the_tolerance_facts_agree(street, build_setting):
    true = street.log_depth[0] - street.log_depth[30]
    for off, fits in ((1.9 * TOLERANCE, True), (2.1 * TOLERANCE, False)):
        facts = [place_at(street, 0, 30, true), place_at(street, 0, 30, true + off)]
        told = ties_of_facts(build_setting(street), facts)
        if fits:
            told.check(facts, NO_TIES, np.zeros((0, 2), int))
        else:
            with pytest.raises(ContradictionError):
                told.check(facts, NO_TIES, np.zeros((0, 2), int))


class TestCuts:
    def test_a_body_is_cut_where_two_walls_join(self, corner):
        options, fact = SolveOptions(), two(corner, Cut, 2, 15)
        whole = find_evidence(corner.graph, corner.sight, options)
        assert whole.setting.bodies.count == 1
        parted = find_evidence(corner.graph, corner.sight, options, [fact])
        body = parted.setting.bodies.body
        assert parted.setting.bodies.count == 2
        assert body[2] != body[15]
        placed = place_on(parted, corner.graph, options, [fact])
        across = body[corner.graph.edges[:, 0]] != body[corner.graph.edges[:, 1]]
        assert across.any()
        assert not placed.solution.connected[across].any()
        assert {source.kind for source in placed.places.sources} <= {"level", "ground"}

    def test_bodies_that_are_two_lose_what_connects_them(self, build_town, build_row):
        seen = build_town(*build_row(1))
        options = SolveOptions()
        evidence = find_evidence(seen.graph, seen.sight, options)
        assert evidence.setting.bodies.count == 2
        fact = two(seen, Cut, 0, 30)
        kinds = [{source.kind for source in place_bodies(evidence, options, facts).sources} for facts in ((), [fact])]
        assert "bundle" in kinds[0]
        assert "bundle" not in kinds[1]

    def test_pieces_alone_tie_bodies_that_are_not_cut(self, build_town, build_row):
        """Where the bodies as wholes show nothing, their pieces do; a cut goes for both."""
        seen = build_town(*build_row(1))
        evidence = replace(find_evidence(seen.graph, seen.sight, SolveOptions()), candidates=())
        kinds = [
            {source.kind for source in place_bodies(evidence, SolveOptions(), facts).sources}
            for facts in ((), [two(seen, Cut, 0, 30)])
        ]
        assert "bundle" in kinds[0]
        assert "bundle" not in kinds[1]

    @pytest.mark.parametrize("seed", range(20))
    def test_the_cut_is_the_lightest_of_all(self, seed, build_links):
        """Against every way to part seven lines."""
        random = np.random.default_rng(seed)
        count = 7
        edges = [(i, j) for i in range(count) for j in range(i + 1, count) if random.random() < 0.6]
        weight = random.uniform(0.5, 3, len(edges))
        graph = build_links(count, edges, weight=weight)
        line = Anchor(((0.0, 0.0), (1.0, 0.0)), 0)
        cut = ToldFact(Cut((line, line)), (0, count - 1))
        body = cut_bodies(one_body(count), graph, np.zeros(count), [cut]).body
        assert body[0] == 0
        assert body[-1] == 1
        ends = np.array(edges)

        def joined(side):
            return weight[side[ends[:, 0]] != side[ends[:, 1]]].sum()

        lightest = min(
            joined(np.array([0, *(number >> bit & 1 for bit in range(count - 2)), 1]))
            for number in range(2 ** (count - 2))
        )
        assert joined(body) == pytest.approx(lightest)


def one_body(count):
    from linecad.ties.bodies import RigidBodies

    return RigidBodies(np.zeros(count, int), 1)


def test_what_is_implied_moves_bodies_and_gives_way_to_what_was_told(street, evidence):
    """A wall by its edges says that these lie in one plane; nobody is told of it where that tells nothing."""
    told = two(street, OnePlane, 12, 36, 1)
    implied = ToldFact(told.fact, told.lines, is_implied=True)
    moved = place_bodies(evidence, SolveOptions(), [implied])
    assert log_ratio(street, moved) == pytest.approx(np.log(FAR / NEAR), abs=0.002), "the walls are in one plane then"
    place = place_at(street, 0, 30, 1.0)
    there = place_bodies(evidence, SolveOptions(), [implied, place])
    assert there.log_depth[0] - there.log_depth[30] == pytest.approx(1.0, abs=0.002)
    idle = ToldFact(two(street, OnePlane, 12, 13, 2).fact, (12, 13), is_implied=True)
    found = ties_of_facts(evidence.setting, [idle])
    assert found.idle
    assert found.notes([idle]) == ()
