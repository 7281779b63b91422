"""Parts that a map has elsewhere as bodies: of one body that was made of two walls, one of which stands wrong."""

from dataclasses import replace

import numpy as np
import pytest

import linecad.ties.parting
from linecad.corrections.corrected import ToldFact
from linecad.corrections.edits import Anchor, Cut, PlaceAt
from linecad.line_graph import Segments
from linecad.ties.candidates import find_candidates
from linecad.ties.depth_parts import WIDEST, MapPart, Part, hear_lines, heard_again, right_by_map
from linecad.ties.depth_ties import hear
from linecad.ties.evidence import Evidence, find_evidence
from linecad.ties.looks import Looks
from linecad.ties.parting import NODES, DecidedParts, decide_parts, part_by_map
from linecad.ties.pieces import find_pieces
from linecad.ties.placing import place_bodies
from linecad.ties.seams import find_seams
from solver.options import SolveOptions

FALSE = 0.3  # log scale by which the second wall stands too far
WIDTH = 0.012  # log depth, of a map that is believed
OPTIONS = SolveOptions()


@pytest.fixture(scope="module")
def exact(avenue_walls, build_depth_map):
    seen, surfaces = avenue_walls
    return build_depth_map(seen.sight, surfaces, scale=5.0)


def heard_as_exact(setting, candidates, depth):
    """Three walls tell nothing of how exact a map is."""
    heard = hear(setting, candidates, depth)
    return replace(heard, width_of_parts=WIDTH)


@pytest.fixture(scope="module")
def evidence(avenue_walls, build_setting, exact):
    """The first two walls as one body, the second of which stands wrong, with an exact map; the third is another."""
    seen, _ = avenue_walls
    moved = build_setting(seen, (0.0, FALSE))
    bodies = build_setting(seen, body=np.array([0, 0, 1])[seen.part]).bodies
    bent = replace(moved, bodies=bodies, sight=replace(seen.sight, depth=exact))
    looks = Looks(bent)
    candidates, seams = find_candidates(bent, looks), find_seams(bent, looks)
    heard = heard_as_exact(bent, candidates, exact)
    none = np.zeros(len(seen.graph.edges), bool)
    pieces = find_pieces(bent, seams, looks)
    return Evidence(bent, tuple(candidates), tuple(seams), pieces, heard, none, none, 0)


def with_parts(evidence, options=OPTIONS):
    """The evidence with the parts that it decides itself."""
    return part_by_map(replace(evidence, parts=decide_parts(evidence, options).parts))


@pytest.fixture(scope="module")
def parted(evidence):
    return with_parts(evidence)


@pytest.fixture
def part(monkeypatch):
    """Parts off what it is told to, whatever the map says."""

    def part_(evidence, *parts, asked=0.2):
        found = [Part(lines, asked, -0.9, 0.0, np.zeros(0, int)) for lines in parts]
        monkeypatch.setattr(linecad.ties.parting, "find_parts", lambda *_: found)
        return with_parts(evidence)

    return part_


def apart(seen, places):
    """By how much the log depths of the second wall are off those of the first."""
    off = places.log_depth - seen.log_depth
    return np.median(off[seen.part == 1]) - np.median(off[seen.part == 0])


def holds(evidence):
    """Every line of a body is of a piece of that body; candidates are between two of each, or one and the ground."""
    body, pieces = evidence.setting.bodies.body, evidence.pieces
    assert (pieces.body[pieces.piece[body >= 0]] == body[body >= 0]).all()
    for found, count in ((evidence.candidates, evidence.setting.bodies.count), (pieces.candidates, pieces.count)):
        for each in found:
            assert 0 <= each.bodies[0] < each.bodies[1] <= count
    assert len(evidence.heard.words.log_scale) == evidence.setting.bodies.count


def test_a_wall_that_stands_wrong_in_its_body_becomes_one_that_the_map_places(avenue_walls, evidence, parted):
    seen, _ = avenue_walls
    assert parted.setting.bodies.count == evidence.setting.bodies.count + 1
    assert parted.heard.parts == {2}
    assert np.flatnonzero(parted.setting.bodies.body == 2).tolist() == np.flatnonzero(seen.part == 1).tolist()
    holds(parted)
    places = place_bodies(parted, OPTIONS)
    assert apart(seen, place_bodies(evidence, OPTIONS)) == pytest.approx(FALSE)
    assert apart(seen, places) == pytest.approx(0.0, abs=5e-3)
    assert places.by_map[seen.part == 1].all()


