"""Lines that faces place: of a made house, whose walls are known, with what the photo shows on them."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from linecad.arrays import rows_of
from linecad.depth.depth_map import DepthMap
from linecad.geometry import project
from linecad.line_graph import Segments
from linecad.model import face_lines
from linecad.model.clean.sight import Sight
from linecad.model.face_lines import (
    LEAST_ON_GROUND,
    NO_ROWS,
    UNKNOWN,
    add_lines,
    follow_map,
    lines_told,
    without_repeats,
)
from linecad.model.faces import find_faces
from linecad.model.frames import FramedLines, together
from linecad.model.on_faces.better import LEAST_LIKELY
from linecad.model.regions.mapped import MappedDepths
from linecad.scene import Face, Intersections, Lines, Plane
from linecad.ties.depth_parts import right_by_map

X, Y, Z = range(3)
SIDE, FRONT, GROUND = 2.0, 8.0, -2.0


@pytest.fixture(scope="module")
def planes(house, house_regions):
    return find_faces(house.planes, house.lines, house_regions, house.camera, house.rotation)


@pytest.fixture(scope="module")
def sight(house):
    return Sight(house.camera.matrix, house.rotation, None)


@pytest.fixture(scope="module")
def add(house, planes, sight):
    """What faces add to lines of the house, given edges (axis, ends) in the world that the photo shows."""

    def added(edges, lines=house.lines, said=NO_ROWS):
        ends = np.array([each for _, each in edges], float).reshape(-1, 2, 3)
        details = Segments(
            project(ends, house.camera.matrix, house.rotation), np.array([axis for axis, _ in edges], np.int64)
        )
        framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
        return add_lines(framed, planes, details, house.camera, sight, said)

    return added


def new(found):
    """The new lines by axis and ends, rounded."""
    lines = found.lines.lines
    rows = np.flatnonzero(lines.by_face)
    return [(int(lines.axis[row]), lines.ends[row].round(6).tolist()) for row in rows]


SILL = (X, [[3.0, FRONT, -1.2], [4.5, FRONT, -1.2]])
PIPE = (Z, [[SIDE, 8.4, -1.5], [SIDE, 8.4, 1.2]])
KERB = (Y, [[3.0, 6.0, GROUND], [3.0, 7.5, GROUND]])


@pytest.mark.parametrize("edge", [SILL, PIPE, KERB], ids=["front", "side", "ground"])
def test_an_edge_on_a_face_comes_back_where_it_is(add, edge):
    axis, ends = edge
    found = [each for each in new(add([edge])) if each not in new(add([]))]
    assert [each for each, _ in found] == [axis]
    np.testing.assert_allclose(np.sort(np.array(found[0][1]), axis=0), np.sort(np.array(ends), axis=0), atol=2e-3)


def test_short_edges_on_the_ground_are_stones_and_stains(add, house):
    def along(axis, start, length):
        return axis, [start, [start[0], start[1] + length, start[2]] if axis == Y else [start[0] + length, *start[1:]]]

    def pixels(edge):
        first, second = project(np.array(edge[1]), house.camera.matrix, house.rotation)
        return float(np.linalg.norm(second - first))

    stone, kerb = along(X, [2.5, 6.0, GROUND], 0.25), along(X, [2.5, 6.0, GROUND], 0.4)
    sill = along(X, [3.0, FRONT, -1.2], 0.3)
    least = LEAST_ON_GROUND.px(house.camera.width)
    assert pixels(sill) < least > pixels(stone)
    assert pixels(kerb) > least
    nothing = new(add([]))
    assert new(add([stone])) == nothing
    assert len(new(add([kerb]))) == len(new(add([sill]))) == len(nothing) + 1


def test_the_coordinate_of_the_plane_is_exact(add):
    lines = add([SILL, PIPE, KERB]).lines.lines
    own = lines.by_face
    for axis, normal, offset in ((X, Y, FRONT), (Z, X, SIDE), (Y, Z, GROUND)):
        there = lines.ends[own & (lines.axis == axis)][:, :, normal]
        assert (np.abs(there - offset).max(axis=1) == 0).any()


def test_the_feet_of_walls_are_lines_though_no_crossing_placed_the_ground(house, planes, sight):
    rows = np.flatnonzero(~(house.lines.ends[:, :, Z] == GROUND).all(axis=1))
    lines = replace(rows_of(house.lines, rows), id=np.arange(len(rows)))
    bare = tuple(replace(plane, lines=()) for plane in planes)
    framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
    found = add_lines(framed, bare, Segments.none(), house.camera, sight)
    feet = [np.array(ends) for axis, ends in new(found) if axis != Z and (np.array(ends)[:, Z] == GROUND).all()]
    assert sum((ends[:, Y] == FRONT).all() for ends in feet) == 1
    assert sum((ends[:, X] == SIDE).all() for ends in feet) == 1


def test_where_a_line_runs_there_is_no_second(add, house):
    before = add([])
    known = [(int(axis), ends) for axis, ends in zip(house.lines.axis, house.lines.ends, strict=True)]
    assert new(add(known)) == new(before)
    seen = np.array([ends for _, ends in new(before)])
    again = [(axis, ends) for axis, ends in new(before)]
    assert len(new(add(again))) == len(seen)


def test_what_crosses_two_faces_is_parted(add):
    """A level line of the front that goes on over the side is one of the front up to the corner."""
    long = (X, [[3.0, FRONT, 0.0], [1.2, FRONT, 0.0]])
    found = [each for each in new(add([long])) if each not in new(add([]))]
    assert all(np.array(ends)[:, X].min() > SIDE - 0.05 for _, ends in found)


def test_new_lines_are_like_those_of_their_plane(add, house):
    lines = replace(
        house.lines,
        component=np.full(len(house.lines), 1),
        confidence=np.full(len(house.lines), "weak"),
        probability=np.where(house.lines.ends[:, 0, Y] == house.lines.ends[:, 1, Y], 0.8, 0.7),
    )
    found = add([SILL, KERB], lines)
    after = found.lines.lines
    by_id = dict(zip(after.id.tolist(), range(len(after)), strict=True))
    for plane in found.planes:
        rows = [by_id[line] for line in plane.lines if after.by_face[by_id[line]]]
        old = [by_id[line] for line in plane.lines if not after.by_face[by_id[line]]]
        for row in rows:
            assert after.component[row] == (1 if old else 0)
            assert after.confidence[row] == ("weak" if old else "supported")
            assert after.probability[row] in (set(after.probability[old].tolist()) if old else {UNKNOWN})
    assert sorted(line for plane in found.planes for line in plane.lines if after.by_face[by_id[line]]) == [
        int(line) for line in after.id[after.by_face]
    ]
    assert after.id.tolist() == list(range(len(after)))


def doubtful(house, row, factor, probability):
    """The lines of the house with one at `factor` times its depth along its rays, so that it looks the same."""
    ends = house.lines.ends.copy()
    ends[row] *= factor
    sure = np.full(len(house.lines), 0.9)
    sure[row] = probability
    return replace(house.lines, ends=ends, probability=sure)


def inner_row(house):
    """A level line of the front that is no edge of its face."""
    ends = house.lines.ends
    level = (house.lines.axis == X) & (ends[:, 0, Y] == FRONT) & (np.abs(ends[:, 0, Z]) < 1.2)
    return int(np.flatnonzero(level)[0])


@pytest.mark.parametrize(
    ("factor", "probability", "moves"),
    [
        (1.3, 0.2, True),
        (0.8, 0.2, True),
        (0.8, 0.6, False),
        (1.3, 0.6, False),  # the wall may be one that is not there
        (1.004, 0.2, False),
    ],
)
def test_a_doubtful_line_goes_to_the_face_that_it_lies_on(add, house, factor, probability, moves):
    row = inner_row(house)
    found = add([], doubtful(house, row, factor, probability))
    assert found.kept.tolist() == [each != row or not moves for each in range(len(house.lines))]
    assert [note[:8] for note in found.notes(found.lines.lines) if "doubtful" in note] == ["1 lines "] * moves
    if moves:
        wanted = house.lines.ends[row]
        back = [np.array(ends) for axis, ends in new(found) if axis == X]
        nearest = min(np.abs(np.sort(ends, axis=0) - np.sort(wanted, axis=0)).max() for ends in back)
        assert nearest < 0.05
        assert row not in {line for plane in found.planes for line in plane.lines}


def test_a_doubtful_line_where_two_faces_meet_goes_there(add, house):
    """The foot of the front lies on the front and on the ground, one on each side."""
    ends = house.lines.ends
    foot = (house.lines.axis == X) & (ends[:, 0, Y] == FRONT) & (ends[:, 0, Z] == GROUND)
    row = int(np.flatnonzero(foot)[0])
    found = add([], doubtful(house, row, 1.3, 0.2))
    assert not found.kept[row]
    there = [np.array(ends) for axis, ends in new(found) if axis == X]
    assert any(np.allclose(ends[:, 1:], [FRONT, GROUND], atol=1e-6) for ends in there)


POST = np.array([[[3.2, 6.5, GROUND], [3.2, 6.5, -0.9]]])


def with_line(house, axis, ends, factor):
    """The lines of the house, all of them sure, and one more with ends (1, 2, 3) at `factor` times its distance."""
    shown = project(ends, house.camera.matrix, house.rotation)
    more = Lines([len(house.lines)], [axis], shown, ends * factor, [False], [0], ["weak"])
    return replace(together([house.lines, more]), probability=np.full(len(house.lines) + 1, 0.9))


def test_a_post_stands_on_the_ground_however_sure_its_crossings_were(add, house):
    last = len(house.lines)
    found = add([], with_line(house, Z, POST, 1.4))
    assert found.kept.tolist() == [True] * last + [False]
    uprights = [np.array(ends) for axis, ends in new(found) if axis == Z]
    assert any(np.allclose(np.sort(ends, axis=0), np.sort(POST[0], axis=0), atol=1e-6) for ends in uprights)
    after = found.lines.lines
    post = [row for row in np.flatnonzero(after.by_face) if np.allclose(after.ends[row, :, :2], POST[0, :, :2])]
    assert not {int(after.id[row]) for row in post} & {line for plane in found.planes for line in plane.lines}
    assert add([], with_line(house, Z, POST, 1.0)).kept.all()


def test_the_number_of_a_line_that_went_may_be_given_again_but_is_no_longer_in_its_plane(house, planes, sight):
    lines = with_line(house, Z, POST, 1.4)
    last = len(lines) - 1
    planes = tuple(replace(plane, lines=(*plane.lines, last)) for plane in planes)
    framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
    found = add_lines(framed, planes, Segments.none(), house.camera, sight)
    assert not found.kept[last]
    after = found.lines.lines
    assert last in after.id
    for plane in found.planes:
        assert len(set(plane.lines)) == len(plane.lines)
        rows = np.flatnonzero(np.isin(after.id, plane.lines) & np.asarray(after.by_face))
        assert np.allclose(after.ends[rows][:, :, plane.axis], plane.offset)


def test_the_notes_count_the_lines_that_are_left(add, house):
    found = add([SILL, KERB], with_line(house, Z, POST, 1.4))
    lines = found.lines.lines
    by_face = int(lines.by_face.sum())
    assert [note.split()[0] for note in found.notes(lines)] == [str(by_face - 1), "1"]
    left = rows_of(lines, np.flatnonzero(~lines.by_face)[:5])
    assert found.notes(left) == ()


def test_a_post_that_a_person_said_something_of_stays(add, house):
    said = Intersections(
        lines=[[0, len(house.lines)]], kind=["X"], pixel=[[0, 0]], real=[True], in_tree=[True], weight=[1],
        reason=["annotated"],
    )  # fmt: skip
    assert add([], with_line(house, Z, POST, 1.4), lines_told(said)).kept.all()


@pytest.mark.parametrize(
    ("levels", "probability", "moves"), [(1, 0.3, True), (1, 0.7, False), (2, 0.7, True), (2, 0.85, False)]
)
def test_lines_on_a_street_go_there_unless_they_are_surer_than_it(house, planes, sight, levels, probability, moves):
    """A street has two levels of ground; here a second one out of sight makes it one."""
    far = Face(99, np.array([[60.0, 60, -9], [61, 60, -9], [61, 61, -9]]), kind="ground")
    street = (*planes, Plane(99, Z, -9.0, (), (far,)))[: len(planes) + levels - 1]
    bare = tuple(replace(plane, lines=()) for plane in street)
    lines = with_line(house, Y, np.array([KERB[1]]), 0.8)
    lines = replace(lines, probability=np.r_[np.full(len(lines) - 1, 0.9), probability])
    framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
    found = add_lines(framed, bare, Segments.none(), house.camera, sight)
    assert found.kept[-1] != moves


def moved_behind(house, planes, sight, axis, ends, probability, factor=1.0, told=NO_ROWS):
    """What faces make of the house and one more line with ends (2, 3) at `factor` times its distance."""
    lines = with_line(house, axis, np.array([ends], float), factor)
    lines = replace(lines, probability=np.r_[np.full(len(lines) - 1, 0.9), probability])
    framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
    return add_lines(framed, planes, Segments.none(), house.camera, sight, told)


@pytest.mark.parametrize(("likely", "moves"), [(LEAST_LIKELY, True), (LEAST_LIKELY - 0.01, False)])
def test_a_face_that_is_hardly_likely_hides_nothing(house, planes, sight, likely, moves):
    row = inner_row(house)
    lines = doubtful(house, row, 1.3, 0.45)
    lines = replace(lines, probability=np.where(np.arange(len(lines)) == row, 0.45, likely))
    framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
    found = add_lines(framed, planes, Segments.none(), house.camera, sight)
    assert found.kept[row] != moves


@pytest.mark.parametrize(("factor", "moves"), [(1.3, True), (1.03, False), (0.8, False)])
def test_a_line_below_the_ground_goes_there_however_sure_it_was(house, planes, sight, factor, moves):
    assert moved_behind(house, planes, sight, *KERB, 0.95, factor).kept[-1] != moves


def test_what_a_depth_map_has_behind_a_face_stays_there(house, planes, sight):
    for edge, probability in ((KERB, 0.9), (ACROSS, 0.3)):
        lines = with_line(house, edge[0], np.array([edge[1]], float), 1.3)
        last = np.arange(len(lines)) == len(lines) - 1
        lines = replace(lines, probability=np.where(last, probability, 0.9), by_depth_map=last)
        framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
        assert add_lines(framed, planes, Segments.none(), house.camera, sight).kept[-1]


@pytest.mark.parametrize("turned", [False, True])
def test_a_line_behind_two_faces_goes_to_the_farther_one(house, planes, sight, turned):
    """An upright before the corner of the house, the side on its left, which stands nearer here, and the front."""
    side = next(plane for plane in planes if plane.axis == X and plane.faces)
    near = tuple(replace(face, outline=0.9 * face.outline) for face in side.faces)
    moved = (*(plane for plane in planes if plane is not side), replace(side, offset=0.9 * side.offset, faces=near))
    bare = tuple(replace(plane, lines=()) for plane in moved)
    corner = np.flatnonzero((house.lines.ends == [SIDE, FRONT, GROUND]).all(axis=2).any(axis=1))
    row = corner[house.lines.axis[corner] == Z][0]
    lines = doubtful(house, row, 1.3, 0.45)
    if turned:  # so that its sides change places
        lines = replace(lines, segment=lines.segment[:, ::-1], ends=lines.ends[:, ::-1])
    framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
    found = add_lines(framed, bare, Segments.none(), house.camera, sight)
    there = [np.array(ends) for axis, ends in new(found) if axis == Z]
    assert any(np.allclose(ends[:, :2], [SIDE, FRONT], atol=0.02) and np.ptp(ends[:, Z]) > 3 for ends in there)


def test_what_runs_over_several_faces_of_a_plane_lies_in_it(house, planes, sight):
    """As the edge of a wall and its panes: no face has most of the line."""
    front = next(plane for plane in planes if plane.axis == Y and plane.faces)
    bounds = np.linspace(SIDE, 5.5, 4)
    parts = tuple(
        Face(number, np.array([[a, FRONT, GROUND], [b, FRONT, GROUND], [b, FRONT, 1.6], [a, FRONT, 1.6]]), kind="wall")
        for number, (a, b) in enumerate(pairwise(bounds))
    )
    whole = (*(plane for plane in planes if plane is not front), replace(front, faces=parts))
    found = moved_behind(house, whole, sight, X, [[2.3, FRONT, 0.1], [5.2, FRONT, 0.1]], 0.45, 1.3)
    assert not found.kept[-1]


def test_a_line_on_the_ground_may_be_as_long_as_it_was(house, planes, sight):
    """Its far end is more than three times as far as its middle, and was before."""
    long = [[0.5, 5.0, GROUND], [0.5, 60.0, GROUND]]
    found = moved_behind(house, planes, sight, Y, long, 0.9, 1.3)
    assert not found.kept[-1]


ACROSS = (Y, [[3.6, 9.0, -0.2], [3.6, 12.0, -0.2]])  # seen on the front, between its windows


@pytest.mark.parametrize(("factor", "probability", "stays"), [(1.0, 0.3, False), (1.0, 0.6, True), (0.6, 0.3, True)])
def test_a_doubtful_line_across_what_it_is_seen_on_and_behind_it_is_nowhere(
    house, planes, sight, factor, probability, stays
):
    found = moved_behind(house, planes, sight, *ACROSS, probability, factor)
    assert found.kept.tolist() == [True] * len(house.lines) + [stays]
    notes = [note for note in found.notes(found.lines.lines) if "left out" in note]
    assert [note[:16] for note in notes] == ["1 doubtful lines"] * (not stays)
    assert not any(axis == Y and np.ptp(np.array(ends)[:, Y]) > 2.5 for axis, ends in new(found) if not stays)


def test_a_doubtful_line_on_a_thing_before_a_wall_does_not_lie_behind_that_wall(house, planes, sight):
    bush = np.array([[2.4, FRONT, -1.9], [5.2, FRONT, -1.9], [5.2, FRONT, 1.5], [2.4, FRONT, 1.5]])
    hidden = tuple(
        replace(plane, faces=tuple(replace(face, hidden=(bush,)) for face in plane.faces)) if plane.axis == Y else plane
        for plane in planes
    )
    twig = [[3.0, FRONT, 0.1], [4.5, FRONT, 0.1]]
    assert not moved_behind(house, hidden, sight, X, twig, 0.3, 1.3).kept[-1]
    assert moved_behind(house, hidden, sight, X, twig, 0.6, 1.3).kept[-1]
    assert moved_behind(house, hidden, sight, X, twig, 0.3, 0.7).kept[-1]


def test_what_a_person_put_behind_a_wall_stays_there(house, planes, sight):
    last = np.array([len(house.lines)])
    for axis, ends, probability in ((*ACROSS, 0.3), (Y, KERB[1], 0.9)):
        assert not moved_behind(house, planes, sight, axis, ends, probability, 1.3).kept[-1]
        assert moved_behind(house, planes, sight, axis, ends, probability, 1.3, last).kept[-1]


def test_a_line_that_a_person_said_something_of_stays(add, house):
    row = inner_row(house)
    said = Intersections(
        lines=[[0, row]], kind=["X"], pixel=[[0, 0]], real=[True], in_tree=[True], weight=[1], reason=["annotated"]
    )
    assert add([], doubtful(house, row, 1.3, 0.1), lines_told(said)).kept.all()
    assert not add([], doubtful(house, row, 1.3, 0.1), lines_told(replace(said, reason=["chosen"]))).kept.all()


def test_crossings_of_lines_that_went_go_too_and_the_tree_stays_one(add, house):
    row = inner_row(house)
    found = add([], doubtful(house, row, 1.3, 0.1))
    others = [each for each in range(len(house.lines)) if each != row][:3]
    one, two, three = others
    pairs = np.array([[one, row], [row, two], [one, two], [two, three]])
    count = len(pairs)
    crossings = Intersections(
        lines=pairs, kind=["X"] * count, pixel=np.zeros((count, 2)), real=[True] * count,
        in_tree=[True, True, False, True], weight=np.ones(count),
    )  # fmt: skip
    rest = found.crossings(crossings)
    assert rest.lines.tolist() == [[one, two], [two, three]]
    assert rest.in_tree.tolist() == [True, True]
    triples = np.array([[one, row, 2], [one, two, 2]])
    assert found.renumbered(triples).tolist() == [[one - (one > row), two - (two > row), 2]]


def test_without_details_nothing_changes(house, planes, sight):
    framed = FramedLines(house.lines, np.zeros(len(house.lines), np.int64), ())
    found = add_lines(framed, planes, None, house.camera, sight)
    assert found.lines is framed
    assert found.planes is planes
    assert found.kept.all()
    assert found.notes(found.lines.lines) == ()


def test_a_wire_before_the_sky_is_left_out_unless_a_person_said_something_of_it(house, planes, sight, house_regions):
    wire = np.array([[[-2.0, FRONT, 2.5], [1.0, FRONT, 2.5]]])
    lines = with_line(house, X, wire, 1.0)
    framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
    last = len(lines) - 1
    found = add_lines(framed, planes, Segments.none(), house.camera, sight, shown=house_regions)
    assert np.flatnonzero(~found.kept).tolist() == [last]
    assert found.notes(found.lines.lines)[-1].startswith("1 lines with the sky on both sides")
    assert add_lines(framed, planes, Segments.none(), house.camera, sight, np.array([last]), house_regions).kept.all()
    assert add_lines(framed, planes, Segments.none(), house.camera, sight).kept.all()


def test_no_line_at_all_repeats_another(house, planes, sight):
    framed = FramedLines(rows_of(house.lines, NO_ROWS), np.zeros(0, np.int64), ())
    found, bare = without_repeats(framed, planes, sight)
    assert len(found.lines) == 0
    assert [plane.lines for plane in bare] == [()] * len(planes)


MAP = MappedDepths(
    DepthMap("map.npz", np.ones((4, 4)), np.ones((4, 4), bool), "z"), "z", 0.0, 1.0, np.eye(3), 0.02, 0.012
)


@pytest.fixture
def follow(house, sight, monkeypatch):
    """What becomes of lines that a map has at so many times their distance, by their ids."""

    def followed(found, factors, said=NO_ROWS, width=0.012):
        def asked(lines, *_):
            return np.array([factors.get(number, 1.0) for number in lines.id.tolist()])

        monkeypatch.setattr(face_lines, "factors_by_map", asked)
        return follow_map(found, replace(MAP, width_of_parts=width), house.camera, sight, said)

    return followed


def test_without_a_map_nothing_moves(add, house, sight):
    found = add([SILL])
    assert follow_map(found, None, house.camera, sight, NO_ROWS) is found


def test_a_line_goes_where_the_map_has_it_with_its_crossings_and_planes_left(add, house, follow):
    lines = replace(house.lines, probability=np.full(len(house.lines), 0.6))
    found = add([SILL], lines)
    row = inner_row(house)
    of_face = next(each for each in found.lines.lines.id[found.lines.lines.by_face].tolist() if each not in found.edges)
    after = follow(found, {row: 0.5, of_face: 1.5})
    there = after.lines.lines
    assert len(there) == len(found.lines.lines)
    assert (np.diff(there.id) > 0).all()
    assert np.flatnonzero(~after.kept).tolist() == [row]
    before = dict(zip(found.lines.lines.id.tolist(), found.lines.lines.ends, strict=True))
    assert there.ends[-2:].tolist() == [(0.5 * before[row]).tolist(), (1.5 * before[of_face]).tolist()]
    assert there.by_depth_map.tolist() == [False] * (len(there) - 2) + [True, True]
    assert not there.by_face[-2:].any()
    assert not there.is_boundary[-2:].any()
    assert there.probability[-2:] == pytest.approx(right_by_map(0.012))
    assert not {row, of_face, *there.id[-2:].tolist()} & {line for plane in after.planes for line in plane.lines}
    crossings = Intersections(
        lines=[[0, row], [0, 1]], kind=["X"] * 2, pixel=[[0, 0]] * 2, real=[True] * 2, in_tree=[True] * 2,
        weight=[1] * 2, reason=[""] * 2,
    )  # fmt: skip
    assert after.crossings(crossings).lines.tolist() == [[0, 1]]
    assert [note.split()[0] for note in after.notes(there) if "depth map" in note] == ["2"]


def test_edges_of_faces_and_what_a_person_said_stay_whatever_a_map_has(house, planes, sight, follow):
    rows = np.flatnonzero(~(house.lines.ends[:, :, Z] == GROUND).all(axis=1))  # without the feet of walls
    lines = replace(rows_of(house.lines, rows), id=np.arange(len(rows)), probability=np.full(len(rows), 0.5))
    bare = tuple(replace(plane, lines=()) for plane in planes)
    framed = FramedLines(lines, np.zeros(len(lines), np.int64), ())
    found = add_lines(framed, bare, Segments.none(), house.camera, sight)
    assert len(found.edges) > 1
    after = follow(found, dict.fromkeys([0, *found.edges.tolist()], 0.5), np.array([0]))
    assert after.lines.lines.ends.tolist() == found.lines.lines.ends.tolist()
    assert after.kept.all()


@pytest.mark.parametrize(
    ("known", "width", "moves"), [(0.6, 0.012, True), (0.97, 0.02, False), (0.6, 0.036, False), (0.2, 0.034, True)]
)
def test_who_is_right_is_told_by_how_sure_the_line_is_and_by_the_errors_of_the_map(
    add, house, follow, known, width, moves
):
    row = inner_row(house)
    found = add([], replace(house.lines, probability=np.full(len(house.lines), known)))
    assert found.kept[row]
    assert follow(found, {row: 0.8}, width=width).kept[row] != moves
