"""In which level direction a roof runs, by the segments of its own eave and ridge.

A wall has the nearest frame of the photo, from which its house may be turned by some degrees. What ends a roof tells
its slope only together with the direction of its eave: seen nearly straight on, a turn of 1 degree is 2 or 3 of slope.
But eave and ridge are long, and level: each segment meets the horizon where the roof runs.
"""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Float
from linecad.geometry import lengths, segment_coordinates
from linecad.model.regions.profiles import Profile, Shown, about_upright
from linecad.ties.depth_samples import weighted_median

NEAR = 4.0  # px at a width of NORMAL_WIDTH, from the middle of a segment to the line that it is of
ASTRAY = np.sin(np.radians(2.5))  # of it, against that line
LEAST_PIECE = 0.01  # of the photo's width, of a segment
SHIFT = 0.25  # px at that width, by which an end of a segment errs across it
FURTHEST = np.radians(10.0)  # from the wall's direction to that of its roof
UNKNOWN = np.radians(3.0)  # error of the wall's direction where no segment tells a better one
LEAST_ERROR = np.radians(0.3)


@dataclass(frozen=True, eq=False)
class Bearing:
    """The level direction of an eave."""

    turn: float  # rad, from that of its wall, from the first level direction of the world to the second
    error: float  # rad

    def turned(self, vector: Float, more: float = 0.0) -> Float:
        """A direction (3,) of the wall, turned as the roof is, and by `more`, rad."""
        turned: Float = about_upright(self.turn + more) @ vector
        return turned


def bearing_of(profile: Profile, raw: Float, shown: Shown) -> Bearing:
    """The direction of the eave and the ridge of a profile, by segments `raw` (N, 2, 2) px of any direction.

    The weighted median of what they tell; the wall's own, where that agrees or they tell less than it.
    """
    columns = list(profile.ends)
    own = np.concatenate([_on(line[columns], raw, shown) for line in (profile.eave, profile.ridge)])
    across = np.diff(own, axis=1)[:, 0, ::-1] * [1.0, -1.0]
    across *= SHIFT * shown.pixel / np.maximum(lengths(across), 1e-9)[:, None]
    turns = _turns(own, profile, shown)
    errors = np.abs(_wrapped(_turns(own + np.stack([across, -across], axis=1), profile, shown) - turns))
    told = (np.abs(turns) < FURTHEST) & (errors < UNKNOWN)
    turns, weight = turns[told], 1 / np.maximum(errors[told], LEAST_ERROR)
    if len(turns) == 0:
        return Bearing(0.0, UNKNOWN)
    turn = weighted_median(turns, weight)
    scatter, least = weighted_median(np.abs(turns - turn), weight), 1 / np.sqrt((weight**2).sum())
    error = float(np.hypot(scatter, max(least, LEAST_ERROR)))
    if error > UNKNOWN:
        return Bearing(0.0, UNKNOWN)
    return Bearing(0.0 if abs(turn) < error else turn, error)


def _on(line: Float, raw: Float, shown: Shown) -> Float:
    """Those of the segments that lie on a line (2, 2) px, along most of their length."""
    size = float(lengths(line[1] - line[0]))
    places, off = segment_coordinates(raw, line)
    places = np.sort(places, axis=1)
    length = lengths(raw[:, 1] - raw[:, 0])
    inside = np.clip(places, 0, size)
    on = (np.abs(off.mean(axis=1)) < NEAR * shown.pixel) & (np.abs(off[:, 1] - off[:, 0]) < ASTRAY * length)
    on &= inside[:, 1] - inside[:, 0] > np.minimum(length, size) / 2
    return np.asarray(raw[on & (length >= LEAST_PIECE * shown.view.camera.width)])


def _turns(segments: Float, profile: Profile, shown: Shown) -> Float:
    """(N,) rad, from the direction of the wall to the level one that each segment (N, 2, 2) px shows."""
    rays, wall = shown.rays(segments), profile.wall.direction
    planes = np.cross(rays[:, 0], rays[:, 1])
    turn = np.arctan2(planes[:, 0], -planes[:, 1]) - np.arctan2(wall[1], wall[0])
    return _wrapped(turn)


def _wrapped(angle: Float) -> Float:
    """Angles between lines, rad, of the half turn around 0."""
    return (angle + np.pi / 2) % np.pi - np.pi / 2