def test_its_lines_are_as_sure_as_such_a_map_is_right(avenue_walls, parted):
    seen, _ = avenue_walls
    places = place_bodies(parted, OPTIONS)
    expected = right_by_map(parted.heard.width_of_parts)
    np.testing.assert_allclose(places.probability[seen.part == 1], expected)
    assert not np.isclose(places.probability[seen.part == 0], expected).any()


def test_it_stands_where_most_lines_have_the_map(parted):
    """Not where the program has it, to which single ties of small bodies count as much as those of large ones."""
    heard, count = parted.heard, parted.setting.bodies.count
    asked = heard.words.log_scale
    places = place_bodies(replace(parted, heard=heard.placing(2, asked[2] + 0.1)), OPTIONS)
    assert places.log_scale[2] == pytest.approx(asked[2] + 0.1 - places.mapped.of_map)
    assert np.flatnonzero(places.mapped.parts).tolist() == [2]
    assert len(places.mapped.parts) == count


def anchor(graph, line):
    (a, b), (c, d) = graph.segments.ends[line].tolist()
    return Anchor(((a, b), (c, d)), int(graph.axis[line]))


def test_what_a_person_says_of_it_moves_it(evidence, parted):
    first, second = (int(parted.setting.lines[body][0]) for body in (2, 0))
    log_depth = parted.setting.log_depth
    ratio = float(log_depth[first] - log_depth[second]) + 0.7
    graph = evidence.setting.graph
    fact = ToldFact(PlaceAt(anchor(graph, first), anchor(graph, second), ratio), (first, second))
    places = place_bodies(parted, OPTIONS, [fact])
    assert places.log_depth[first] - places.log_depth[second] == pytest.approx(ratio, abs=0.03)
    assert not places.mapped.parts.any()
    by_map = right_by_map(parted.heard.width_of_parts)
    assert not np.isclose(places.probability[parted.setting.lines[2]], by_map).any()


def test_a_crossing_called_real_ties_it_to_its_body_again(evidence, part):
    graph, own = evidence.setting.graph, evidence.setting.lines[0]
    inside = graph.informative & np.isin(graph.edges, own).all(axis=1)
    edge = int(np.flatnonzero(inside & (np.isin(graph.edges, own[:5]).sum(axis=1) == 1))[0])
    i, j = graph.edges[edge]

    def missed(evidence):
        log_depth = place_bodies(evidence, OPTIONS).log_depth
        return abs(log_depth[i] - log_depth[j] - graph.log_ratio[edge])

    assert missed(part(evidence, own[:5], asked=3.0)) > 1
    told = part(replace(evidence, real=np.arange(len(graph.edges)) == edge), own[:5], asked=3.0)
    assert told.heard.parts == {2}
    assert missed(told) <= 1.01 * graph.tolerance[edge]


def test_without_a_map_or_with_a_wide_one_nothing_is_parted(evidence):
    heard = evidence.heard
    for told in ("", replace(heard, width_of_parts=WIDEST)):
        given = replace(evidence, heard=told)
        assert not decide_parts(given, OPTIONS).parts


def test_a_map_that_agrees_parts_nothing(avenue_walls, evidence, exact):
    seen, _ = avenue_walls
    true = replace(evidence.setting, log_depth=seen.log_depth)
    given = replace(evidence, setting=true, heard=heard_as_exact(true, list(evidence.candidates), exact))
    assert not decide_parts(given, OPTIONS).parts


def test_a_whole_body_keeps_its_number_and_nothing_but_the_map_ties_it(evidence, part):
    whole = evidence.setting.lines[1]
    found = part(evidence, whole)
    assert found.setting.bodies.count == evidence.setting.bodies.count
    assert found.heard.parts == {1}
    assert not [each for each in found.candidates if 1 in each.bodies]
    own = set(found.pieces.of(whole).tolist())
    assert not [each for each in found.pieces.candidates if own & set(each.bodies)]
    holds(found)
    places = place_bodies(found, OPTIONS)
    assert places.log_scale[1] == pytest.approx(0.2 - places.mapped.of_map)
    assert np.isfinite(places.probability).all()


