"""Groups of lines that edges tie to each other."""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from linecad.scene import Int


def group_numbers(count: int, edges: Int) -> Int:
    """Number (N,) of the group that edges (E, 2) tie each of `count` lines to."""
    links = csr_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), (count, count))
    return np.asarray(connected_components(links, directed=False)[1], np.int64)
