"""Maximum likelihood of a camera and its Manhattan frame over all segments, with standard errors.

The model of a segment of length L px: it runs along one of three axes, or along none. Along an axis the angle between
it and the line from its middle to the vanishing point follows Student's t distribution, whose scale is what the
detector does to a segment of that length; along none, all angles are alike. Which axis it is, is not decided but
weighed (expectation maximisation), so that every segment has its say and none needs a threshold.

The axes of a real scene are not exactly orthogonal, nor is a lens exactly a pinhole: each axis may lie off the
orthogonal frame by a small turn of its own, all three by alike amounts. An axis with a thousand segments then does not
outvote one with ten, and the standard errors do not shrink below what the scene can tell.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linecad.arrays import Float
from linecad.geometry import rotation_about

FREEDOM = 1.0  # degrees of freedom of Student's t: few, as detectors err far more often than by their usual error
ANGLE_NOISE = 0.3  # px rad: the angle of a segment of L px is off by this over L ..
ANGLE_FLOOR = np.radians(0.1)  # .. and by this, however long it is
PLACE_NOISE = 0.5  # px: its place, which turns the direction to a vanishing point near it
LEAST_SHARE = 1e-3  # of the segments that one axis, or none, has
FIRST_SHARES = (0.3, 0.3, 0.3, 0.1)
USUAL_TURN = np.radians(0.3)  # by which axes lie off an orthogonal frame, before the photo tells
USUAL_TURN_SAYS = 2.0  # as much as so many observed turns
LARGEST_TURN = np.radians(1.0)  # beyond it, three directions are not a frame
FIRST_SCALE = 4.0  # by which the noise is taken larger at first, so that a fit does not end at the nearest optimum
SCALE_DECAY = 0.8  # from one iteration to the next
ITERATIONS = 60
STEP_END = 1e-6  # of the parameters, rad or relative; smaller steps end the iterations
LARGEST_STEP = 0.2  # rad and relative, in one iteration
RADIAL_STEP = 1e-5  # for the derivative
INVERSIONS = 12  # rounds of the fixed point that undoes a distortion

TURNS, FOCAL, CENTER_X, CENTER_Y, RADIAL = slice(0, 3), 3, 4, 5, 6  # places of the parameters
PARAMETERS = 7
TURNING = np.cross(np.eye(3)[:, None], np.eye(3))  # times axes (M, 3): how they go with turns about x, y and z


@dataclass(frozen=True, eq=False)
class View:
    """A camera before a Manhattan scene."""

    axes: Float  # (3, 3) rows are the axes in the camera frame, det +1 or -1
    focal: float  # px
    center: Float  # (2,) px, the principal point
    radial: float = 0.0  # share by which points at half the diagonal move out, see `undistorted`

    @property
    def matrix(self) -> Float:
        """K (3, 3), px."""
        return np.array([[self.focal, 0.0, self.center[0]], [0.0, self.focal, self.center[1]], [0.0, 0.0, 1.0]])

    def moved(self, step: Float, size: float) -> "View":
        """This view after a step of the PARAMETERS: turns, log focal length, center over `size` px, radial."""
        return View(
            self.axes @ rotation_about(step[TURNS]).T,
            self.focal * float(np.exp(step[FOCAL])),
            self.center + size * step[[CENTER_X, CENTER_Y]],
            self.radial + float(step[RADIAL]),
        )


@dataclass(frozen=True, eq=False)
class Prior:
    """What is known before looking: standard errors of the parameters, 0 where they are fixed, inf where free."""

    focal: float  # px, the expected one
    focal_error: float  # relative
    center: Float  # (2,) px, the expected one
    center_error: float  # of the larger side
    radial_error: float = 0.0  # expected 0
    largest_turn: float = LARGEST_TURN  # rad, of the usual turn of an axis off the orthogonal frame

    def scaled(self, scale: float) -> "Prior":
        """The same of the photo at another size."""
        return replace(self, focal=self.focal * scale, center=(self.center + 0.5) * scale - 0.5)


def known(K: Float) -> Prior:
    """The prior of a camera whose K (3, 3) is given."""
    return Prior(float(K[0, 0]), 0.0, K[:2, 2], 0.0)


@dataclass(frozen=True, eq=False)
class Fit:
    """The most likely view, and how sure it is."""

    view: View
    covariance: Float  # (7, 7) of the parameters; 0 for those that were fixed
    log_posterior: float
    share: Float  # (4,) of the segments: along each axis, and along none
    own_axes: Float  # (3, 3) rows: each axis after the turn of its own
    turn: float  # rad, the usual turn of an axis off the orthogonal frame
    belongs: Float = field(repr=False)  # (4, N) the probability that a segment runs along each axis, or along none


def undistorted(points: Float, radial: float, center: Float, width: int, height: int) -> Float:
    """Pixels (..., 2) of a photo as taken, freed from a radial distortion about a center (2,) px.

    `radial` is the share by which the distortion moves a point at half the diagonal away from the center: it is
    OpenCV's k1 = radial (focal / half diagonal)^2. Negative is a barrel.
    """
    if radial == 0.0:
        return points
    half = float(np.hypot(width, height)) / 2
    return np.stack(_straight(points[..., 0], points[..., 1], radial, center, half), axis=-1)


def _straight(x: Float, y: Float, radial: float, center: Float, half: float) -> tuple[Float, Float]:
    """The same of coordinates (...) px in a photo whose half diagonal is `half` px."""
    if radial == 0.0:
        return x, y
    x, y = (x - center[0]) / half, (y - center[1]) / half
    taken = x * x + y * y
    squared = taken
    # The distortion moves points along rays from the center, so a fixed point of the squared radius tells all.
    for _ in range(INVERSIONS - 1):
        moved = 1 + radial * squared
        squared = taken / (moved * moved)
    moved = (1 + radial * squared) / half
    return x / moved + center[0], y / moved + center[1]


def fit_view(ends: Float, width: int, height: int, start: View, prior: Prior, iterations: int = ITERATIONS) -> Fit:
    """The view that makes segments (N, 2, 2) px most likely, by Gauss-Newton steps from a start near it."""
    size = float(max(width, height))
    errors = np.array([np.inf] * 3 + [prior.focal_error, prior.center_error, prior.center_error, prior.radial_error])
    free = np.flatnonzero(errors > 0)
    precision = np.zeros(PARAMETERS)
    precision[free] = 1 / errors[free] ** 2
    view, turns, turn = start, np.zeros((3, 3)), USUAL_TURN
    share = np.array(FIRST_SHARES)
    unknowns = len(free) + 9
    # Of each axis: the free parameters and the turn of its own, which moves it as that of the frame does.
    which = [np.r_[np.arange(len(free)), len(free) + 3 * axis + np.arange(3)] for axis in range(3)]
    places = Places(ends)
    for iteration in range(iterations):
        wider = max(FIRST_SCALE * SCALE_DECAY**iteration, 1.0)
        own = replace(view, axes=_turned(view.axes, turns))
        sine, scale, slope = _angles(places, own, width, height, free)
        scale = scale * wider
        ratio = sine / scale
        density = student(ratio) / scale
        likely = np.vstack([share[:3, None] * density, np.full((1, len(ends)), share[3] / np.pi)])
        belongs = likely / likely.sum(axis=0)
        share = np.maximum(belongs.mean(axis=1), LEAST_SHARE)
        share /= share.sum()
        say = belongs[:3] * (FREEDOM + 1) / (FREEDOM + ratio**2) / scale**2
        system, pull = np.zeros((unknowns, unknowns)), np.zeros(unknowns)
        columns = np.stack([*slope, *slope[TURNS]], axis=-1)
        for own_slope, own_say, own_sine, own_unknowns in zip(columns, say, sine, which, strict=True):
            system[own_unknowns[:, None], own_unknowns] += (own_slope * own_say[:, None]).T @ own_slope
            pull[own_unknowns] += own_slope.T @ (own_say * own_sine)
        off = np.zeros(PARAMETERS)
        off[FOCAL] = np.log(view.focal / prior.focal)
        off[[CENTER_X, CENTER_Y]] = (view.center - prior.center) / size
        off[RADIAL] = view.radial
        diagonal = np.arange(unknowns)
        system[diagonal, diagonal] += np.concatenate([precision[free], np.full(9, turn**-2)]) + 1e-9
        pull += np.concatenate([(precision * off)[free], turns.ravel() * turn**-2])
        inverse = np.linalg.inv(system)
        move = np.clip(-inverse @ pull, -LARGEST_STEP, LARGEST_STEP)
        step = np.zeros(PARAMETERS)
        step[free] = move[: len(free)]
        view = view.moved(step, size)
        turns = turns + move[len(free) :].reshape(3, 3)
        # Expectation maximisation of the usual turn; a turn of an axis about itself changes nothing, so six count.
        spread = np.diag(inverse)[len(free) :].reshape(3, 3)
        across = 1 - view.axes**2
        seen = (((turns**2 + spread) * across).sum(), across.sum())
        turn = float(np.sqrt((USUAL_TURN_SAYS * USUAL_TURN**2 + seen[0]) / (USUAL_TURN_SAYS + seen[1])))
        turn = min(turn, prior.largest_turn)
        if wider == 1.0 and np.abs(move).max() < STEP_END:
            break
    covariance = np.zeros((PARAMETERS, PARAMETERS))
    covariance[np.ix_(free, free)] = inverse[: len(free), : len(free)]
    # The density of the turns, and of the usual turn itself, against those of USUAL_TURN.
    penalty = (precision * off**2).sum() + (turns**2).sum() / turn**2 + USUAL_TURN_SAYS * (USUAL_TURN / turn) ** 2
    widened = (seen[1] + USUAL_TURN_SAYS) * np.log(turn / USUAL_TURN)
    posterior = float(np.log(likely.sum(axis=0)).sum() - penalty / 2 - widened)
    return Fit(view, covariance, posterior, share, _turned(view.axes, turns), turn, belongs)


def _turned(axes: Float, turns: Float) -> Float:
    """Each axis (3, 3), a row, after the turn of its own (3, 3), rad."""
    return np.array([axis @ rotation_about(turn).T for axis, turn in zip(axes, turns, strict=True)])


def student(ratio: Float) -> Float:
    """Density of Student's t with FREEDOM = 1 degree of freedom."""
    density: Float = 1 / np.pi / (1 + ratio**2)
    return density


