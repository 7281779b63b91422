"""Lines that corrections name are found again by their geometry."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from linecad.corrections.apply import Correcting
from linecad.corrections.edits import LabelCrossing
from linecad.corrections.lookup import shared
from linecad.graph.build import build_line_graph
from linecad.line_graph import Segments


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
    def test_a_line_is_found_again_in_another_detection(self, made, seed, line, anchor):
        line %= len(made.axis)
        segments, order = self.detected(made, seed)
        lines = Correcting(segments, made.camera, made.frame)
        assert order[lines.find(anchor(line))] == line

    def test_of_two_pieces_the_longer_one_is_taken(self, made, anchor):
        line = made.pixels[0]
        cut = line[0] + 0.3 * (line[1] - line[0])
        pieces = Segments(np.array([[line[0], cut], [cut + 1, line[1]]]), [made.axis[0]] * 2)
        assert Correcting(pieces, made.camera, made.frame).find(anchor(0)) == 1

    def test_labels_of_crossings_come_back(self, made, applied, anchor):
        graph = build_line_graph(made.segments, made.camera, made.frame)
        edges = np.flatnonzero(made.truly_real(graph))[:20].tolist()
        edits = [
            LabelCrossing(
                (anchor(graph.edges[e, 0]), anchor(graph.edges[e, 1])),
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


def test_the_shared_stretch_is_over_all_that_either_covers():
    line = np.array([[0.0, 0.0], [100.0, 0.0]])
    others = np.array([
        [[50.0, 1.0], [150.0, 1.0]],  # 50 of 150 px, half of the shorter one
        [[60.0, 1.0], [160.0, 1.0]],  # less than half
        [[100.0, 0.0], [0.0, 0.0]],  # the line itself, the other way round
        [[0.0, 7.0], [100.0, 7.0]],  # too far beside it
    ])  # fmt: skip
    np.testing.assert_allclose(shared(line, others, across=6.0), [1 / 3, 0, 1, 0])
    assert len(shared(line, np.zeros((0, 2, 2)), across=6.0)) == 0
