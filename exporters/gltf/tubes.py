"""Lines as thin closed tubes, for programs that show surfaces only."""

import numpy as np

from linecad.arrays import Float, Int

_SIDES = 6  # round enough for a tube of a few pixels


def build_tubes(ends: Float, radius: float) -> tuple[Float, Int, Float]:
    """Vertices (12 N, 3), triangles (20 N, 3) and outward vertex normals of a tube about each of N lines.

    `ends` is (N, 2, 3), no line of no length, in the unit of `radius`, half the distance between opposite corners.
    Each tube is closed and has its own vertices: six about the start of the line, then six about its end.
    """
    direction = ends[:, 1] - ends[:, 0]
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    away = np.eye(3)[np.abs(direction).argmin(axis=1)]  # any vector that does not run along the line
    right = np.cross(direction, away)
    right /= np.linalg.norm(right, axis=1)[:, None]
    up = np.cross(direction, right)
    angle = np.arange(_SIDES) * (2.0 * np.pi / _SIDES)
    ring = np.cos(angle)[:, None] * right[:, None] + np.sin(angle)[:, None] * up[:, None]  # (N, 6, 3)
    vertices = ends[:, :, None] + radius * ring[:, None]  # (N, 2, 6, 3)
    normals = np.stack([ring, ring], axis=1)
    first = 2 * _SIDES * np.arange(len(ends))[:, None, None]
    triangles = first + _triangles()
    return vertices.reshape(-1, 3), triangles.reshape(-1, 3), normals.reshape(-1, 3)


def _triangles() -> Int:
    """(20, 3) the triangles of one tube, counter-clockwise from outside."""
    here = np.arange(_SIDES)
    after = (here + 1) % _SIDES
    sides = [
        np.column_stack([here, after, after + _SIDES]),
        np.column_stack([here, after + _SIDES, here + _SIDES]),
    ]
    fan = np.arange(1, _SIDES - 1)
    start = np.column_stack([np.zeros_like(fan), fan + 1, fan])
    end = _SIDES + np.column_stack([np.zeros_like(fan), fan, fan + 1])
    return np.concatenate([*sides, start, end])