@dataclass(frozen=True, eq=False)
class Straight:
    """N segments in a photo without distortion."""

    middle: Float  # (2, N) px
    along: Float  # (2, N) unit vectors
    noise: Float  # (N,) rad^2, the squared scale of their angles far from vanishing points

    @classmethod
    def of(cls, x: Float, y: Float) -> "Straight":
        """Of the coordinates (2, N) px of starts and ends."""
        along = np.stack([x[1] - x[0], y[1] - y[0]])
        length = np.sqrt(along[0] * along[0] + along[1] * along[1])
        noise = ANGLE_FLOOR**2 + (ANGLE_NOISE / length) ** 2
        return cls(np.stack([x[0] + x[1], y[0] + y[1]]) / 2, along / length, noise)


class Places:
    """Segments (N, 2, 2) px of a photo as it was taken."""

    def __init__(self, ends: Float) -> None:
        # x and y, of the starts and the ends, (2, 2, N), each in one piece of memory: NumPy takes several times as long
        # over pairs of numbers.
        self._x, self._y = np.ascontiguousarray(ends.T)

    @cached_property
    def _as_taken(self) -> Straight:
        return Straight.of(self._x, self._y)

    def straight(self, radial: float, center: Float, half: float) -> Straight:
        """The segments without a distortion, as `undistorted`, in a photo whose half diagonal is `half` px."""
        if radial == 0.0:
            return self._as_taken
        return Straight.of(*_straight(self._x, self._y, radial, center, half))


