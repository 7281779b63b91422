"""The likelihood of one upright and several horizontal frames, and the most likely ones near a start.

A *horizontal frame* is two level directions at right angles; all share the upright. The model of a segment is that of
`linecad.camera.joint_fit`: it runs along the upright, along one of the directions, or along none, and which is weighed,
not decided. The upright may move with the frames, the camera is known.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import gamma

import numpy as np

from linecad.arrays import Float
from linecad.camera.joint_fit import FREEDOM, Angles, Places, View, angles_against, student
from linecad.geometry import rotation_about

GRID = np.radians(np.arange(0.0, 90.0, 0.5))  # turns at which a further frame is looked for
FIRST_SHARE = 0.05  # of the segments, of either direction of a frame that is tried
DENSITIES = 2**16  # looked at together on the grid: more would not fit into a processor's cache
GRID_ROUNDS = 6  # of expectation maximisation of the shares on the grid
SHARE_ROUNDS = 10
ROUNDS = 30  # of the whole fit
STEP_END = 1e-5  # rad; smaller steps end the fit
LARGEST_STEP = 0.1  # rad
LEAST_SHARE = 1e-4


@dataclass(frozen=True, eq=False)
class Noise:
    """How far segments lie off the directions that they run along: Student's t, and walls off their frame."""

    freedom: float  # degrees of freedom: the more there are, the seldomer a segment errs by far more than usual
    scale: float  # times that of `joint_fit`
    turn: float  # rad, by which the level directions of real walls lie off their frame
    upright: Float  # (3,) about which they are turned, in the camera frame

    def density(self, ratio: Float) -> Float:
        """Of Student's t."""
        freedom = self.freedom
        most = gamma((freedom + 1) / 2) / gamma(freedom / 2) / np.sqrt(freedom * np.pi)
        density: Float = most * (1 + ratio**2 / freedom) ** (-(freedom + 1) / 2)
        return density


@dataclass(frozen=True, eq=False)
class Observed:
    """Segments before a camera that is known."""

    ends: Float  # (N, 2, 2) px
    focal: float  # px
    center: Float  # (2,) px
    width: int
    height: int
    noise: Noise | None = None  # that of `joint_fit`

    @cached_property
    def _places(self) -> Places:
        return Places(self.ends)

    def against(self, directions: Float) -> Angles:
        """`angles_against` unit directions (M, 3) in the camera frame."""
        return angles_against(self._places, View(directions, self.focal, self.center), self.width, self.height)

    def density(self, directions: Float) -> Float:
        """Densities (M, N) of the segments along unit directions (M, 3) in the camera frame."""
        angles = self.against(directions)
        scale = self.scale(angles, directions)
        return self.student(angles.sine / scale) / scale

    @property
    def freedom(self) -> float:
        """Degrees of freedom of the angles."""
        return FREEDOM if self.noise is None else self.noise.freedom

    def student(self, ratio: Float) -> Float:
        """Density of angles over their scales."""
        return student(ratio) if self.noise is None else self.noise.density(ratio)

    def scale(self, angles: Angles, directions: Float) -> Float:
        """(M, N) rad, of the angles against unit directions (M, 3) in the camera frame."""
        if self.noise is None:
            return angles.scale
        K = View(directions, self.focal, self.center).matrix
        slope = angles.slope(np.cross(self.noise.upright, directions) @ K.T)
        scale: Float = np.hypot(self.noise.scale * angles.scale, self.noise.turn * slope)
        return scale


@dataclass(frozen=True, eq=False)
class Mixture:
    """An upright with K horizontal frames, and how likely they make the segments."""

    rotation: Float  # (3, 3) columns are x, y and the upright in the camera frame; turns are measured from x to y
    turns: Float  # (K,) rad about the upright
    share: Float  # (2 + 2 K,) of the segments: along the upright, the two directions of each frame, and none
    density: Float  # (N,) of each segment
    covariance: Float  # (2 + K, 2 + K) of the turns of the upright about x and y, and of `turns`

    @property
    def likelihood(self) -> float:
        """Its logarithm, nats."""
        return float(np.log(self.density).sum())

    @property
    def directions(self) -> Float:
        """(1 + 2 K, 3) the upright, then two level directions for each frame, in the camera frame."""
        return np.concatenate([self.rotation[:, 2][None], level_directions(self.rotation, self.turns)])

    def without(self, which: int) -> "Mixture":
        """A start for a fit without one frame."""
        places = [1 + 2 * which, 2 + 2 * which]
        share = np.delete(self.share, places)
        return replace(self, turns=np.delete(self.turns, which), share=share / share.sum())

    def with_frame(self, turn: float) -> "Mixture":
        """A start for a fit with one frame more."""
        left = 1 - 2 * FIRST_SHARE
        share = np.r_[self.share[:-1] * left, FIRST_SHARE, FIRST_SHARE, self.share[-1] * left]
        return replace(self, turns=np.r_[self.turns, turn], share=share)


