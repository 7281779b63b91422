"""The results of all photos as tables: the paper's two, and the measures of the default settings."""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

from linecad.evaluation.bootstrap import Estimate, exact, mean, ratio_of_sums
from linecad.evaluation.calibration import SURE, TENTHS
from linecad.evaluation.decisions import Decisions
from linecad.evaluation.depth import DepthScore
from linecad.evaluation.drawing_tables import drawings
from linecad.evaluation.measure import PhotoResult, WholeResult
from linecad.evaluation.methods import BASELINE, ROWS, Run, Settings
from linecad.evaluation.scopes import SceneScore, ScopeScore
from linecad.evaluation.table import Column, Row, Table
from linecad.line_graph import Formulation

CALIBRATION = "Calibration"  # title
CHOOSING = ("precision", "recall", "F1")  # columns that only a method that chooses crossings has


def all_tables(results: Sequence[PhotoResult], settings: Settings) -> list[Table]:
    """The tables that these results fill; photos with an error are in none."""
    good = [result for result in results if result.error is None]
    tables = []
    for formulation in settings.formulations:
        if any(formulation in result.methods for result in good):
            tables.append(table_1(good, formulation))
    if any(result.statistics for result in good):
        tables.append(table_2(good))
    if any(result.whole for result in good):
        tables.append(measures([result.whole for result in good if result.whole]))
    scores = {result.name: result.whole.depth for result in good if result.whole and result.whole.depth}
    if scores:
        tables.append(depths(list(scores.values())))
        tables += [calibration(list(scores.values()))] if any(score.calibration for score in scores.values()) else []
        tables.append(depths_by_photo(scores))
    return tables + drawings({result.name: result.whole.drawing for result in good if result.whole})


def table_1(results: Sequence[PhotoResult], formulation: Formulation) -> Table:
    """The paper's ablation: accuracy of the minimum spanning tree by families of constraints."""
    per_cent = [Column(name, "%") for name in ("mean acc.", "norm. acc.", "length in tree", *CHOOSING)]
    rows = []
    for name in ROWS[formulation]:
        runs = [result.methods[formulation][name] for result in results if name in result.methods.get(formulation, {})]
        rows.append(Row(name, _run_cells(runs, chooses=name != BASELINE)))
    note = "Crossings of the largest component at an extension of 30 px (at 3840 px width), no collinear edges. "
    if formulation == "gain":
        note += "Family C is part of the formulation itself, so it has no rows."
    else:
        note += "The baseline chooses no crossings, so it has no precision, recall and F1."
    return Table(
        f"Table 1, formulation {formulation}",
        note,
        (*per_cent, Column("solver", "s"), Column("proven optimal", "%")),
        tuple(rows),
    )


def _run_cells(runs: Sequence[Run], chooses: bool) -> tuple[Estimate | None, ...]:
    choosing = _choosing([run.decisions for run in runs]) if chooses else (None, None, None)
    return (
        *_tree([run.decisions for run in runs]),
        *choosing,
        mean([run.seconds for run in runs]),
        mean([float(run.status == "optimal") for run in runs]),
    )


def _tree(counted: Sequence[Decisions]) -> tuple[Estimate | None, ...]:
    """Mean accuracy sum n_a / sum N_a, normalised accuracy mean n_a / N_a, share of line length in the tree."""
    return (
        ratio_of_sums([d.tree_real for d in counted], [d.tree_real + d.tree_fake for d in counted]),
        mean([d.tree_share for d in counted]),
        ratio_of_sums([d.tied_length for d in counted], [d.total_length for d in counted]),
    )


def _choosing(counted: Sequence[Decisions]) -> tuple[Estimate | None, ...]:
    """Precision, recall and F1 of the crossings, over all crossings of all photos."""
    right = [d.chosen_real for d in counted]
    return (
        ratio_of_sums(right, [d.chosen_real + d.chosen_fake for d in counted]),
        ratio_of_sums(right, [d.chosen_real + d.missed_real for d in counted]),
        ratio_of_sums([2 * n for n in right], [2 * d.chosen_real + d.chosen_fake + d.missed_real for d in counted]),
    )


def table_2(results: Sequence[PhotoResult]) -> Table:
    """The paper's statistics of a dataset, per photo."""
    counted = [result.statistics for result in results if result.statistics]
    rows = (
        ("line segments in the largest connected component", mean([float(s.lines) for s in counted])),
        ("connections in the line graph", mean([float(s.crossings) for s in counted])),
        ("correct connections", mean([float(s.real) for s in counted])),
        ("incorrect connections", mean([float(s.fake) for s in counted])),
        ("connections undecided or not labelled", mean([float(s.undecided) for s in counted])),
    )
    return Table(
        "Table 2, statistics",
        f"Mean per photo over {len(counted)} labelled photos; the graph is that of table 1.",
        (Column("mean", ""),),
        tuple(Row(name, (cell,)) for name, cell in rows),
    )