@dataclass(frozen=True, eq=False)
class Angles:
    """How N segments lie against the directions to M vanishing points."""

    middle: Float  # (2, N) px
    along: Float  # (2, N) unit vectors
    noise: Float  # (N,) rad^2, as of the segments
    points: Float  # (M, 3) the vanishing points, homogeneous
    towards: Float  # (2, M, N) vectors from the middles to them
    square: Float  # (M, N) of the lengths of these
    distance: Float  # (M, N) these lengths, never 0

    @cached_property
    def sine(self) -> Float:
        """(M, N) signed."""
        sine: Float = (self.towards[1] * self.along[0] - self.towards[0] * self.along[1]) / self.distance
        return sine

    @cached_property
    def cosine(self) -> Float:
        """(M, N) signed."""
        cosine: Float = (self.towards[0] * self.along[0] + self.towards[1] * self.along[1]) / self.distance
        return cosine

    @cached_property
    def scale(self) -> Float:
        """(M, N) rad, of the distribution of the angles."""
        near = PLACE_NOISE * np.abs(self.points[:, 2:]) / self.distance
        scale: Float = np.sqrt(self.noise + near**2)
        return scale

    def slope(self, change: Float) -> Float:
        """Slope (M, N) of the sines where the vanishing points change by `change` (M, 3)."""
        moved_x, moved_y = change[:, :1], change[:, 1:2]
        if change[:, 2].any():  # none where focal length or center change
            moved_x, moved_y = moved_x - self.middle[0] * change[:, 2:], moved_y - self.middle[1] * change[:, 2:]
        slope: Float = self.cosine * (self.towards[0] * moved_y - self.towards[1] * moved_x) / self.square
        return slope


