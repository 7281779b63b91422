"""The made streets that the solvers are measured on have the statistics that the paper gives of its line graphs."""

import numpy as np
import pytest

SEEDS = range(10)
PAPER_LINES, PAPER_CROSSINGS = 215, 867.22
PAPER_FAKE = 1 - 751.78 / 867.22


@pytest.fixture(scope="module")
def drawn(streets):
    return [streets.make_instance(seed) for seed in SEEDS]


def test_streets_have_as_many_lines_as_the_graphs_of_the_paper(drawn):
    assert [len(street.graph.segments) for street in drawn] == [PAPER_LINES] * len(drawn)


def test_streets_have_as_many_crossings_as_the_graphs_of_the_paper(drawn):
    assert np.mean([len(street.graph.edges) for street in drawn]) == pytest.approx(PAPER_CROSSINGS, rel=0.05)


def test_streets_have_as_many_fake_crossings_as_the_graphs_of_the_paper(drawn):
    fake = [1 - street.real.mean() for street in drawn]
    assert np.mean(fake) == pytest.approx(PAPER_FAKE, abs=0.02)
    assert 0.06 < min(fake) < max(fake) < 0.22


def test_a_street_is_one_part(drawn):
    """So that its depths are known up to one scale, and nothing in it can be solved by itself."""
    for street in drawn:
        reached = {0}
        edges = street.graph.edges.tolist()
        while True:
            more = {line for edge in edges if reached & set(edge) for line in edge} - reached
            if not more:
                break
            reached |= more
        assert len(reached) == len(street.graph.segments)


def test_a_street_is_the_same_for_the_same_seed_only(streets, drawn):
    again = streets.make_instance(SEEDS[0])
    assert np.array_equal(again.graph.log_ratio, drawn[0].graph.log_ratio)
    assert np.array_equal(again.real, drawn[0].real)
    assert not np.array_equal(again.graph.log_ratio, drawn[1].graph.log_ratio)