def measures(wholes: Sequence[WholeResult]) -> Table:
    """The measures of the default settings, whole photos."""

    def each(read: Callable[[WholeResult], float | None]) -> Estimate | None:
        return mean([read(whole) for whole in wholes])

    decisions = [whole.decisions for whole in wholes if whole.decisions]
    planes = [whole.plane_score for whole in wholes if whole.plane_score]
    marked = [whole.marked for whole in wholes if whole.marked]
    tree, choosing = _tree(decisions), _choosing(decisions)
    rows = [
        ("crossings: precision", "%", choosing[0]),
        ("crossings: recall", "%", choosing[1]),
        ("crossings: F1", "%", choosing[2]),
        ("tree: mean accuracy", "%", tree[0]),
        ("tree: normalised accuracy", "%", tree[1]),
        ("tree: share of line length", "%", tree[2]),
        ("planes: precision", "%", ratio_of_sums([p.right_lines for p in planes], [p.lines for p in planes])),
        ("planes: recall", "%", ratio_of_sums([p.found_pixels for p in planes], [p.pixels for p in planes])),
        ("marked line length covered", "%", ratio_of_sums([m.covered for m in marked], [m.length for m in marked])),
        ("marked lines of right axis", "%", ratio_of_sums([m.right_axes for m in marked], [m.lines for m in marked])),
        ("rotation error", "degrees", each(lambda w: w.rotation_error)),
        ("lines", "", each(lambda w: float(w.lines))),
        ("planes", "", each(lambda w: float(w.planes))),
        ("solver", "s", each(lambda w: w.seconds)),
        ("proven optimal", "%", each(lambda w: float(w.status == "optimal"))),
    ]  # fmt: skip
    return Table(
        "Default settings, whole photos",
        "All lines that were found, all components; the planes scored are those of component 0.",
        (Column("value", ""),),
        tuple(Row(name, (cell,), unit) for name, unit, cell in rows if cell is not None),
    )


def depths(scores: Sequence[SceneScore]) -> Table:
    """The measures of depth, the same of everything that is in the file and of component 0."""
    scopes = [[score.everything for score in scores], [score.component_0 for score in scores]]
    rows = [(name, tuple(mean([read(score) for score in scope]) for scope in scopes)) for name, read in _DEPTHS.items()]
    return Table(
        "Depths",
        "Means over photos. Everything that is in the file by one scale, the median of all; component 0, and all that "
        "concerns confidence, by that of component 0.",
        (Column("everything", ""), Column("component 0", "")),
        tuple(Row(name, cells, "%") for name, cells in rows if any(cells)),
    )


def _of_precision(score: DepthScore | None, per_cent: int) -> float | None:
    """None where no point got a depth, or none tells the scale: there is nothing that could be wrong."""
    if score is None or score.with_depth == 0 or score.scale is None:
        return None
    return score.precision_2 if per_cent == 2 else score.precision_5


_DEPTHS: dict[str, Callable[[ScopeScore], float | None]] = {
    "lines: recall at 2 %": lambda scope: scope.lines.recall_2,
    "lines: recall at 5 %": lambda scope: scope.lines.recall_5,
    "lines: precision at 2 %": lambda scope: _of_precision(scope.lines, 2),
    "lines: precision at 5 %": lambda scope: _of_precision(scope.lines, 5),
    "lines and faces: recall at 2 %": lambda scope: scope.dense.recall_2 if scope.dense else None,
    "lines and faces: recall at 5 %": lambda scope: scope.dense.recall_5 if scope.dense else None,
    "lines and faces: precision at 2 %": lambda scope: _of_precision(scope.dense, 2),
    "lines and faces: precision at 5 %": lambda scope: _of_precision(scope.dense, 5),
    "area under recall over confidence": lambda scope: scope.confidence.recall_area if scope.confidence else None,
    "area under precision over recall": lambda scope: scope.confidence.precision_area if scope.confidence else None,
    f"confidence {SURE}: recall at 5 %": lambda scope: scope.confidence.sure_recall if scope.confidence else None,
    f"confidence {SURE}: precision at 5 %": lambda scope: scope.confidence.sure_precision if scope.confidence else None,
}


def calibration(scores: Sequence[SceneScore]) -> Table:
    """Probability as stated and as it is, in tenths, over the points of all photos."""
    photos = [score.calibration for score in scores if score.calibration]
    bounds = [0.0, *TENTHS.tolist(), 1.0]
    rows = []
    for number, name in enumerate(f"{low:.1f} to {high:.1f}" for low, high in pairwise(bounds)):
        tenths = [photo[number] for photo in photos]
        points = [tenth.points for tenth in tenths]
        stated = ratio_of_sums([tenth.stated for tenth in tenths], points)
        right = ratio_of_sums([tenth.right for tenth in tenths], points)
        rows.append(Row(name, (exact(float(sum(points))), stated, right)))
    return Table(
        CALIBRATION,
        "Points on edges by the probability of the line that gives them a depth: how many, the mean of what was "
        "stated, and the share that is right within 5 % by the scale of component 0.",
        (Column("points", ""), Column("stated", "%"), Column("right", "%")),
        tuple(rows),
    )


def depths_by_photo(scores: Mapping[str, SceneScore]) -> Table:
    """What is measured of the depths at 5 %, photo by photo."""
    scopes = ("everything", "everything, faces too", "component 0")
    names = [f"{scope}: {what}" for scope in scopes for what in ("recall", "precision")]
    rows = []
    for name, score in scores.items():
        found = (score.everything.lines, score.everything.dense, score.component_0.lines)
        cells = [(each.recall_5 if each else None, _of_precision(each, 5)) for each in found]
        rows.append(Row(name, tuple(None if cell is None else exact(cell) for pair in cells for cell in pair)))
    return Table("Depths by photo", "At 5 %.", tuple(Column(name, "%") for name in names), tuple(rows))