def level_directions(rotation: Float, turns: Float) -> Float:
    """(2 K, 3) the two directions of each frame that is turned so (K,) against the columns of a rotation (3, 3)."""
    along = np.outer(np.cos(turns), rotation[:, 0]) + np.outer(np.sin(turns), rotation[:, 1])
    across = np.outer(np.cos(turns), rotation[:, 1]) - np.outer(np.sin(turns), rotation[:, 0])
    return np.stack([along, across], axis=1).reshape(-1, 3)


def fixed_mixture(seen: Observed, rotation: Float, turns: Float) -> Mixture:
    """The most likely shares of frames that stay where they are."""
    directions = np.concatenate([rotation[:, 2][None], level_directions(rotation, turns)])
    parts = np.vstack([seen.density(directions), np.full((1, len(seen.ends)), 1 / np.pi)])
    share = np.full(len(parts), 1 / len(parts))
    for _ in range(SHARE_ROUNDS):
        likely = share[:, None] * parts
        share = (likely / likely.sum(axis=0)).mean(axis=1)
    unknowns = 2 + len(turns)
    return Mixture(rotation, turns, share, share @ parts, np.zeros((unknowns, unknowns)))


def fit_mixture(seen: Observed, start: Mixture) -> Mixture:
    """The most likely mixture near a start, by Gauss-Newton steps on the upright and all turns together."""
    rotation, turns, share = start.rotation, start.turns, start.share
    for _ in range(ROUNDS):
        directions = np.concatenate([rotation[:, 2][None], level_directions(rotation, turns)])
        angles = seen.against(directions)
        sine, scale = angles.sine, seen.scale(angles, directions)
        likely = share[:, None] * np.vstack(
            [seen.student(sine / scale) / scale, np.full((1, len(seen.ends)), 1 / np.pi)]
        )
        density = likely.sum(axis=0)
        belongs = likely / density
        share = np.maximum(belongs.mean(axis=1), LEAST_SHARE)
        share = share / share.sum()
        say = belongs[:-1] * (seen.freedom + 1) / (seen.freedom + (sine / scale) ** 2) / scale**2
        changes = [np.cross(rotation[:, axis], directions) for axis in range(2)]
        for number in range(len(turns)):
            change = np.zeros_like(directions)
            own = slice(1 + 2 * number, 3 + 2 * number)
            change[own] = np.cross(rotation[:, 2], directions[own])
            changes.append(change)
        K = View(directions, seen.focal, seen.center).matrix
        slope = np.stack([angles.slope(change @ K.T) for change in changes])
        flat = slope.reshape(len(slope), -1)
        system = (flat * say.ravel()) @ flat.T + 1e-9 * np.eye(len(flat))
        inverse = np.linalg.inv(system)
        step = np.clip(-inverse @ (flat @ (say * sine).ravel()), -LARGEST_STEP, LARGEST_STEP)
        rotation = rotation_about(rotation[:, :2] @ step[:2]) @ rotation
        turns = turns + step[2:]
        if np.abs(step).max() < STEP_END:
            break
    return Mixture(rotation, turns, share, density, inverse)


def gains_on_grid(seen: Observed, mixture: Mixture) -> Float:
    """By how much, nats, one frame more at each turn of GRID makes the segments likelier; the others stay."""
    some = max(1, DENSITIES // (2 * len(seen.ends)))
    return np.concatenate([_gains(seen, mixture, GRID[first : first + some]) for first in range(0, len(GRID), some)])


def _gains(seen: Observed, mixture: Mixture, turns: Float) -> Float:
    """The same at some turns (T,)."""
    density = seen.density(level_directions(mixture.rotation, turns)) / mixture.density
    first, second = density[0::2], density[1::2]
    share = np.full((2, len(turns)), FIRST_SHARE / 2)
    for _ in range(GRID_ROUNDS):
        left = 1 - share.sum(axis=0)
        total = left[:, None] + share[0][:, None] * first + share[1][:, None] * second
        share = np.stack(
            [(own[:, None] * part / total).mean(axis=1) for own, part in zip(share, (first, second), strict=True)]
        )
    left = 1 - share.sum(axis=0)
    gains: Float = np.log(left[:, None] + share[0][:, None] * first + share[1][:, None] * second).sum(axis=1)
    return gains
