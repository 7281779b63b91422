"""What a few clicks are worth: python tests/benchmarks/clicks.py DATASET --only 0015 [--clicks 3]

For a photo of known depth: the automatic model, and then one correction after the other, as a person at the page of
`linecad edit` makes them who sees what is wrong. Each click calls a crossing real that ties one of the largest other
groups to component 0: the one that gains most, which a person sees, and this program finds by trying some. Prints
recall and precision at 5 % of component 0 before and after each click.
"""

import argparse
from pathlib import Path

import numpy as np

from linecad.camera.photo import Photo
from linecad.corrections.apply import correct
from linecad.corrections.edits import Anchor, Corrections, LabelCrossing
from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.depth import DepthScore, score_depth
from linecad.evaluation.references import Reference, open_case
from linecad.finding import FoundLines, connect, find_lines
from linecad.line_graph import Segments
from linecad.options import Options
from linecad.pipeline import reconstruct_lines
from linecad.scene import Scene
from solver.options import SolveOptions

LARGEST_GROUPS = 3  # besides component 0, that a click may tie to it
TRIED = 8  # crossings for each click


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--only", default="", help="photos whose name starts so")
    parser.add_argument("--clicks", type=int, default=3)
    parser.add_argument("--time-limit", type=float, default=3.0)
    chosen = parser.parse_args()
    for case in find_dataset(chosen.dataset).cases:
        if case.name.startswith(chosen.only):
            measure(case, Options(solve=SolveOptions(time_limit_s=chosen.time_limit)), chosen.clicks)


def measure(case: Case, options: Options, clicks: int) -> None:
    """Print one line before, and one after each click."""
    photo, reference = open_case(case)
    found = find_lines(photo).grouped(options)
    said = Corrections(photo.name, photo.width, photo.height)
    scene = solved(photo, found, said, options)
    best = scored(scene, reference)
    print(f"{case.name} before: recall {best.recall_5:.3f}, precision {best.precision_5:.3f}", flush=True)
    for click in range(1, clicks + 1):
        better = None
        for edit in candidates(found, scene, options):
            more = Corrections(said.photo, said.width, said.height, (*said.edits, edit))
            try:
                tried = solved(photo, found, more, options)
            except LinecadError:
                continue
            score = scored(tried, reference)
            if score.recall_5 > best.recall_5:
                better, best, scene = (more, edit), score, tried
        if better is None:
            print(f"{case.name}: no other click of those tried helps")
            return
        said = better[0]
        print(
            f"{case.name} click {click}, {better[1].label} at {np.round(better[1].pixel).astype(int).tolist()}: "
            f"recall {best.recall_5:.3f}, precision {best.precision_5:.3f}",
            flush=True,
        )


def solved(photo: Photo, found: FoundLines, said: Corrections, options: Options) -> Scene:
    corrected = correct(found.segments, found.camera, found.frame, said)
    return reconstruct_lines(photo.name, found, options, corrected=corrected).scene


def scored(scene: Scene, reference: Reference) -> DepthScore:
    assert reference.edges is not None
    return score_depth(scene, reference.edges.pixels, reference.edges.depth, scene.lines.component == 0)


def candidates(found: FoundLines, scene: Scene, options: Options) -> list[LabelCrossing]:
    """Crossings that would tie a large group to component 0, called real: those with the smallest gaps."""
    _, graph = connect(found, options)
    component = {}
    for axis, ends, number in zip(scene.lines.axis, scene.lines.segment, scene.lines.component, strict=True):
        component[int(axis), ends.tobytes()] = int(number)
    keys = zip(graph.segments.axis.tolist(), graph.segments.ends, strict=True)
    own = np.array([component.get((axis, ends.tobytes()), -1) for axis, ends in keys])
    sizes = np.bincount(own[own > 0], minlength=1)
    large = np.argsort(-sizes, kind="stable")[:LARGEST_GROUPS]
    first, second = own[graph.edges].T
    joins = ((first == 0) & np.isin(second, large)) | ((second == 0) & np.isin(first, large))
    joins &= graph.informative & (np.maximum(first, second) > 0) & (graph.kind != "collinear")
    order = np.flatnonzero(joins)[np.argsort(graph.gap[joins].max(axis=1), kind="stable")][:TRIED]
    return [
        LabelCrossing(
            (anchor(graph.segments, int(i)), anchor(graph.segments, int(j))),
            (float(graph.crossing[edge][0]), float(graph.crossing[edge][1])),
            "real",
        )
        for edge in order.tolist()
        for i, j in [graph.edges[edge]]
    ]


def anchor(segments: Segments, line: int) -> Anchor:
    (u, v), (s, t) = segments.ends[line].tolist()
    return Anchor(((u, v), (s, t)), int(segments.axis[line]))


if __name__ == "__main__":
    main()
