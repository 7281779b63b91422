"""The horizontal frames of a photo: one upright, and any number of pairs of level directions at right angles.

Houses of a street stand upright and are turned against each other. How many frames a photo has is told by what one
more gains in likelihood against what it costs, where segments of one wall do not count as independent.
"""

from dataclasses import dataclass, replace

import numpy as np

from linecad.arrays import Float, Int
from linecad.camera.frame_mixture import (
    GRID,
    Mixture,
    Noise,
    Observed,
    fit_mixture,
    fixed_mixture,
    gains_on_grid,
    level_directions,
)
from linecad.camera.joint_fit import USUAL_TURN, View
from linecad.camera.vanishing_points import longest, name_frame
from linecad.geometry import plane_normals
from linecad.line_graph import ManhattanFrame, Segments
from linecad.lines.segments import label_angle
from linecad.scene import Camera

TOGETHER = 2.0  # segments that count as one: those of one wall share what is wrong with it
FRAME_PARAMETERS = 3  # its turn and two shares
FRAME_COST = 5.0  # nats beyond that: one of about a hundred turns is the best by chance
APART = 2.0  # standard errors of the difference; frames nearer to each other are one
LOOKED_APART = np.radians(1.0)  # from a known frame, where a further one is looked for
SPLIT = np.radians(1.5)  # beside a frame that may lie in the middle of two
NEAREST = np.radians(1.8)  # the axes of one frame may lie a degree off it each
LARGEST_MOVE = np.radians(3.0)  # of the single frame, a mean of several: so far its lines were gathered
WEDGE = np.radians(1.0)  # of planes through one direction
MOST_OF_WEDGE = 5.0  # nats
MOST_FRAMES = 8
# Where there are several frames, lines that are a few scales off one belong to another: tails as long as those that
# find the camera would leave them where they are (docs/decisions/0095).
FREEDOM_OF_SEVERAL = 4.0
SCALE_OF_SEVERAL = 0.9
TURN_OF_SEVERAL = np.radians(0.2)
QUARTER = np.pi / 2
LEAST_SHARE = 0.05  # of the segment length; shadows of a window and wings at an odd angle made frames of 2 to 4 %
LARGEST_ERROR = np.radians(0.5)  # of a turn; a tenth of what neighbours in a street are usually turned


@dataclass(frozen=True)
class HorizontalFrame:
    """Two level directions at right angles."""

    turn: float  # rad in (-pi / 4, pi / 4], about the upright against the main frame, from its x towards its y
    error: float  # rad, standard error of the turn; of the main frame that of its own direction
    share: float  # of the segment length that runs along its two directions, 0 to 1
    evidence: float  # nats: by how much less likely the segments are without it, the others as they are


@dataclass(frozen=True, eq=False)
class HorizontalFrames:
    """All horizontal frames of a photo, the one with the most evidence first: its axes are x and y of the world."""

    main: ManhattanFrame
    frames: tuple[HorizontalFrame, ...]  # one or more, by falling evidence; the turn of the first is 0
    shares: Float  # (3 + 2 (K - 1) + 1,) of the segments along each of `directions`, and along none

    @property
    def further(self) -> tuple[HorizontalFrame, ...]:
        """All but the main one."""
        return self.frames[1:]

    @property
    def directions(self) -> Float:
        """(3 + 2 (K - 1), 3) unit vectors in the camera frame: x, y, z of the main frame, then two for each further."""
        turns = np.array([frame.turn for frame in self.further])
        return np.concatenate([self.main.rotation.T, level_directions(self.main.rotation, turns)])

    @property
    def sound(self) -> "HorizontalFrames":
        """The main frame and those that lines of a scene are given to: seen on enough of the photo, and known well."""
        keep = [True, *(each.share >= LEAST_SHARE and each.error <= LARGEST_ERROR for each in self.further)]
        columns = np.repeat(keep, [3, *[2] * len(self.further)])
        shares = self.shares[:-1][columns]
        frames = tuple(frame for frame, is_kept in zip(self.frames, keep, strict=True) if is_kept)
        return HorizontalFrames(self.main, frames, np.append(shares, 1 - shares.sum()))

    @property
    def frame(self) -> ManhattanFrame:
        """The main frame with the turns of the others."""
        return replace(self.main, turns=tuple(frame.turn for frame in self.further))

    def labelled(self, segments: Segments, camera: Camera) -> Int:
        """(N,) the direction that each segment most likely runs along, as its row in `directions`, or -1 for none."""
        return _labelled(_observed(segments.ends, camera), self.directions, self.shares)


