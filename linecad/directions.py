"""The directions that lines run along: x, y, z of the main frame, then two level ones of each further frame.

A *direction* is told by its number, the *axis* of a line: 0 and 1 are the level axes of the main frame, 2 is upright
and belongs to all frames, 3 and 4 are the level axes of the first further frame, 5 and 6 of the second, and so on. The
*components* of a point are its coordinates along all K directions. Two lines that meet span a plane, and agree in the
component along its normal, which is a direction again: upright for two level lines of whatever frames, else the partner
of the level one (docs/method.md).
"""

import numpy as np

from linecad.arrays import Bool, Float, Int

UP = 2
MAIN = 3  # directions of the main frame

Turns = tuple[float, ...]  # rad, of each further frame against the main one, about the upright, from x towards y


def count_of(turns: Turns) -> int:
    """K, how many directions there are."""
    return MAIN + 2 * len(turns)


def directions_of(turns: Turns) -> Float:
    """(K, 3) unit vectors in the world."""
    rows = [row for turn in turns for row in _level(turn)]
    return np.concatenate([np.eye(MAIN), np.array(rows).reshape(-1, 3)])


def _level(turn: float) -> list[list[float]]:
    """x and y of a frame that is turned by `turn`, rad."""
    cosine, sine = float(np.cos(turn)), float(np.sin(turn))
    return [[cosine, sine, 0.0], [-sine, cosine, 0.0]]


def components(vectors: Float, turns: Turns) -> Float:
    """(..., K) coordinates of world vectors (..., 3) along all directions; those of the main frame to the last bit."""
    if not turns:
        return vectors
    further: Float = vectors @ directions_of(turns)[MAIN:].T
    return np.concatenate([vectors, further], axis=-1)


def axis_name(axis: int) -> str:
    """x, y, z; x2, y2 of the first further frame, x3, y3 of the second."""
    return "xyz"[axis] if axis < MAIN else f"{'xy'[(axis - MAIN) % 2]}{(axis - MAIN) // 2 + 2}"


def axis_of(name: str) -> int | None:
    """The axis of a name; None for what is no name of an axis."""
    if len(name) == 1:
        found = "xyz".find(name)
        return None if found < 0 else found
    if name[:1] in ("x", "y") and name[1:].isascii() and name[1:].isdigit() and name[1] != "0" and int(name[1:]) >= 2:
        return MAIN + 2 * (int(name[1:]) - 2) + "xy".index(name[0])
    return None


def letter_of(axis: int) -> str:
    """x, y or z: the axis within its frame."""
    return axis_name(axis)[0]


def axis_in_frame(letter: str, frame: int) -> int:
    """The axis of x, y or z in a frame, 0 for the main one; z is the same in all."""
    return UP if letter == "z" else level_axes(frame)["xy".index(letter)]


def level_axes(frame: int) -> tuple[int, int]:
    """The two level axes of a frame, 0 for the main one."""
    first = MAIN + 2 * (frame - 1) if frame else 0
    return first, first + 1


def frame_axes(frame: int) -> list[int]:
    """The directions that are x, y and z in a frame."""
    return [*level_axes(frame), UP]


def frame_of(axis: Int) -> Int:
    """The frame of each axis, 0 for the main one; the upright counts as the main one's."""
    return np.where(axis < MAIN, 0, (axis - MAIN) // 2 + 1)


def common_frame(first: Int, second: Int) -> Int:
    """The frame that two axes are of, or -1 where they are of two; the upright is of every frame."""
    one, other = frame_of(first), frame_of(second)
    either = (first == UP) | (second == UP)
    return np.where(either, np.maximum(one, other), np.where(one == other, one, -1))


def partner(axis: Int | int) -> Int:
    """The other level axis of the same frame; of the upright itself."""
    axis = np.asarray(axis)
    further = ((axis - MAIN) ^ 1) + MAIN
    return np.where(axis < UP, 1 - axis, np.where(axis == UP, UP, further))


def is_first(axis: Int | int) -> Bool:
    """Whether an axis is the first level one of its frame: the second is a quarter turn to the left of it."""
    axis = np.asarray(axis)
    return np.asarray((axis < UP) & (axis == 0) | (axis >= MAIN) & ((axis - MAIN) % 2 == 0))


def third(first: Int, second: Int) -> Int:
    """The normal of the plane that lines along two different axes span: in its component they agree."""
    level = np.where(first == UP, second, first)
    return np.where((first == UP) | (second == UP), partner(level), UP)


def across(axis: Int) -> Int:
    """(..., 2) the two axes at right angles to an axis whose components place a line along it, in cyclic order."""
    first = is_first(axis)
    one = np.where(axis == UP, 0, np.where(first, partner(axis), UP))
    other = np.where(axis == UP, 1, np.where(first, UP, partner(axis)))
    return np.stack([one, other], axis=-1)


def lies_across(axis: Int, normal: Int | int) -> Bool:
    """Whether a line along an axis can lie in a plane of that normal."""
    normals = np.asarray(normal)
    is_level: Bool = normals == UP
    return np.where(axis == UP, ~is_level, is_level | (normals == partner(axis)))


def in_world(along: Float, axis: Int, fixed: Float, turns: Turns) -> Float:
    """World points (N, M, 3) of lines at places (N, M) along them; `fixed` (N, 2) are their components `across`."""
    rows, count = np.arange(len(axis)), along.shape[1]
    sides = across(axis)
    points = np.zeros((len(axis), count, 3))
    own = axis < MAIN
    points[rows[own, None], np.arange(count), axis[own, None]] = along[own]
    for column in range(2):
        points[rows[own, None], np.arange(count), sides[own, column, None]] = fixed[own, column, None]
    if not own.all():
        vectors = directions_of(turns)
        place = along[~own, :, None] * vectors[axis[~own], None]
        for column in range(2):
            place = place + (fixed[~own, column, None] * vectors[sides[~own, column]])[:, None]
        points[~own] = place
    return points
