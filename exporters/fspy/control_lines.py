"""Pairs of lines in the photo that meet in a vanishing point at a good angle, as people would draw them."""

import numpy as np

from exporters.camera import vanishing_points
from linecad.arrays import Float
from linecad.line_graph import Segments
from linecad.scene import Camera

_CANDIDATES = 40  # the longest segments of an axis, of which a pair is chosen
_LEAST_ANGLE = 0.02  # sine; lines that are more parallel do not fix the point where they meet
_DRAWN_AT = ((0.2, 0.2), (0.8, 0.2), (0.2, 0.8), (0.8, 0.8), (0.5, 0.5))  # of the photo's size
_DRAWN_LENGTH = 0.2  # of the photo's shorter side


def find_control_lines(camera: Camera, rotation: Float, segments: Segments, axis: int) -> Float:
    """(2, 2, 2) px from the photo's corner: two segments exactly towards the axis's vanishing point.

    Of `segments` where two of the axis are long and meet at an angle, else lines across the photo.
    """
    goal = vanishing_points(camera, rotation)[axis]
    own = segments.ends[segments.axis == axis] + 0.5
    lengths = np.linalg.norm(own[:, 1] - own[:, 0], axis=1)
    own = own[np.argsort(-lengths, kind="stable")[:_CANDIDATES]]
    pair = _best_pair(_turned(own.mean(axis=1), np.linalg.norm(own[:, 1] - own[:, 0], axis=1), goal))
    if pair is not None:
        return pair
    size = np.array([camera.width, camera.height], float)
    middles = np.array(_DRAWN_AT) * size
    drawn = _turned(middles, np.full(len(middles), _DRAWN_LENGTH * size.min()), goal)
    widest = _best_pair(drawn, least_angle=0.0)
    assert widest is not None  # five points never lie on one line
    return widest


def _turned(middles: Float, lengths: Float, goal: Float) -> Float:
    """(N, 2, 2) segments of these middles (N, 2) and lengths (N,) that run exactly towards `goal`."""
    towards = goal - middles
    distance = np.linalg.norm(towards, axis=1)
    half = np.minimum(lengths / 2, distance / 2)  # a segment stops before its vanishing point
    reach = towards / np.maximum(distance, 1e-300)[:, None] * half[:, None]
    return np.stack([middles - reach, middles + reach], axis=1)


def _best_pair(segments: Float, least_angle: float = _LEAST_ANGLE) -> Float | None:
    """The two of (N, 2, 2) segments whose intersection is best defined: long ones at a wide angle."""
    along = segments[:, 1] - segments[:, 0]
    length = np.linalg.norm(along, axis=1)
    segments, along, length = (values[length > 1.0] for values in (segments, along, length))
    if len(segments) < 2:
        return None
    direction = along / length[:, None]
    sine = np.abs(direction[:, None, 0] * direction[None, :, 1] - direction[:, None, 1] * direction[None, :, 0])
    score = np.where(sine >= least_angle, sine * np.sqrt(length[:, None] * length[None]), -1.0)
    np.fill_diagonal(score, -1.0)
    if score.max() < 0:
        return None
    row, column = np.unravel_index(int(score.argmax()), score.shape)
    pair: Float = segments[[row, column]]
    return pair
