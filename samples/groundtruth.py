"""Ground truth of a rendered scene: true visible edges and points with depth, in the camera frame."""

from typing import Any

import numpy as np

from modelling import Face, Float, Model
from raycaster import View, first_hits

SAMPLE_STEP = 2.0  # px between the points of an edge that are tested for being seen
SHORTEST = 10.0  # px, of the edges that are listed
HIDDEN = 1e-4  # relative; a point is hidden when something is closer by more
FACE_POINTS = 200
LINE_POINTS = 200
NEAR = 0.3  # m, edges are cut off before this depth


def ground_truth(model: Model, view: View, seed: int) -> dict[str, Any]:
    """What the truth file holds about a scene, beside the name of the photo."""
    rng = np.random.default_rng(seed)
    pixels, ends, labels = _visible_edges(model, view)
    points, on_line = _points(model.faces, view, ends, rng)
    return {
        "width": view.width,
        "height": view.height,
        "K": view.matrix.tolist(),
        "R_cam_from_manhattan": view.rotation.round(9).tolist(),
        "camera_position": view.position.tolist(),
        "lines": [
            {
                "p": pixel[0].round(2).tolist(),
                "q": pixel[1].round(2).tolist(),
                "P_cam": end[0].round(4).tolist(),
                "Q_cam": end[1].round(4).tolist(),
                "label": int(label),
            }
            for pixel, end, label in zip(pixels, ends, labels, strict=True)
        ],
        "columns": ["u_px", "v_px", "X_m", "Y_m", "Z_m"],
        "points": points,
        "on_line": on_line,
    }


def _image(points: Float, view: View) -> Float:
    """Undistorted pixels (..., 2) of points (..., 3) in the camera frame."""
    image = points @ view.matrix.T
    return image[..., :2] / image[..., 2:]


def _visible_edges(model: Model, view: View) -> tuple[Float, Float, Float]:
    """Pixels (N, 2, 2), camera-frame ends (N, 2, 3) and axes (N,) of the visible pieces of all edges."""
    world, axes = model.edges()
    found: list[tuple[Float, int]] = []
    ends = view.to_camera(world.reshape(-1, 3)).reshape(-1, 2, 3)
    stretches = []
    for (first, second), axis in zip(ends, axes, strict=True):
        cut = _inside_photo(first, second, view)
        if cut is None:
            continue
        pixel = _image(cut, view)
        count = int(np.ceil(np.linalg.norm(pixel[1] - pixel[0]) / SAMPLE_STEP)) + 1
        if count < SHORTEST / SAMPLE_STEP:
            continue
        # Points that are evenly spaced in the image: their inverse depths are, too.
        share = np.linspace(0, 1, count)[:, None]
        weight = share / cut[1, 2] / ((1 - share) / cut[0, 2] + share / cut[1, 2])
        stretches.append((cut[0] + weight * (cut[1] - cut[0]), int(axis)))
    points = np.concatenate([stretch for stretch, _ in stretches])
    depth, _ = first_hits(model.faces, view.position, points / points[:, 2:] @ view.rotation)
    seen = depth >= points[:, 2] * (1 - HIDDEN)
    start = 0
    for stretch, axis in stretches:
        flags = np.concatenate([[False], seen[start : start + len(stretch)], [False]])
        start += len(stretch)
        changes = np.flatnonzero(flags[1:] != flags[:-1])
        found += [(stretch[[first, last - 1]], axis) for first, last in changes.reshape(-1, 2)]
    pieces = np.array([piece for piece, _ in found])
    pixels = _image(pieces, view)
    long = np.linalg.norm(pixels[:, 1] - pixels[:, 0], axis=1) >= SHORTEST
    return pixels[long], pieces[long], np.array([axis for _, axis in found])[long]


def _inside_photo(first: Float, second: Float, view: View) -> Float | None:
    """The part (2, 3) of a segment in the camera frame that lies before the camera and inside the photo."""
    low, high = 0.0, 1.0
    inverse = np.linalg.inv(view.matrix)
    left, top = (inverse @ [0, 0, 1])[:2]
    right, bottom = (inverse @ [view.width - 1, view.height - 1, 1])[:2]
    # Each row (a, b, c, d) keeps the points with a X + b Y + c Z >= d.
    for plane in ((0, 0, 1, NEAR), (1, 0, -left, 0), (-1, 0, right, 0), (0, 1, -top, 0), (0, -1, bottom, 0)):
        here = np.dot(plane[:3], first) - plane[3]
        there = np.dot(plane[:3], second) - plane[3]
        if here < 0 and there < 0:
            return None
        if here < 0:
            low = max(low, here / (here - there))
        elif there < 0:
            high = min(high, here / (here - there))
    if low >= high:
        return None
    return np.stack([first + low * (second - first), first + high * (second - first)])


def _points(
    faces: list[Face], view: View, ends: Float, rng: np.random.Generator
) -> tuple[list[list[float]], list[int]]:
    """Rows u, v, X, Y, Z of points on faces and on visible edges; and the numbers of those on edges."""
    pixels = rng.uniform((0, 0), (view.width - 1, view.height - 1), (FACE_POINTS, 2))
    rays = view.rays(pixels)
    depth, index = first_hits(faces, view.position, rays)
    on_faces = (rays @ view.rotation.T * depth[:, None])[index >= 0]
    chosen = rng.integers(0, len(ends), LINE_POINTS)
    share = rng.uniform(0.02, 0.98, (LINE_POINTS, 1))
    on_edges = ends[chosen, 0] * (1 - share) + ends[chosen, 1] * share
    points = np.concatenate([on_faces, on_edges])
    rows = np.column_stack([_image(points, view).round(2), points.round(4)])
    return rows.tolist(), list(range(len(on_faces), len(points)))