def find_horizontal_frames(raw: Segments, camera: Camera, frame: ManhattanFrame) -> HorizontalFrames:
    """The horizontal frames of segments `raw`, begun at a single Manhattan frame, which comes back where it suffices.

    Where there are more, the main frame is that with the most evidence, fitted together with the others. Long tails
    tell whether there are more that lines are given to, as clutter would make frames otherwise; shorter ones then tell
    which.
    """
    seen = _observed(longest(raw), camera)
    found = _search(raw, camera, frame, seen)
    if found is None:
        return only_frame(raw, camera, frame)
    if len(found.sound.frames) == 1:
        return found  # others that are small would only take lines away from it
    noise = Noise(FREEDOM_OF_SEVERAL, SCALE_OF_SEVERAL, TURN_OF_SEVERAL, found.main.rotation[:, 2])
    return _search(raw, camera, frame, replace(seen, noise=noise)) or found


def _search(raw: Segments, camera: Camera, frame: ManhattanFrame, seen: Observed) -> HorizontalFrames | None:
    """The horizontal frames of `seen`, the segments that decide, or None where the single frame suffices."""
    single = fixed_mixture(seen, frame.rotation, np.zeros(1))
    if _best_beside(seen, single)[1] < _cost(seen) / 2:
        return None
    upright = fixed_mixture(seen, frame.rotation, np.zeros(0))
    found = fit_mixture(seen, upright.with_frame(_best_beside(seen, upright)[0]))
    while len(found.turns) < MOST_FRAMES:
        larger = _one_more(seen, found)
        if larger is None:
            break
        found = larger
    while len(found.turns) > 1:
        without, evidence = _without_each(seen, found)
        least = int(evidence.argmin())
        if evidence[least] >= _cost(seen):
            return _several(raw, camera, seen, found) if _explains(found, frame) else None
        found = without[least]  # what came later explains what it did
    return None


def _observed(ends: Float, camera: Camera) -> Observed:
    return Observed(ends, camera.focal, camera.matrix[:2, 2], camera.width, camera.height)


def _cost(seen: Observed) -> float:
    """Nats, of independent segments, that a frame must gain: the criterion of Schwarz, and the choice of its turn."""
    return FRAME_PARAMETERS / 2 * float(np.log(max(len(seen.ends) / TOGETHER, 1.0))) + FRAME_COST


def _best_beside(seen: Observed, mixture: Mixture) -> tuple[float, float]:
    """The turn of the frame that gains most, away from those that are known, and its gain."""
    gains = gains_on_grid(seen, mixture) / TOGETHER
    for turn in mixture.turns:
        gains = np.where(np.abs(_within(GRID - turn)) < LOOKED_APART, -np.inf, gains)
    best = int(gains.argmax())
    return float(GRID[best]), float(gains[best])


def _one_more(seen: Observed, found: Mixture) -> Mixture | None:
    """The best mixture with one frame more than `found`, if it is worth its cost and stands apart."""
    turn, _ = _best_beside(seen, found)
    larger = _worth(seen, found, fit_mixture(seen, found.with_frame(turn)))
    if larger is not None:
        return larger
    for number, turn in enumerate(found.turns.tolist()):
        parted = found.without(number).with_frame(turn - SPLIT).with_frame(turn + SPLIT)
        larger = _worth(seen, found, fit_mixture(seen, parted))
        if larger is not None:
            return larger
    return None


def _worth(seen: Observed, smaller: Mixture, larger: Mixture) -> Mixture | None:
    """The larger mixture, if it gains more than it costs and the errors tell its frames apart."""
    if _evidence(seen, larger, smaller) < _cost(seen):
        return None
    errors = _errors(larger)
    for first in range(len(errors)):
        for second in range(first):
            apart = abs(float(_within(larger.turns[first] - larger.turns[second])))
            if apart < max(APART * np.hypot(errors[first], errors[second]), NEAREST):
                return None
    return larger


def _evidence(seen: Observed, larger: Mixture, smaller: Mixture) -> float:
    """By how much, nats, independent segments make one mixture likelier than another.

    Segments of one line of sight about the direction that they run along, such as the courses beside the verge of a
    gable, hit the horizon in one place whatever their slope: a WEDGE of them counts as MOST_OF_WEDGE at most.
    """
    gain = np.log(larger.density / smaller.density) / TOGETHER
    likely = larger.share[:-1, None] * seen.density(larger.directions)
    label = likely.argmax(axis=0)
    own = larger.directions[label]
    normals = plane_normals(seen.ends, View(own, seen.focal, seen.center).matrix)
    # Any fixed vector serves to tell one plane through the direction from another.
    first = np.cross(own, larger.rotation[:, 2] + 0.1 * larger.rotation[:, 0] + 0.2 * larger.rotation[:, 1])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(own, first)
    about = np.arctan2((normals * second).sum(axis=1), (normals * first).sum(axis=1)) % np.pi
    wedge = np.floor(about / WEDGE).astype(int) + label * int(np.ceil(np.pi / WEDGE))
    return float(np.minimum(np.bincount(wedge, gain), MOST_OF_WEDGE).sum())


