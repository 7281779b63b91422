"""The counts of drawings as tables: a row a photo, and the means."""

from collections.abc import Callable, Mapping

from linecad.evaluation.bootstrap import Estimate, exact, mean
from linecad.evaluation.drawing import DrawingScore
from linecad.evaluation.drawing_truth import TrueCounts
from linecad.evaluation.table import Column, Row, Table

MEAN = "mean"

Reader = Callable[[DrawingScore], float | None]


def _share(part: int, whole: int) -> float | None:
    return part / whole if whole else None


def _of_truth(read: Callable[[TrueCounts], float | None]) -> Reader:
    return lambda score: None if score.truth is None else read(score.truth)


FACES: dict[Column, Reader] = {
    Column("photo covered", "%"): lambda score: score.photo_covered,
    Column("known covered", "%"): lambda score: score.known_covered,
    Column("ground faces", ""): lambda score: score.ground.faces,
    Column("walls on the ground", "%"): lambda score: _share(score.ground.walls_on_ground, score.ground.walls),
    Column("faces", ""): lambda score: score.faces.faces,
    Column("of openings", ""): lambda score: score.faces.of_openings,
    Column("too many", ""): lambda score: score.faces.too_many,
    Column("alone", ""): lambda score: score.faces.alone,
    Column("steps", ""): lambda score: score.faces.steps,
    Column("steps without a line", ""): lambda score: score.faces.steps_without_line,
    Column("slivers", ""): lambda score: score.faces.slivers,
    Column("small", ""): lambda score: score.faces.small,
    Column("holes", ""): lambda score: score.faces.holes,
    Column("recesses", ""): lambda score: score.faces.recesses,
}
LINES: dict[Column, Reader] = {
    Column("lines", ""): lambda score: score.lines.lines,
    Column("details", ""): lambda score: score.lines.details,
    Column("too many", ""): lambda score: score.lines.too_many,
    Column("parallel pairs", ""): lambda score: score.lines.parallel_pairs,
    Column("ends", ""): lambda score: score.lines.ends,
    Column("near misses", ""): lambda score: score.lines.missing,
    Column("in the air", ""): lambda score: score.lines.in_air,
    Column("in the air", "%"): lambda score: _share(score.lines.in_air, score.lines.ends),
}
TRUTH: dict[Column, Reader] = {
    Column("right axis", "%"): _of_truth(lambda truth: _share(truth.right_axis, truth.pixels)),
    Column("right plane", "%"): _of_truth(lambda truth: _share(truth.right_plane, truth.pixels)),
    Column("sky covered", "%"): _of_truth(lambda truth: _share(truth.sky_covered, truth.sky)),
    Column("ground in one face", "%"): _of_truth(lambda truth: truth.ground_covered),
    Column("one ground", "%"): _of_truth(lambda truth: truth.has_one_ground),
    Column("ground height right", "%"): _of_truth(lambda truth: truth.has_right_height),
    Column("windows F1", "%"): lambda score: score.windows,
    Column("all windows F1", "%"): lambda score: score.all_windows,
}
TABLES: dict[str, tuple[str, dict[Column, Reader]]] = {
    "Drawing: faces": ("What a draughtsman would object to in the faces.", FACES),
    "Drawing: lines": ("What a draughtsman would strike out or close.", LINES),
    "Drawing against truth": ("Shares of the pixels of planes, and the ground, of made photos.", TRUTH),
}


def drawings(scores: Mapping[str, DrawingScore]) -> list[Table]:
    """A table of faces, one of lines and, where there is truth, one of that, by the names of the photos."""
    tables = []
    for title, (note, columns) in TABLES.items():
        known = {name: score for name, score in scores.items() if columns is not TRUTH or score.truth is not None}
        if known:
            rows = [Row(name, tuple(_cell(read(score)) for read in columns.values())) for name, score in known.items()]
            rows.append(Row(MEAN, tuple(mean([read(score) for score in known.values()]) for read in columns.values())))
            tables.append(Table(title, f"{note} Definitions: docs/reference/evaluation.md.", (*columns,), tuple(rows)))
    return tables


def _cell(value: float | None) -> Estimate | None:
    return None if value is None else exact(float(value))
