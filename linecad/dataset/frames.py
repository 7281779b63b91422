"""The horizontal frames of a scene whose walls stand at several angles, and the world turned to the first of them."""

from dataclasses import replace

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.dataset.truth import NOTHING, TrueFrames, Truth, planes_of
from linecad.geometry import rotation_about

QUARTER = np.pi / 2  # rad; a frame turned by it is the same frame
SAME_FRAME = np.radians(1.0)  # between two directions of one frame
BINS = 900  # of a quarter turn, in which the most frequent directions are looked for
ROUNDS = 20  # of finding the mean of a frame and what is near it
BROAD = 0.3  # m; what is narrower has no frame of its own
UNSEEN = 1e-6  # px for each m2: what no pixel shows counts last


def with_frames(truth: Truth, is_building: Bool, rounding: float) -> Truth:
    """The truth with its frames, in the world of the frame that most pixels of walls show.

    `is_building` (Q,) says which quads may found a frame, `rounding`, m, how far corners may lie off their planes.
    """
    normal, _ = planes_of(truth.quads)
    breadth, area = _breadth(truth.quads)
    off = np.maximum(SAME_FRAME, 2 * rounding / np.maximum(breadth, 1e-9))
    slope = _snapped(np.arccos(np.clip(np.abs(normal[:, 2]), 0, 1)), off)
    pixels = np.bincount(truth.ids[truth.ids != NOTHING], minlength=len(slope))
    turn = np.arctan2(normal[:, 1], normal[:, 0])
    founds = is_building & (slope == QUARTER) & (breadth >= BROAD)
    angles = _find_turns(turn[founds], (pixels + UNSEEN * area)[founds])
    along = truth.edges[:, 1] - truth.edges[:, 0]
    length = np.linalg.norm(along, axis=1)
    edge_off = np.maximum(SAME_FRAME, 2 * rounding / length)
    edge_slope = _snapped(np.arcsin(np.clip(np.abs(along[:, 2]) / length, 0, 1)), edge_off)
    main = float(angles[0]) if len(angles) else 0.0
    frames = TrueFrames(
        turn=_folded(angles - main),
        quad=np.where(slope == 0, NOTHING, _nearest(turn, angles, off)),
        quad_slope=slope,
        edge=np.where(edge_slope == QUARTER, NOTHING, _nearest(np.arctan2(along[:, 1], along[:, 0]), angles, edge_off)),
        edge_slope=edge_slope,
    )
    return replace(_turned(truth, main), frames=frames)


def _breadth(quads: Float) -> tuple[Float, Float]:
    """Distances (Q,), m, between the long sides of parallelograms or the halves of them, and areas (Q,), m2."""
    first, second = quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0]
    area = np.linalg.norm(np.cross(first, second), axis=1)
    longest = np.maximum(np.linalg.norm(first, axis=1), np.linalg.norm(second, axis=1))
    return area / longest, area


def _snapped(slope: Float, off: Float) -> Float:
    """Slopes (N,), rad, with those that are level or upright within `off` (N,) made so."""
    upright = np.where(QUARTER - slope <= off, QUARTER, slope)
    level: Float = np.where(slope <= off, 0.0, upright)
    return level


def _folded(angle: Float) -> Float:
    """Angles of frames, rad, from -pi/4 to pi/4."""
    folded: Float = (angle + QUARTER / 2) % QUARTER - QUARTER / 2
    return folded


def _find_turns(turn: Float, weight: Float) -> Float:
    """The angles (F,), rad, of the frames of directions (N,), heaviest first, each the mean of what is near a peak."""
    left = weight > 0
    step = QUARTER / BINS
    reach = round(SAME_FRAME / step)
    found = []
    while left.any():
        place = (turn[left] % QUARTER / step).astype(np.int64) % BINS
        total = np.bincount(place, weight[left], minlength=BINS)
        around = sum(np.roll(total, shift) for shift in range(-reach, reach + 1))
        peak = (int(np.argmax(around)) + 0.5) * step
        own = left & (np.abs(_folded(turn - peak)) <= SAME_FRAME + step)
        for _ in range(ROUNDS):
            # What is within SAME_FRAME of the peak need not be so of the mean; what is not founds another frame.
            angle = peak + float(np.average(_folded(turn[own] - peak), weights=weight[own]))
            again = left & (np.abs(_folded(turn - angle)) <= SAME_FRAME)
            if not again.any() or (again == own).all():
                break
            own = again
        found.append((float(weight[own].sum()), angle))
        left &= ~own
    return np.array([angle for _, angle in sorted(found, reverse=True)])


def _nearest(turn: Float, angles: Float, off: Float) -> Int:
    """Which of the frames (F,) directions (N,) belong to, at most `off` (N,) away; NOTHING where to none."""
    if len(angles) == 0:
        return np.full(len(turn), NOTHING)
    away = np.abs(_folded(turn[:, None] - angles))
    nearest: Int = np.where(away.min(axis=1) <= off, away.argmin(axis=1), NOTHING)
    return nearest


def _turned(truth: Truth, angle: float) -> Truth:
    """The truth in a world whose axes are turned by `angle`, and by quarters until y points away from the camera."""
    away = np.arctan2(truth.rotation[2, 1], truth.rotation[2, 0]) - np.pi / 2
    angle += QUARTER * round((away - angle) / QUARTER)
    turn = rotation_about(np.array([0.0, 0.0, -angle]))
    openings = truth.openings
    if openings is not None:
        openings = replace(openings, corners=openings.corners @ turn.T)
    return replace(
        truth,
        rotation=truth.rotation @ turn.T,
        quads=truth.quads @ turn.T,
        edges=truth.edges @ turn.T,
        openings=openings,
    )
