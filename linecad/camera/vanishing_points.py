"""Segments to the Manhattan frame: the search for three orthogonal vanishing points, and the names of the axes."""

import numpy as np

from linecad.arrays import Float, Int
from linecad.errors import ReconstructionError
from linecad.geometry import DIAGONAL_35MM, angles_to, plane_normals, rotation_about
from linecad.line_graph import ManhattanFrame, Segments

MIN_SEGMENTS = 12
SEARCH_ANGLE = np.radians(1.25)  # the residual beyond which a segment has no say in the search
INLIER_ANGLE = np.radians(2.0)  # the residual up to which a segment counts as explained and has a say
ERROR_FLOOR = 1e-4  # rad; no axis is known better than that
DRAWS = 3000  # random triples of segments
BATCH = 200  # triples drawn at once
SINES = 2**16  # looked at together when triples are scored: more would not fit into a processor's cache
MIN_LENGTH = 12.0  # px; the direction of shorter segments is mostly noise
MAX_SCORED = 1500  # the longest segments decide; more cost time and change nothing
REFINEMENTS = 30
STEP_END = 1e-9  # rad; smaller steps end the refinement
LEAST_SPREAD = 1e-3  # rad between the planes of lines that are to give a vanishing point
SECOND_DIRECTION_SHARE = 0.02  # of the explained length that the second and third axis must add

DEFAULT_FOCAL_DIAGONALS = 28.0 / DIAGONAL_35MM  # 28 mm equivalent: a phone's or compact's main lens


def find_frame(segments: Segments, K: Float, seed: int = 0) -> ManhattanFrame:
    """The rotation whose three orthogonal vanishing points explain the most segment length.

    Two segments give one vanishing point (the cross product of the normals of their interpretation planes), a third
    one gives the second, their cross product the third; the best triple is refined by Gauss-Newton on the rotation.
    Raises ReconstructionError with fewer than MIN_SEGMENTS segments or when all run in one direction.
    """
    need_segments(segments)
    return name_frame(segments, K, best_axes(segments, K, search_axes(longest(segments), K, DRAWS, seed)))


def fit_frame(ends: Float, label: Int, K: Float, segments: Segments) -> ManhattanFrame:
    """The rotation whose axes fit lines (M, 2, 2) px of known directions (M,) best, in least squares of the angles.

    Lines of one label are parallel in space; two of one label and one of another determine the frame. The axes are
    named by their directions, whatever the labels were. Raises ReconstructionError when the lines are too few or point
    to one place. `segments` only tell how much of the photo the frame explains.
    """
    normals = plane_normals(ends, K)
    most = int(np.bincount(label, minlength=3).argmax())
    if (label == most).sum() < 2 or (label != most).sum() < 1:
        raise ReconstructionError(
            f"{len(label)} lines were drawn for the frame; draw two along one direction and one along another at least"
        )
    spread, directions = np.linalg.eigh(normals[label == most].T @ normals[label == most])
    if spread[1] < LEAST_SPREAD**2:
        raise ReconstructionError(
            "the lines drawn along one direction lie on one line of the photo; draw them further apart"
        )
    main = directions[:, 0]
    second_label = int(np.bincount(label[label != most], minlength=3).argmax())
    chosen = normals[label == second_label]
    # Of all directions across the first, the one that lies best in the planes of the second.
    across = np.linalg.svd(main[None])[2][1:]
    second = np.linalg.eigh((chosen @ across.T).T @ (chosen @ across.T))[1][:, 0] @ across
    axes = np.empty((3, 3))
    axes[most], axes[second_label] = main, second
    axes[3 - most - second_label] = np.cross(main, second)
    for _ in range(REFINEMENTS):
        own = axes[label]
        error = (normals * own).sum(axis=1)
        jacobian = np.cross(own, normals)
        step = -np.linalg.pinv(jacobian, rcond=1e-9) @ error
        axes = axes @ rotation_about(step).T
        if np.linalg.norm(step) < STEP_END:
            break
    return name_frame(segments, K, axes)


def default_focal(width: int, height: int) -> float:
    """The focal length, px, that is assumed when nothing tells it."""
    return float(DEFAULT_FOCAL_DIAGONALS * np.hypot(width, height))


def need_segments(segments: Segments) -> None:
    """ReconstructionError with fewer than MIN_SEGMENTS segments."""
    if len(segments) < MIN_SEGMENTS:
        raise ReconstructionError(
            f"{len(segments)} straight segments found, at least {MIN_SEGMENTS} are needed; "
            "try a larger or sharper photo"
        )


def longest(segments: Segments, most: int = MAX_SCORED) -> Float:
    """Ends (N, 2, 2) of the segments that decide about the frame, the longest first."""
    order = np.argsort(-segments.length, kind="stable")[:most]
    decisive = order[segments.length[order] >= MIN_LENGTH]
    if len(decisive) < MIN_SEGMENTS:
        decisive = order
    return segments.ends[decisive]


