"""The scene program against brute force, and what it promises."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.random import Generator

from linecad.arrays import Bool, Float
from solver.bodies import program, search
from solver.bodies.local_search import ELSEWHERE
from solver.bodies.program import FARTHEST
from solver.bodies.search import place
from solver.bodies.ties import Ties, pseudoforest
from solver.options import Progress, SolveOptions

OPTIONS = SolveOptions()
BOX = 1000.0  # weight of what keeps bodies within reach


def some_ties(rng: Generator, bodies: int, count: int, grouped: bool = True) -> Ties:
    """Ties of which half are as one draw of scales asks."""
    truth = rng.uniform(-0.2, 0.2, bodies)
    pairs = np.array([rng.choice(bodies, 2, replace=False) for _ in range(count)])
    right = rng.random(count) < 0.5
    asked = truth[pairs[:, 0]] - truth[pairs[:, 1]] + rng.normal(0, 0.005, count)
    return Ties(
        bodies=pairs,
        log_ratio=np.where(right, asked, rng.uniform(-0.45, 0.45, count)),
        tolerance=np.full(count, 0.02),
        weight=rng.uniform(1, 6, count),
        group=rng.integers(-1, 2, count) if grouped else np.full(count, -1),
    )


def are_possible(ties: Ties, bodies: int) -> bool:
    """Whether scales exist at which all ties hold: no negative cycle, by Floyd and Warshall."""
    longest = np.where(np.eye(bodies, dtype=bool), 0.0, np.inf)
    for (first, second), ratio, tolerance in zip(ties.bodies, ties.log_ratio, ties.tolerance, strict=True):
        longest[second, first] = min(longest[second, first], ratio + tolerance)
        longest[first, second] = min(longest[first, second], tolerance - ratio)
    for middle in range(bodies):
        longest = np.minimum(longest, longest[:, [middle]] + longest[[middle]])
    return bool((np.diag(longest) >= -1e-9).all())


def is_pseudoforest(edges: Float) -> bool:
    """Whether no set of nodes holds more edges than nodes, by the definition."""
    nodes = sorted(set(edges.ravel().tolist()))
    for chosen in product([False, True], repeat=len(nodes)):
        inside = {node for node, is_in in zip(nodes, chosen, strict=True) if is_in}
        if sum(set(edge) <= inside for edge in edges.tolist()) > len(inside):
            return False
    return True


def best_value(ties: Ties, bodies: int) -> float:
    """The most weight of any subset of ties that may count and hold at once."""
    best = 0.0
    for chosen in product([False, True], repeat=len(ties)):
        keep = np.array(chosen)
        worth = float(ties.weight[keep].sum())
        if worth <= best or not are_possible(ties.subset(keep), bodies):
            continue
        groups = [ties.bodies[keep & (ties.group == group)] for group in set(ties.group.tolist()) - {-1}]
        if all(is_pseudoforest(edges) for edges in groups):
            best = worth
    return best


@pytest.mark.parametrize("seed", range(60))
def test_the_answer_is_the_best_of_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies = int(rng.integers(2, 5))
    ties = some_ties(rng, bodies, int(rng.integers(1, 9)))
    found = place(ties, bodies, 0, OPTIONS)
    assert found.status == "optimal"
    assert found.gap == 0
    assert found.objective == pytest.approx(best_value(ties, bodies))
    assert ties.weight[found.counted].sum() == pytest.approx(found.objective)
    assert ties.holds(found.log_scale)[found.counted].all()


@pytest.mark.parametrize("seed", range(40))
def test_the_heaviest_first_are_the_best_pseudoforest(seed: int) -> None:
    rng = np.random.default_rng(seed)
    edges = np.array([rng.choice(4, 2, replace=False) for _ in range(7)])
    weight = np.sort(rng.uniform(1, 5, len(edges)))[::-1]
    best = max(
        float(weight[np.array(keep)].sum())
        for keep in product([False, True], repeat=len(edges))
        if is_pseudoforest(edges[np.array(keep)])
    )
    assert weight[pseudoforest(edges)].sum() == pytest.approx(best)


def yielding(ties: Ties, rng: Generator) -> Ties:
    """The same, of which half yield."""
    return replace(ties, yields=rng.random(len(ties)) < 0.5)


@pytest.mark.parametrize("seed", range(30))
def test_the_answer_is_the_best_of_all_where_ties_yield(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies = int(rng.integers(2, 5))
    ties = yielding(some_ties(rng, bodies, int(rng.integers(1, 9))), rng)
    found = place(ties, bodies, 0, OPTIONS)
    assert found.status == "optimal"
    assert found.objective == pytest.approx(best_value(ties, bodies))
    assert ties.holds(found.log_scale)[found.counted].all()
    assert ties.weight[found.counted].sum() <= found.objective + 1e-9


def least_squares(ties: Ties, counted: Bool, count: int, reference: int) -> Float:
    """The log scales (B,) that meet the counted ties best, by normal equations: 0 for one body of each part."""
    used = ties.subset(counted)
    rows = np.zeros((len(used), count))
    rows[np.arange(len(used)), used.bodies[:, 0]] = 1.0
    rows[np.arange(len(used)), used.bodies[:, 1]] -= 1.0
    strength = used.weight / used.tolerance**2
    linked = np.linalg.matrix_power(np.eye(count) + np.abs(rows.T) @ np.abs(rows), count) > 0
    first = [reference if linked[body, reference] else int(linked[body].argmax()) for body in range(count)]
    free = [body for body in range(count) if first[body] != body]
    found = np.zeros(count)
    normal = rows[:, free].T * strength
    found[free] = np.linalg.solve(normal @ rows[:, free], normal @ used.log_ratio)
    return found


@pytest.mark.parametrize("seed", range(40))
def test_scales_are_in_the_middle_of_what_counts(seed: int) -> None:
    """What counts is met by weighted least squares where no tie yields."""
    rng = np.random.default_rng(seed)
    ties = some_ties(rng, 5, int(rng.integers(3, 14)))
    ties = replace(ties, tolerance=rng.uniform(0.02, 0.04, len(ties)))
    found = place(ties, 5, 2, OPTIONS)
    wanted = least_squares(ties, found.counted, 5, 2)
    if ties.value(wanted) >= found.objective - 1e-9:
        np.testing.assert_allclose(found.log_scale, wanted, atol=1e-9)
    else:
        assert ties.value(found.log_scale) == pytest.approx(found.objective), "what counts goes before its middle"


def test_one_tie_at_the_end_of_its_interval_keeps_no_other_body_from_its_middle() -> None:
    """Three ties in a ring miss each other by 0.03, the least worth of them by all it may; two place one more body."""
    ring, two = [[0, 1], [1, 2], [2, 0]], [[3, 0], [3, 0]]
    ratio, weight = [0.0, 0.03, 0.0, 0.1, 0.11], [10.0, 1.0, 10.0, 1.0, 3.0]
    ties = Ties([*ring, *two], ratio, [0.02] * 5, weight, [-1] * 5)
    found = place(ties, 4, 0, OPTIONS)
    assert found.counted.all()
    assert ties.misfit(found.log_scale)[:3].tolist() == pytest.approx([0.005, 0.02, 0.005], abs=1e-9)
    assert found.log_scale[3] == pytest.approx(0.1075, abs=1e-9)


def test_ties_that_yield_move_nothing_that_others_hold() -> None:
    firm = Ties([[0, 1]], [0.3], [0.02], [1.0], [-1])
    for ratio in (0.285, 0.3, 0.319):
        found = place(firm.joined(Ties([[0, 1]], [ratio], [0.02], [50.0], [-1], [True])), 2, 0, OPTIONS)
        assert found.counted.all()
        assert found.log_scale.tolist() == pytest.approx([0.0, -0.3], abs=1e-12)


def test_ties_that_yield_place_what_nothing_else_holds() -> None:
    found = place(Ties([[0, 1], [2, 1]], [0.3, -0.1], [0.02] * 2, [1.0, 2.0], [-1] * 2, [True] * 2), 3, 0, OPTIONS)
    assert found.log_scale.tolist() == pytest.approx([0.0, -0.3, -0.4], abs=1e-9)
    assert found.counted.all()


def test_ties_that_yield_shift_as_a_whole_what_others_hold() -> None:
    """Bodies 0 and 1, and 2 and 3, are held together; 4 is tied to all of them, to each a little otherwise."""
    firm = Ties([[0, 1], [2, 3]], [0.2, -0.1], [0.02] * 2, [1.0, 1.0], [-1] * 2)
    off = np.array([0.01, -0.01, 0.01, 0.0])
    asked = np.array([0.0, -0.2, 0.5, 0.6]) + off
    loose = Ties([[body, 4] for body in range(4)], asked, [0.02] * 4, [30.0, 30.0, 10.0, 30.0], [-1] * 4, [True] * 4)
    found = place(firm.joined(loose), 5, 0, OPTIONS)
    assert found.counted.all()
    second = 0.5 + np.average(off[2:], weights=[10.0, 30.0])
    assert found.log_scale.tolist() == pytest.approx([0.0, -0.2, second, second + 0.1, 0.0], abs=1e-9)


def test_what_yields_may_cease_to_hold() -> None:
    """Its weight tells which of two places it is, not where in the interval."""
    firm = Ties([[0, 1], [0, 1]], [0.3, 0.5], [0.02] * 2, [3.0, 2.0], [-1] * 2)
    found = place(firm.joined(Ties([[0, 1]], [0.475], [0.006], [4.0], [-1], [True])), 2, 0, OPTIONS)
    assert found.objective == pytest.approx(6.0)
    assert found.log_scale.tolist() == pytest.approx([0.0, -0.5], abs=1e-9)
    assert found.counted.tolist() == [False, True, False]


def test_joined_ties_stand_one_after_the_other() -> None:
    rng = np.random.default_rng(4)
    first, second = some_ties(rng, 4, 5), yielding(some_ties(rng, 4, 3), rng)
    both = first.joined(second)
    assert len(both) == 8
    for name, value in vars(both).items():
        np.testing.assert_array_equal(value, [*getattr(first, name), *getattr(second, name)])
    assert not np.asarray(first.yields).any()
    none = Ties(np.zeros((0, 2)), [], [], [], [])
    for same in (second.joined(none), none.joined(second), both.subset(np.arange(5, 8))):
        for name, value in vars(same).items():
            np.testing.assert_array_equal(value, getattr(second, name))


def test_the_same_ties_give_the_same_answer() -> None:
    ties = some_ties(np.random.default_rng(5), 10, 36)
    first, second = (place(ties, 10, 0, OPTIONS) for _ in range(2))
    assert first.log_scale.tobytes() == second.log_scale.tobytes()
    assert (first.objective, first.nodes, first.margin.tolist()) == (
        second.objective, second.nodes, second.margin.tolist(),
    )  # fmt: skip


def test_scales_are_those_of_the_ties() -> None:
    ties = Ties([[0, 1], [1, 2], [0, 2]], [0.3, -0.1, 0.2], [0.02] * 3, [2.0, 3.0, 1.0], [-1] * 3)
    found = place(ties, 3, 0, OPTIONS)
    assert found.log_scale == pytest.approx([0.0, -0.3, -0.2], abs=1e-5)
    assert found.counted.all()


def test_heavier_evidence_wins() -> None:
    ties = Ties([[0, 1], [1, 0], [0, 1]], [0.3, 0.5, -0.5], [0.02] * 3, [4.0, 2.0, 2.5], [-1] * 3)
    found = place(ties, 2, 0, OPTIONS)  # the second and third say the same
    assert found.log_scale == pytest.approx([0.0, 0.5], abs=1e-5)
    assert found.objective == pytest.approx(4.5)


def test_what_no_tie_leads_to_stays() -> None:
    found = place(Ties([[1, 2]], [0.4], [0.02], [1.0], [-1]), 4, 0, OPTIONS)
    assert found.log_scale == pytest.approx([0.0, 0.0, -0.4, 0.0], abs=1e-5)
    assert found.margin[[1, 2, 3]].tolist() == [0, 0, 0]


def test_a_start_beyond_what_is_looked_at_ends_the_search_early(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    chain = [[body + 1, body] for body in range(5)]
    others = some_ties(rng, 6, 40, grouped=False)
    ties = Ties(
        [*chain, *others.bodies.tolist()], [0.5] * 5 + others.log_ratio.tolist(), [0.02] * 45,
        [50.0] * 5 + others.weight.tolist(), [-1] * 45,
    )  # fmt: skip
    found = place(ties, 6, 0, OPTIONS)
    assert found.log_scale[5] == pytest.approx(2.5, abs=0.1)
    assert found.log_scale[5] > FARTHEST
    assert found.counted[:5].all()
    assert (found.status, found.gap) == ("optimal", 0)
    monkeypatch.setattr(search, "FARTHEST", np.inf)
    blind = place(ties, 6, 0, OPTIONS)  # SCIP hears of nothing that it has to beat
    assert blind.objective == found.objective
    assert found.nodes < blind.nodes / 5


@pytest.mark.parametrize("seed", range(20))
def test_what_lies_within_has_to_beat_a_start_beyond(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (search, program):
        monkeypatch.setattr(module, "FARTHEST", 0.15)
    rng = np.random.default_rng(seed)
    bodies = int(rng.integers(2, 5))
    ties = some_ties(rng, bodies, int(rng.integers(1, 9)))
    near = rng.uniform(-0.5, 0.5, bodies)
    found = place(ties, bodies, 0, OPTIONS, near=near)
    within = best_value(with_box(ties, bodies, 0.15), bodies) - BOX * (bodies - 1)
    assert found.status == "optimal"
    assert within - 1e-6 <= found.objective <= best_value(ties, bodies) + 1e-6
    assert ties.holds(found.log_scale)[found.counted].all()


def with_box(ties: Ties, bodies: int, reach: float) -> Ties:
    """The ties with one more for each body that keeps it within reach of the reference and outweighs them all."""
    return Ties(
        [*ties.bodies.tolist(), *([body, 0] for body in range(1, bodies))],
        [*ties.log_ratio.tolist(), *[0.0] * (bodies - 1)], [*ties.tolerance.tolist(), *[reach] * (bodies - 1)],
        [*ties.weight.tolist(), *[BOX] * (bodies - 1)], [*ties.group.tolist(), *[-1] * (bodies - 1)],
    )  # fmt: skip


def test_no_ties_are_an_answer() -> None:
    found = place(Ties(np.zeros((0, 2)), [], [], [], []), 3, 1, OPTIONS)
    assert found.log_scale.tolist() == [0, 0, 0]
    assert (found.objective, found.status) == (0, "optimal")


def test_ties_of_a_group_repeat_each_other() -> None:
    """Four bodies in one plane: six ties, of which four count."""
    pairs = [[a, b] for a in range(4) for b in range(a)]
    ties = Ties(pairs, [0.0] * 6, [0.02] * 6, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0] * 6)
    assert place(ties, 4, 0, OPTIONS).objective == pytest.approx(6 + 5 + 4 + 3)


def test_a_tie_that_outweighs_all_others_keeps_its_ratio() -> None:
    ties = Ties([[0, 1], [0, 1]], [0.1, 0.115], [0.0035, 0.02], [1e6, 3.0], [-1] * 2)
    found = place(ties, 2, 0, OPTIONS)
    assert found.counted.all()
    assert found.log_scale.tolist() == pytest.approx([0.0, -0.1], abs=1e-6)


def test_margin_is_what_another_place_loses() -> None:
    ties = Ties([[0, 1], [0, 1], [1, 2]], [0.0, 0.4, 0.0], [0.02] * 3, [5.0, 3.0, 1.0], [-1] * 3)
    found = place(ties, 3, 0, OPTIONS)
    assert found.margin.tolist() == pytest.approx([2.0, 2.0, 1.0])  # 2 moves alone; 1 takes 2 with it


@pytest.mark.parametrize("seed", range(10))
def test_margins_do_not_exceed_what_moving_one_body_loses(seed: int) -> None:
    ties = some_ties(np.random.default_rng(seed), 6, 25)
    found = place(ties, 6, 0, OPTIONS)
    first, second = ties.bodies.T
    for body in range(1, 6):
        own = np.flatnonzero((first == body) | (second == body))
        sign = np.where(first[own] == body, 1.0, -1.0)
        missed = sign * (ties.log_ratio - found.log_scale[first] + found.log_scale[second])[own]
        for by in [9.0, *missed.tolist()]:
            if abs(by) >= ELSEWHERE:
                moved = found.log_scale + by * (np.arange(6) == body)
                assert found.margin[body] <= found.objective - ties.value(moved) + 1e-9


def test_progress_is_told_and_a_node_limit_ends_the_search() -> None:
    told: list[Progress] = []
    ties = some_ties(np.random.default_rng(3), 20, 160)
    found = place(ties, 20, 0, SolveOptions(node_limit=1), told.append)
    assert told
    assert found.bound >= found.objective
    assert found.status in ("optimal", "node limit")
    assert (found.gap > 0) == (found.status == "node limit")


def test_the_search_ends_after_so_many_nodes_where_no_limit_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    ties = some_ties(np.random.default_rng(3), 12, 60)
    proven = place(ties, 12, 0, SolveOptions())
    assert proven.status == "optimal"
    assert proven.nodes > 1
    monkeypatch.setattr("solver.bodies.search.MOST_NODES", 1)
    found = place(ties, 12, 0, SolveOptions())
    assert (found.status, found.nodes) == ("node limit", 1)
    assert found.objective <= proven.objective <= found.bound
    assert place(ties, 12, 0, SolveOptions(node_limit=1)).objective == found.objective


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("bodies", [[0, 0]]),
        ("tolerance", [0.0]),
        ("weight", [-1.0]),
        ("group", [-2]),
        ("log_ratio", [0.1, 0.2]),
        ("yields", [True, False]),
    ],
)
def test_ties_that_mean_nothing_are_refused(field: str, value: list[object]) -> None:
    known = {"bodies": [[0, 1]], "log_ratio": [0.1], "tolerance": [0.02], "weight": [1.0], "group": [-1]}
    with pytest.raises(ValueError, match="Ties"):
        Ties(**{**known, field: value})