def _errors(mixture: Mixture) -> Float:
    """Standard errors (K,) of the turns, rad, with what real walls are off their frame."""
    errors: Float = np.sqrt(TOGETHER * np.diag(mixture.covariance)[2:] + USUAL_TURN**2)
    return errors


def _within(turn: Float) -> Float:
    """Turns in (-pi / 4, pi / 4] that mean the same frame."""
    folded: Float = QUARTER / 2 - (QUARTER / 2 - turn) % QUARTER
    return folded


def only_frame(raw: Segments, camera: Camera, frame: ManhattanFrame) -> HorizontalFrames:
    """A single Manhattan frame, as it is, with what the segments say of it."""
    seen = _observed(longest(raw), camera)
    fixed = fixed_mixture(seen, frame.rotation, np.zeros(1))
    error = _errors(fit_mixture(seen, fixed))
    gain = fixed.likelihood - fixed_mixture(seen, frame.rotation, np.zeros(0)).likelihood
    return _described(raw, None, camera, frame, fixed, error, np.array([gain / TOGETHER]))


def _explains(found: Mixture, frame: ManhattanFrame) -> bool:
    """Whether one of the frames is nearly the single frame, which may be a mean of several.

    Where none is, two houses were made of the two sides of one whose corner is known badly.
    """
    x = frame.rotation[:, 0]
    turn = np.arctan2(found.rotation[:, 1] @ x, found.rotation[:, 0] @ x)
    return bool(np.abs(_within(found.turns - turn)).min() < LARGEST_MOVE)


def _without_each(seen: Observed, found: Mixture) -> tuple[list[Mixture], Float]:
    """The mixtures without one frame each, and by how much, nats, each of them is less likely (K,)."""
    without = [fit_mixture(seen, found.without(number)) for number in range(len(found.turns))]
    return without, np.array([_evidence(seen, found, mixture) for mixture in without])


def _several(raw: Segments, camera: Camera, seen: Observed, found: Mixture) -> HorizontalFrames | None:
    """The frames by falling evidence, their turns against the first of them; None where that has another upright."""
    fixed = [
        fixed_mixture(seen, found.rotation, np.delete(found.turns, number)).likelihood
        for number in range(len(found.turns))
    ]
    evidence = (found.likelihood - np.array(fixed)) / TOGETHER
    order = np.argsort(-evidence, kind="stable")
    axes = np.concatenate([level_directions(found.rotation, found.turns[order[:1]]), found.rotation[:, 2][None]])
    main = name_frame(raw, camera.matrix, axes)
    if main.rotation[:, 2] @ found.rotation[:, 2] < np.cos(QUARTER / 2):
        return None
    turns = _within(found.turns[order] - found.turns[order[0]])
    mixture = fixed_mixture(seen, main.rotation, turns)
    return _described(raw, seen.noise, camera, main, mixture, _errors(found)[order], evidence[order])


def _described(
    raw: Segments,
    noise: Noise | None,
    camera: Camera,
    main: ManhattanFrame,
    mixture: Mixture,
    errors: Float,
    evidence: Float,
) -> HorizontalFrames:
    """The frames of a mixture (K,) with their errors, evidence and shares of the segment length."""
    shares = np.r_[mixture.share[[1, 2, 0]], mixture.share[3:]]
    seen = replace(_observed(raw.ends, camera), noise=noise)
    label = _labelled(seen, mixture.directions, mixture.share)
    of_frame = np.where(label > 0, (label - 1) // 2, -1)
    length = raw.length
    frames = tuple(
        HorizontalFrame(turn, error, float(length[of_frame == number].sum() / length.sum()), gain)
        for number, (turn, error, gain) in enumerate(
            zip(mixture.turns.tolist(), errors.tolist(), evidence.tolist(), strict=True)
        )
    )
    return HorizontalFrames(main, frames, shares)


def _labelled(seen: Observed, directions: Float, share: Float) -> Int:
    """(N,) the row of `directions` (M, 3) that each segment most likely runs along, or -1; `share` is (M + 1,)."""
    sine = np.abs(seen.against(directions).sine)
    likely = np.vstack([share[:-1, None] * seen.density(directions), np.full((1, len(seen.ends)), share[-1] / np.pi)])
    label = likely.argmax(axis=0)
    is_along = label < len(directions)
    angle = np.take_along_axis(sine, np.where(is_along, label, 0)[None], axis=0)[0]
    labels: Int = np.where(is_along & (angle < np.sin(label_angle(seen.width))), label, -1)
    return labels