def _score(ends: Float, weight: Float, K: Float, triples: Float) -> Float:
    """How well axis triples (T, 3, 3), rows in the camera frame, explain the segments (T,).

    Per axis the explained length, weighted by a truncated square of the residual; then the sum of the square roots.
    The root matters: with the plain sum, one direction that gathers the segments of two beats the right frame.
    """
    some = max(1, SINES // (3 * len(ends)))
    return np.concatenate(
        [_score_of_some(ends, weight, K, triples[first : first + some]) for first in range(0, len(triples), some)]
    )


def _score_of_some(ends: Float, weight: Float, K: Float, triples: Float) -> Float:
    """The same of few triples."""
    sines = angles_to(ends, (triples @ K.T).transpose(1, 0, 2).reshape(-1, 3)).reshape(3, len(triples), -1)
    least = np.minimum(np.minimum(sines[0], sines[1]), sines[2])
    residual = least / np.sin(SEARCH_ANGLE)
    explained = np.maximum(1 - residual * residual, 0) * weight
    is_first = sines[0] == least
    is_second = (sines[1] == least) & ~is_first
    score = np.zeros(len(triples))
    for own in (is_first, is_second, ~(is_first | is_second)):
        score += np.sqrt((explained * own).sum(axis=1))
    return score


def search_axes(ends: Float, K: Float, draws: int, seed: int = 0) -> Float:
    """The best of many random axis triples (3, 3), rows in the camera frame, for segments (N, 2, 2) px."""
    rng = np.random.default_rng(seed)
    weight = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    normals = plane_normals(ends, K)
    best, best_score = np.eye(3), -1.0
    for _ in range(max(draws // BATCH, 1)):
        pick = rng.choice(len(ends), (BATCH, 3), p=weight / weight.sum())
        first = np.cross(normals[pick[:, 0]], normals[pick[:, 1]])
        size = np.linalg.norm(first, axis=1)
        usable = size > 1e-6
        first = first[usable] / size[usable, None]
        second = np.cross(first, normals[pick[usable, 2]])
        size = np.linalg.norm(second, axis=1)
        first, second = first[size > 1e-6], second[size > 1e-6] / size[size > 1e-6, None]
        triples = np.stack([first, second, np.cross(first, second)], axis=1)
        if not len(triples):
            continue
        scores = _score(ends, weight, K, triples)
        if scores.max() > best_score:
            best, best_score = triples[scores.argmax()], float(scores.max())
    return best


def best_axes(segments: Segments, K: Float, *starts: Float) -> Float:
    """The axes (3, 3), rows in the camera frame, that explain most of the segments after refinement from each start."""
    ends = longest(segments)
    refined = np.array([_refine(ends, K, start) for start in starts])
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    best: Float = refined[_score(ends, length, K, refined).argmax()]
    return best


def _refine(ends: Float, K: Float, axes: Float) -> Float:
    """Gauss-Newton on the rotation: each interpretation plane should contain the axis of its segment.

    Takes segments (N, 2, 2) px and axes (3, 3), rows in the camera frame, near their place.
    """
    normals = plane_normals(ends, K)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    for _ in range(REFINEMENTS):
        sines = angles_to(ends, axes @ K.T)
        label = sines.argmin(axis=0)
        own = axes[label]
        error = (normals * own).sum(axis=1)
        say = _say(length, label, sines.min(axis=0), error)
        jacobian = np.cross(own, normals)
        system = (jacobian * say[:, None]).T @ jacobian + 1e-9 * np.eye(3)
        step = np.linalg.solve(system, -(jacobian * say[:, None]).T @ error)
        axes = axes @ rotation_about(step).T
        if np.linalg.norm(step) < STEP_END:
            break
    return axes


def _say(weight: Float, label: Int, residual: Float, error: Float) -> Float:
    """Weight (N,) of each segment in the least squares: its length, less towards INLIER_ANGLE, per axis scaled by
    the noise of that axis (effective number of segments over their mean square error)."""
    say = weight * np.clip(1 - (residual / np.sin(INLIER_ANGLE)) ** 2, 0, None)
    for axis in range(3):
        own = label == axis
        total = say[own].sum()
        if total > 0:
            noise = say[own] @ error[own] ** 2 / total + ERROR_FLOOR**2
            say[own] *= total / (say[own] ** 2).sum() / noise
    return np.asarray(say)


def name_frame(segments: Segments, K: Float, axes: Float) -> ManhattanFrame:
    """Axes (3, 3), rows, as a frame with deterministic names: z up, x most left to right, y away (linecad.scene)."""
    up = int(np.abs(axes[:, 1]).argmax())
    z = axes[up] * -np.sign(axes[up, 1])
    level = [axis for axis in range(3) if axis != up]
    across = min(level, key=lambda axis: float(abs(axes[axis, 2])))
    x = axes[across] * np.sign(axes[across, 0])
    rotation = np.column_stack([x, np.cross(z, x), z])
    u, _, v = np.linalg.svd(rotation)
    rotation = u @ v

    sines = angles_to(segments.ends, (K @ rotation).T)
    residual = sines.min(axis=0)
    length = segments.length
    points_to = sines < np.sin(INLIER_ANGLE)
    near = points_to.any(axis=0)
    # Only what the main axis cannot explain speaks for a second one: through any single segment of the main axis
    # there is a plane, and the search always finds a second axis in it.
    main = (points_to @ length).argmax()
    if length[near & ~points_to[main]].sum() < SECOND_DIRECTION_SHARE * length[near].sum():
        raise ReconstructionError(
            "all straight segments run in one direction, two Manhattan directions are needed; "
            "take the photo from a corner so that two sides of the scene show"
        )
    rms = float(np.sqrt(np.average(residual[near] ** 2, weights=length[near])))
    return ManhattanFrame(rotation, rms, float(length[near].sum() / length.sum()))