def test_parts_of_one_body_are_bodies_each_and_the_rest_keeps_what_ties_it(evidence, part):
    own = evidence.setting.lines[0]
    found = part(evidence, own[:5], own[7:12])
    assert found.heard.parts == {2, 3}
    assert [lines.tolist() for lines in found.setting.lines[2:]] == [own[:5].tolist(), own[7:12].tolist()]
    assert len(found.candidates) == len(evidence.candidates)
    holds(found)
    assert np.isfinite(place_bodies(found, OPTIONS).probability).all()


def test_a_body_that_lost_most_of_its_lines_is_no_reference(evidence, part):
    own, others = evidence.setting.lines
    assert len(others) < len(own)
    assert part(evidence, own[: len(own) // 2 - 1]).reference == 0
    assert part(evidence, own[2:]).reference == 1
    assert part(evidence, own).reference == 1


def mute_about(evidence, body):
    """The evidence with a map that says nothing of a body."""
    words = evidence.heard.words
    own = np.arange(len(words.log_scale)) == body
    told = replace(words, log_scale=np.where(own, np.nan, words.log_scale))
    return replace(evidence, heard=replace(evidence.heard, words=told))


def test_one_body_that_the_map_tells_of_always_stays_to_lay_the_map_on(evidence, part):
    """Without one nothing would tell the unit of the map."""
    own, others = evidence.setting.lines
    every = part(evidence, own[:5], own[5:], others)
    assert every.heard.parts == {0, 2}
    assert every.reference == 1
    mute = part(mute_about(evidence, 1), own[:5], own[5:])
    assert mute.heard.parts == {2}
    assert mute.reference == 0
    for found in (every, mute):
        holds(found)
        assert np.isfinite(place_bodies(found, OPTIONS).log_depth).all()


def test_what_is_decided_depends_on_no_clock(evidence, parted, monkeypatch):
    asked = []

    def place(evidence, options, **fields):
        asked.append(options)
        return place_bodies(evidence, options, **fields)

    monkeypatch.setattr(linecad.ties.parting, "place_bodies", place)
    found = with_parts(evidence, replace(OPTIONS, time_limit_s=1e-6))
    assert found.setting.bodies.body.tolist() == parted.setting.bodies.body.tolist()
    assert asked[0].time_limit_s is None
    assert asked[0].node_limit == NODES


@pytest.fixture(scope="module")
def look(avenue_walls, exact):
    graph, sight = avenue_walls[0].graph, replace(avenue_walls[0].sight, depth=exact)

    def look_(*parts, cut=(), sight=sight, new=(), **called):
        facts = [ToldFact(Cut(tuple(anchor(graph, line) for line in cut)), cut)] if cut else ()
        return find_evidence(graph, sight, SolveOptions(**called), facts, parts=parts, new=new)

    return look_


@pytest.fixture(scope="module")
def plain(look):
    return look()


@pytest.fixture(scope="module")
def half(plain, exact):
    lines = plain.setting.lines[0][:7]
    return MapPart(lines, hear_lines(plain.setting, exact, plain.heard.reading)[lines], 0.2)


class TestWhatIsToldOfParts:
    """Who says something of lines sees parts as bodies; lines of the first of three walls are one here."""

    def test_a_part_is_tied_to_nothing_and_all_else_is_as_without_it(self, look, plain, half):
        evidence = look(half)
        assert evidence.setting.bodies.body.tolist() == plain.setting.bodies.body.tolist()
        [part] = evidence.parts
        assert (part.lines.tolist(), part.asked) == (half.lines.tolist(), half.asked)
        parted = part_by_map(evidence)
        assert parted.setting.lines[3].tolist() == half.lines.tolist()
        assert (parted.heard.parts, parted.parts) == ({3}, ())
        holds(parted)

    def test_a_cut_between_a_part_and_its_body_takes_no_line_from_either(self, look, plain, half):
        own = tuple(plain.setting.lines[0].tolist())
        for cut in (own[0], own[-1]), (own[-1], own[0]):
            evidence = part_by_map(look(half, cut=cut))
            assert evidence.setting.lines[3].tolist() == half.lines.tolist()
            assert evidence.setting.bodies.count == 4
            fact = ToldFact(Cut(tuple(anchor(evidence.setting.graph, line) for line in cut)), cut)
            assert place_bodies(evidence, OPTIONS, [fact]).told.cuts == {(0, 3)}

    def test_a_cut_inside_a_part_makes_two_parts_of_it(self, look, half):
        first, second = half.lines[[0, -1]].tolist()
        evidence = look(half, cut=(first, second))
        assert evidence.setting.bodies.count == 3
        assert [part.asked for part in evidence.parts] == [0.2, 0.2]
        assert np.sort(np.concatenate([part.lines for part in evidence.parts])).tolist() == half.lines.tolist()
        parted = part_by_map(evidence)
        assert parted.heard.parts == {3, 4}
        assert parted.setting.bodies.body[first] != parted.setting.bodies.body[second]
        holds(parted)

    def test_a_cut_of_what_is_left_of_the_body_leaves_the_part(self, look, plain, half):
        rest = plain.setting.lines[0][7:]
        evidence = look(half, cut=(int(rest[0]), int(rest[-1])))
        assert evidence.setting.bodies.count == 4
        parted = part_by_map(evidence)
        assert parted.setting.lines[4].tolist() == half.lines.tolist()
        assert parted.setting.bodies.body[rest[0]] != parted.setting.bodies.body[rest[-1]]
        holds(parted)

    def test_a_crossing_called_fake_between_the_two_fits_nothing_anew(self, look, plain, half):
        graph = plain.setting.graph
        inside = np.isin(graph.edges, half.lines).sum(axis=1)
        edge = int(np.flatnonzero((inside == 1) & np.isin(graph.edges, plain.setting.lines[0]).all(axis=1))[0])
        assert look(half, fake=(edge,)).setting.log_depth.tolist() == plain.setting.log_depth.tolist()
        assert look(fake=(edge,)).setting.log_depth.tolist() != plain.setting.log_depth.tolist()

    def test_new_lines_are_of_the_part_that_they_hang_on(self, look, plain, exact):
        """Ten upright lines of the first wall cross its five level ones and nothing else."""
        asked = hear_lines(plain.setting, exact, plain.heard.reading)
        upright, level = np.split(plain.setting.lines[0], [10])
        other = int(plain.setting.lines[1][0])
        for lines, more in ((np.append(upright[1:6], level), [int(upright[0])]), (upright[1:6], [])):
            [part] = look(MapPart(lines, asked[lines], 0.2), new=(int(upright[0]), other)).parts
            assert part.lines.tolist() == [*more, *lines.tolist()]
            assert part.asked == 0.2

    def test_where_the_map_is_left_out_there_are_no_parts(self, look, plain, half, exact):
        own = plain.setting.lines[0]
        even = replace(plain.setting.sight, depth=replace(exact, values=np.where(exact.valid, 1.0, 0.0)))
        evidence = look(half, cut=(int(own[0]), int(own[-1])), sight=even)
        assert isinstance(evidence.heard, str)
        assert evidence.parts == ()
        assert evidence.setting.bodies.count > 3, "the cut parts the body as it is"
        assert part_by_map(evidence) is evidence


def test_what_the_map_asks_of_a_part_goes_with_the_scale_of_its_body():
    part = MapPart(np.array([1, 2, 4]), np.array([0.1, np.nan, 0.3]), 0.2)
    asked = np.array([np.nan, 0.6, 0.0, 7.0, np.nan])
    found = heard_again(part, np.array([1, 2]), asked)
    assert found.asked == pytest.approx(0.7)
    assert heard_again(part, np.array([2]), asked).asked == pytest.approx(0.7), "as the whole part"
    assert heard_again(part, np.array([2]), np.full(5, np.nan)).asked == 0.2


def test_parts_are_found_again_by_what_their_lines_were(evidence):
    segments = evidence.setting.graph.segments
    parts = (MapPart(np.array([1, 3, 5]), np.array([0.1, 0.3, 0.5]), 0.2), MapPart(np.array([2]), np.zeros(1), 0.0))
    drawn = Segments(np.array([[[300.0, 300.0], [380.0, 290.0]]]), np.array([0]))
    [part], new = DecidedParts(segments, parts).now(segments.subset(np.array([5, 0, 1, 1, 4])).joined(drawn))
    assert new.tolist() == [5]
    assert part.lines.tolist() == [0, 2, 3]
    assert part.heard.tolist() == [0.5, 0.1, 0.1]
    assert part.asked == 0.2