def angles_against(places: Places, view: View, width: int, height: int) -> Angles:
    """The angles of segments against the axes of a view, of any number M."""
    seen = places.straight(view.radial, view.center, float(np.hypot(width, height)) / 2)
    points = view.axes @ view.matrix.T
    towards = points.T[:2, :, None] - seen.middle[:, None] * points[:, 2:]
    square = towards[0] * towards[0] + towards[1] * towards[1]
    distance = np.maximum(np.sqrt(square), np.finfo(float).tiny)
    return Angles(seen.middle, seen.along, seen.noise, points, towards, square, distance)


def _angles(places: Places, view: View, width: int, height: int, free: "np.ndarray") -> tuple[Float, Float, Float]:
    """Sines (3, N) of the angles between segments and the directions to the axes, their scales and slopes.

    The slopes (F, 3, N) are those by the `free` parameters.
    """
    seen = angles_against(places, view, width, height)
    size, K = float(max(width, height)), view.matrix
    slopes = np.empty((len(free), *seen.sine.shape))
    for number, parameter in enumerate(free):
        if parameter < FOCAL:
            slopes[number] = seen.slope(view.axes @ TURNING[parameter] @ K.T)
        elif parameter == RADIAL or (parameter != FOCAL and RADIAL in free):
            # The center of the distortion moves with the principal point.
            step = np.zeros(PARAMETERS)
            step[parameter] = RADIAL_STEP
            there = angles_against(places, view.moved(step, size), width, height)
            slopes[number] = (there.sine - seen.sine) / RADIAL_STEP
        else:
            change = np.zeros((3, 3))
            if parameter == FOCAL:
                change[0, 0] = change[1, 1] = view.focal
            else:
                change[parameter - CENTER_X, 2] = size
            slopes[number] = seen.slope(view.axes @ change.T)
    return seen.sine, seen.scale, slopes
