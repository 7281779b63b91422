"""The promises of a line graph that every solver relies on, checked before it starts."""

import numpy as np

from linecad.directions import across, count_of, third
from linecad.line_graph import LineGraph


def check_graph(graph: LineGraph) -> None:
    """Raise ValueError unless axes, edges and numbers fit together; `solver.depths` checks the rays."""
    axis = graph.axis
    if (axis < 0).any():
        raise ValueError(f"segment {int(np.argmin(axis))} of the line graph has no axis")
    if (axis >= count_of(graph.turns)).any():
        raise ValueError(f"segment {int(np.argmax(axis))} of the line graph has axis {axis.max()}, no direction of it")
    if len(graph.edges) == 0:
        return
    i, j = graph.edges.T
    collinear = graph.kind == "collinear"
    same = axis[i] == axis[j]
    one_of = (graph.coordinate[:, None] == across(axis[i])).any(axis=1)
    fits = np.where(collinear, same & one_of, ~same & (graph.coordinate == third(axis[i], axis[j])))
    if not fits.all():
        k = int(np.argmin(fits))
        raise ValueError(
            f"edge {k} ({i[k]}, {j[k]}) of kind {graph.kind[k]} joins axes {axis[i[k]]} and {axis[j[k]]} "
            f"in coordinate {graph.coordinate[k]}"
        )
    if len(np.unique(graph.edges, axis=0)) != len(graph.edges):
        raise ValueError("the line graph holds two edges between the same two segments")
    if not (graph.weight > 0).all():
        raise ValueError(f"edge {int(np.argmin(graph.weight))} has weight {graph.weight.min()}, expected more than 0")
    if not (graph.tolerance >= 0).all():
        raise ValueError(f"edge {int(np.argmin(graph.tolerance))} has tolerance {graph.tolerance.min()}")
