"""The weakest place of a graph: the cut of least conductance along its slowest ways of swinging."""

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_matrix, identity
from scipy.sparse.linalg import eigsh

from linecad.arrays import Bool, Float, Int

WAYS = 2  # eigenvectors along which a cut is looked for
DENSE = 100  # nodes, up to which a dense solver is faster
SHIFT = 1e-3  # beside the eigenvalue 0, so that the matrix can be factored


def weakest_cut(count: int, edges: Int, weight: Float, least: int) -> tuple[Bool, float] | None:
    """Part `count` nodes in two of `least` or more: a mask (N,) of the one, and the conductance of the cut.

    The nodes hang together by `edges` (E, 2) of positive `weight` (E,). Conductance is the weight of the edges that are
    cut over all of those that end on the lighter side, 0 to 1. It is the least of all cuts that a threshold on one of
    the first eigenvectors of the normalised Laplacian makes (Shi and Malik, Normalized cuts and image segmentation,
    2000), not of all cuts at all. None for fewer than twice `least` nodes.
    """
    if count < 2 * max(least, WAYS):
        return None
    volume = np.bincount(edges.ravel(), np.repeat(weight, 2), count)
    best = (np.inf, np.zeros(count, bool))
    for way in _slowest_ways(count, edges, weight / np.sqrt(volume[edges].prod(axis=1))):
        order = np.argsort(way / np.sqrt(volume), kind="stable")
        place = np.argsort(order)
        before = np.cumsum(volume[order])
        cut = before - 2 * np.cumsum(np.bincount(place[edges].max(axis=1), weight, count))
        conductance = (cut / np.minimum(before, before[-1] - before).clip(1e-12))[least - 1 : count - least]
        at = int(conductance.argmin())
        if conductance[at] < best[0]:
            side = np.zeros(count, bool)
            side[order[: at + least]] = True
            best = (float(conductance[at]), side)
    return best[1], best[0]


def _slowest_ways(count: int, edges: Int, link: Float) -> Float:
    """(WAYS, N): eigenvectors of the normalised Laplacian with off-diagonal entries -`link` (E,), after the first."""
    if count <= DENSE:
        matrix = np.eye(count)
        np.subtract.at(matrix, tuple(edges.T), link)
        np.subtract.at(matrix, tuple(edges.T[::-1]), link)
        return np.asarray(eigh(matrix, subset_by_index=(1, WAYS), overwrite_a=True, check_finite=False)[1].T)
    both = np.concatenate([edges, edges[:, ::-1]])
    laplacian = identity(count) - csr_matrix((np.r_[link, link], tuple(both.T)), (count, count))
    # A fixed start, so that the same graph has the same cut.
    start = np.linspace(1.0, 2.0, count)
    found = eigsh(laplacian.tocsc(), k=WAYS + 1, sigma=-SHIFT, v0=start)[1]
    return np.asarray(found.T[1:])
