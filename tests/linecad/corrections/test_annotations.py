"""What corrections mean for a line graph: labels of its crossings."""

import numpy as np
import pytest

from linecad.corrections.annotations import annotations_of, by_hand
from linecad.corrections.edits import Anchor, Draw, KnownLength, LabelCrossing, Split
from linecad.graph.build import build_line_graph


class TestAnnotations:
    @pytest.fixture
    def crossing(self, made):
        """Two lines that cross near the middle of the first, and where."""
        graph = build_line_graph(made.segments, made.camera, made.frame)
        edge = int(np.flatnonzero(graph.kind == "X")[0])
        i, j = graph.edges[edge].tolist()
        return i, j, tuple(graph.crossing[edge].tolist())

    def label(self, anchor, crossing, word):
        i, j, pixel = crossing
        return LabelCrossing((anchor(i), anchor(j)), pixel, word)

    def noted(self, made, lines):
        graph = build_line_graph(lines.segments, made.camera, made.frame, collinear=True)
        return graph, annotations_of(graph, lines)

    @pytest.mark.parametrize("word", ["real", "fake", "unsure"])
    def test_a_label_belongs_to_its_crossing_alone(self, made, applied, anchor, crossing, word):
        graph, noted = self.noted(made, applied(self.label(anchor, crossing, word)))
        edge = graph.edges.tolist().index(list(crossing[:2]))
        assert [e for e, label in enumerate(noted.label) if label is not None] == [edge]
        assert noted.label[edge] == word
        assert (np.flatnonzero(noted.real).tolist(), np.flatnonzero(noted.fake).tolist()) == (
            [edge] if word == "real" else [],
            [edge] if word == "fake" else [],
        )

    def test_the_last_word_counts_and_none_takes_it_back(self, applied, anchor, crossing):
        words = [self.label(anchor, crossing, word) for word in ("real", "fake", None)]
        assert [label for _, label in applied(*words[:2]).labels.values()] == ["fake"]
        assert applied(*words).labels == {}

    def test_after_a_split_the_label_belongs_to_the_nearer_piece(self, made, applied, crossing, anchor):
        i, j, pixel = crossing
        ends = made.pixels[i]
        share = np.linalg.norm(np.array(pixel) - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        at = ends[0] + (share + 0.15 if share < 0.5 else share - 0.15) * (ends[1] - ends[0])
        lines = applied(self.label(anchor, crossing, "fake"), Split(anchor(i), tuple(at.tolist())))
        count = len(made.axis)
        assert list(lines.labels) == [(j, count if share < 0.5 else count + 1)]

    def test_pieces_that_a_split_parted_are_not_one_line(self, made, applied, anchor):
        middle = made.pixels[0].mean(axis=0)
        graph, noted = self.noted(made, applied(Split(anchor(0), tuple(middle.tolist()))))
        last = len(graph.segments) - 1
        parted = [e for e, pair in enumerate(graph.edges.tolist()) if pair == [last - 1, last]]
        assert noted.fake[parted].all()

    def test_a_real_crossing_that_the_graph_does_not_have_is_a_note(self, made, applied, anchor):
        far = next(
            (i, j)
            for i in range(len(made.axis))
            for j in range(i)
            if made.axis[i] != made.axis[j]
            and np.linalg.norm(made.pixels[i].mean(axis=0) - made.pixels[j].mean(axis=0)) > 900
        )
        word = LabelCrossing((anchor(far[0]), anchor(far[1])), (10.0, 20.0), "real")
        _, noted = self.noted(made, applied(word))
        assert noted.notes == (
            "the crossing at (10, 20) that was called real is not in the line graph; raise --option extension=PX",
        )


def test_what_a_person_drew_or_measured_is_by_hand(made, applied, anchor):
    drawn = Anchor(((300.0, 300.0), (380.0, 290.0)), 0)
    lines = applied(Draw(drawn), KnownLength(anchor(1), 2.5))
    graph = build_line_graph(lines.segments, made.camera, made.frame)
    rows = lines.segments.rows(graph.segments)
    wanted = [lines.origin[row] == "drawn" or lines.ids[row] == 1 for row in rows.tolist()]
    assert by_hand(graph, lines).tolist() == wanted
    assert sum(wanted) == 2
    assert by_hand(graph, None) is None
