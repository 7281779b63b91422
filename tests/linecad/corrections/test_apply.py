"""Corrections applied to found lines: what each edit does, and that lines are found again by their geometry."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.corrections.apply import FIRST_IDS, Correcting, correct, correcting_of, said_of
from linecad.corrections.edits import (
    Anchor,
    Corrections,
    Delete,
    Draw,
    Join,
    KnownLength,
    LabelCrossing,
    SetAxis,
    SetFrame,
    Split,
)
from linecad.errors import CorrectionError
from linecad.geometry import angles_to, vanishing_points
from linecad.graph.build import build_line_graph
from linecad.line_graph import Segments


def plain(ends):
    (a, b), (c, d) = np.asarray(ends, float).tolist()
    return (a, b), (c, d)


def anchor(made, line):
    return Anchor(plain(made.pixels[line]), int(made.axis[line]))


@pytest.fixture
def applied(made):
    """A function that applies edits to the exact lines of the made scene."""

    def apply(*edits, segments=None):
        corrections = Corrections("made.jpg", made.camera.width, made.camera.height, edits)
        return correct(made.segments if segments is None else segments, made.camera, made.frame, corrections)

    return apply


def off_axis(made, ends, axis):
    """Sine of the angle of a segment to the vanishing point of an axis."""
    return angles_to(np.asarray(ends)[None], vanishing_points(made.camera.matrix, made.frame.rotation))[axis, 0]


def test_without_edits_the_lines_are_those_found(made, applied):
    lines = applied()
    assert (lines.segments.ends == made.pixels).all()
    assert lines.ids.tolist() == list(range(len(made.axis)))
    assert set(lines.origin) == {"found"}


def test_another_axis_turns_the_line_about_its_middle(made, applied):
    lines = applied(SetAxis(anchor(made, 3), 1 if made.axis[3] != 1 else 0))
    axis = lines.segments.axis[3]
    assert axis != made.axis[3]
    assert off_axis(made, lines.segments.ends[3], axis) < 1e-9
    assert lines.segments.ends[3].mean(axis=0) == pytest.approx(made.pixels[3].mean(axis=0))
    assert np.delete(lines.segments.ends, 3, axis=0) == pytest.approx(np.delete(made.pixels, 3, axis=0))


def test_a_deleted_line_is_gone_and_the_others_keep_their_ids(made, applied):
    lines = applied(Delete(anchor(made, 3)))
    assert lines.ids.tolist() == [number for number in range(len(made.axis)) if number != 3]


def test_a_split_line_becomes_two_that_meet_at_the_point(made, applied):
    middle = made.pixels[0].mean(axis=0)
    lines = applied(Split(anchor(made, 0), tuple((middle + np.array([0.4, 0.3])).tolist())))
    count = len(made.axis)
    assert lines.ids[-2:].tolist() == [count, count + 1]
    assert lines.origin[-2:] == ("split", "split")
    first, second = lines.segments.ends[-2:]
    assert first[1] == pytest.approx(second[0])
    assert (first[0], second[1]) == (pytest.approx(made.pixels[0, 0]), pytest.approx(made.pixels[0, 1]))
    assert lines.parted == ((count, count + 1),)


def test_joining_what_was_split_gives_the_line_back(made, applied):
    point = tuple(made.pixels[0].mean(axis=0).tolist())
    axis = int(made.axis[0])
    pieces = Anchor(plain([made.pixels[0, 0], point]), axis), Anchor(plain([point, made.pixels[0, 1]]), axis)
    lines = applied(Split(anchor(made, 0), point), Join(pieces))
    assert lines.origin[-1] == "joined"
    assert lines.segments.ends[-1] == pytest.approx(made.pixels[0], abs=1e-6)
    assert len(lines.ids) == len(made.axis)


def test_a_drawn_line_passes_through_its_vanishing_point(made, applied):
    lines = applied(Draw(Anchor(((700.0, 300.0), (900.0, 320.0)), 0)))
    assert off_axis(made, lines.segments.ends[-1], 0) < 1e-9
    assert lines.segments.ends[-1] == pytest.approx(np.array([[700, 300], [900, 320]]), abs=20)


def test_a_length_is_kept_by_the_line_and_can_be_taken_back(made, applied):
    known = KnownLength(anchor(made, 4), 3.5)
    assert applied(known).lengths == {4: 3.5}
    assert applied(known, replace(known, metres=None)).lengths == {}


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda _: Delete(Anchor(((5.0, 5.0), (90.0, 9.0)), 0)), "no line runs from .5, 5. to .90, 9. along x"),
        (lambda made: Split(anchor(made, 0), plain(made.pixels[0])[0]), "piece would be shorter"),
        (lambda _: Draw(Anchor(((5.0, 5.0), (6.0, 5.0)), 0)), "too short; at least 10 px"),
        (lambda made: Join((anchor(made, 0), anchor(made, 0))), "cannot be joined to itself"),
        (lambda made: Draw(anchor(made, 0)), "there already"),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_line_and_changes_nothing(made, applied, edit, message):
    lines, _ = correcting_of(made.segments, made.camera, made.frame, Corrections("made.jpg", 1600, 1200))
    before = lines.result()
    with pytest.raises(CorrectionError, match=message) as refused:
        lines.apply(edit(made))
    assert "\n" not in str(refused.value)
    assert lines.result().is_like(before)
    assert message.split(";")[0].split(" .")[0].split()[0] in " ".join(applied(edit(made)).notes)


def test_lines_of_two_axes_or_side_by_side_are_not_joined(made, applied):
    other = int(np.flatnonzero(made.axis != made.axis[0])[0])
    assert "give them one axis first" in applied(Join((anchor(made, 0), anchor(made, other)))).notes[0]
    beside = next(k for k in range(1, len(made.axis)) if made.axis[k] == made.axis[0])
    assert "px beside each other" in applied(Join((anchor(made, 0), anchor(made, beside)))).notes[0]


def test_many_corrections_that_name_nothing_make_few_notes(applied):
    lost = [Delete(Anchor(((5.0, 5.0 + k), (90.0, 9.0 + k)), 0)) for k in range(30)]
    notes = applied(*lost).notes
    assert len(notes) == 6
    assert notes[-1].startswith("25 more corrections")


class TestFoundAgain:
    """Another detection: ends off by pixels, lines cut short, in pieces, in another order."""

    def detected(self, made, seed):
        rng = np.random.default_rng(seed)
        order = rng.permutation(len(made.axis))
        along = made.pixels[:, 1] - made.pixels[:, 0]
        share = rng.uniform(0, 0.2, (len(along), 2))
        ends = np.stack([made.pixels[:, 0] + share[:, :1] * along, made.pixels[:, 1] - share[:, 1:] * along], axis=1)
        return Segments((ends + rng.normal(0, 0.3, ends.shape))[order], made.axis[order]), order

    @given(seed=st.integers(0, 2**32 - 1), line=st.integers(0, 10**6))
    def test_a_line_is_found_again_in_another_detection(self, made, seed, line):
        line %= len(made.axis)
        segments, order = self.detected(made, seed)
        lines = Correcting(segments, made.camera, made.frame)
        assert order[lines.find(anchor(made, line))] == line

    def test_of_two_pieces_the_longer_one_is_taken(self, made):
        line = made.pixels[0]
        cut = line[0] + 0.3 * (line[1] - line[0])
        pieces = Segments(np.array([[line[0], cut], [cut + 1, line[1]]]), [made.axis[0]] * 2)
        assert Correcting(pieces, made.camera, made.frame).find(anchor(made, 0)) == 1

    def test_labels_of_crossings_come_back(self, made, applied):
        graph = build_line_graph(made.segments, made.camera, made.frame)
        edges = np.flatnonzero(made.truly_real(graph))[:20].tolist()
        edits = [
            LabelCrossing(
                (anchor(made, graph.edges[e, 0]), anchor(made, graph.edges[e, 1])),
                tuple(graph.crossing[e].tolist()),
                "real" if e % 2 else "fake",
            )
            for e in edges
        ]
        segments, order = self.detected(made, 7)
        lines = applied(*edits, segments=segments)
        assert lines.notes == ()
        back = {tuple(sorted(order[list(pair)].tolist())): label for pair, (_, label) in lines.labels.items()}
        assert back == {tuple(graph.edges[e].tolist()): "real" if e % 2 else "fake" for e in edges}


class TestLabels:
    @pytest.fixture
    def crossing(self, made):
        """Two lines that cross near the middle of the first, and where."""
        graph = build_line_graph(made.segments, made.camera, made.frame)
        edge = int(np.flatnonzero(graph.kind == "X")[0])
        i, j = graph.edges[edge].tolist()
        return i, j, tuple(graph.crossing[edge].tolist())

    def label(self, made, crossing, word):
        i, j, pixel = crossing
        return LabelCrossing((anchor(made, i), anchor(made, j)), pixel, word)

    def said(self, made, lines):
        graph = build_line_graph(lines.segments, made.camera, made.frame, collinear=True)
        return graph, said_of(graph, lines)

    @pytest.mark.parametrize("word", ["real", "fake", "unsure"])
    def test_a_label_is_said_of_its_crossing_alone(self, made, applied, crossing, word):
        graph, said = self.said(made, applied(self.label(made, crossing, word)))
        edge = graph.edges.tolist().index(list(crossing[:2]))
        assert [e for e, label in enumerate(said.label) if label is not None] == [edge]
        assert said.label[edge] == word
        assert (np.flatnonzero(said.real).tolist(), np.flatnonzero(said.fake).tolist()) == (
            [edge] if word == "real" else [],
            [edge] if word == "fake" else [],
        )

    def test_the_last_word_counts_and_none_takes_it_back(self, made, applied, crossing):
        words = [self.label(made, crossing, word) for word in ("real", "fake", None)]
        assert [label for _, label in applied(*words[:2]).labels.values()] == ["fake"]
        assert applied(*words).labels == {}

    def test_after_a_split_the_label_belongs_to_the_nearer_piece(self, made, applied, crossing):
        i, j, pixel = crossing
        ends = made.pixels[i]
        share = np.linalg.norm(np.array(pixel) - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        at = ends[0] + (share + 0.15 if share < 0.5 else share - 0.15) * (ends[1] - ends[0])
        lines = applied(self.label(made, crossing, "fake"), Split(anchor(made, i), tuple(at.tolist())))
        count = len(made.axis)
        assert list(lines.labels) == [(j, count if share < 0.5 else count + 1)]

    def test_pieces_that_a_split_parted_are_not_one_line(self, made, applied):
        middle = made.pixels[0].mean(axis=0)
        graph, said = self.said(made, applied(Split(anchor(made, 0), tuple(middle.tolist()))))
        last = len(graph.segments) - 1
        tied = [e for e, pair in enumerate(graph.edges.tolist()) if pair == [last - 1, last]]
        assert said.fake[tied].all()

    def test_a_real_crossing_that_the_graph_does_not_have_is_a_note(self, made, applied):
        far = next(
            (i, j)
            for i in range(len(made.axis))
            for j in range(i)
            if made.axis[i] != made.axis[j]
            and np.linalg.norm(made.pixels[i].mean(axis=0) - made.pixels[j].mean(axis=0)) > 900
        )
        word = LabelCrossing((anchor(made, far[0]), anchor(made, far[1])), (10.0, 20.0), "real")
        _, said = self.said(made, applied(word))
        assert said.notes == (
            "the crossing at (10, 20) that was called real is not in the line graph; raise --extension",
        )


def test_lines_found_with_another_frame_are_other_lines(made, applied):
    drawn = SetFrame(tuple(anchor(made, line) for line in (0, 1)))
    lines = applied(Delete(anchor(made, 3)), drawn)
    assert lines.ids.min() >= FIRST_IDS
    assert len(lines.ids) == len(made.axis) - 1


def test_axes_named_before_the_frame_was_given_mean_nothing_any_more(made, applied):
    other = 1 if made.axis[3] != 1 else 0
    lines = applied(SetAxis(anchor(made, 3), other), SetFrame((anchor(made, 0),)))
    assert lines.segments.axis.tolist() == made.axis.tolist()


class TestSnap:
    def test_an_end_near_another_line_ends_there(self, made):
        lines = Correcting(made.segments, made.camera, made.frame)
        start = made.pixels[0, 0]
        ends, axis, snapped = lines.snapped(start + np.array([[3, 2], [3, 160]]), 2)
        assert snapped == (True, False)
        assert ends[0] == pytest.approx(start, abs=3)
        along, to = ends[1] - ends[0], start - ends[0]
        assert abs(along[0] * to[1] - along[1] * to[0]) < 1e-6 * np.linalg.norm(along)
        assert off_axis(made, ends, axis) < 1e-9

    def test_the_axis_is_that_of_the_nearest_vanishing_point(self, made):
        lines = Correcting(made.segments, made.camera, made.frame)
        for line in range(0, len(made.axis), 5):
            assert lines.snapped(made.pixels[line] + np.array([0.6, -0.4]), None)[1] == made.axis[line]
