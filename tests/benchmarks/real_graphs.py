"""Line graphs of real photos as the pipeline builds them, to measure solvers; the photos are not in the project."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from linecad.camera.photo import read_photo
from linecad.camera.vanishing_points import find_frame
from linecad.graph.build import build_line_graph
from linecad.graph.connectivity import components
from linecad.line_graph import LineGraph
from linecad.lines.segments import find_segments, group_segments, label_segments
from linecad.options import SHORT_REACH

DATASETS = ("castle", "south_building")


def real_graphs(
    folder: Path, extension: float, longest: int | None, collinear: bool, only: str = ""
) -> Iterator[tuple[str, LineGraph]]:
    """Name and largest component of the line graph of each photo with a camera file under castle/ and south_building/.

    `extension` is in px at the width of 3840 px; `longest` keeps so many of the longest segments; `only` is a part of
    the name ("castle/0012"). All weights are one. Raises FileNotFoundError when no photo fits.
    """
    files = [file for dataset in DATASETS for file in sorted((folder / dataset).glob("*.json"))]
    files = [file for file in files if only in f"{file.parent.name}/{file.stem}"]
    if not files:
        raise FileNotFoundError(f"no photo {only!r} with a camera file in {', '.join(DATASETS)} of {folder}")
    for file in files:
        photo = read_photo(file.with_suffix(".jpg"), file)
        assert photo.camera is not None, "the camera file was given"
        raw = find_segments(photo.grey)
        frame = find_frame(raw, photo.camera.matrix)
        segments = group_segments(label_segments(raw, photo.camera, frame), photo.camera, frame)
        if longest is not None:
            segments = segments.subset(np.sort(np.argsort(-segments.length, kind="stable")[:longest]))
        graph = build_line_graph(
            segments, photo.camera, frame, replace(SHORT_REACH, extension=extension), "ones", collinear
        )
        yield f"{file.parent.name}/{file.stem}", graph.subset(np.sort(components(graph)[0]))
