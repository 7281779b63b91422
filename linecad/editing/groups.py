"""The groups of lines that a model consists of, as a person sees them: name, place and share of the photo."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.editing.in_model import is_guess, rows_in_scene
from linecad.editing.state import Now
from linecad.scene import Scene

THIRDS = (1 / 3, 2 / 3)  # of the photo, that its parts part at
ROWS = ("upper", "middle", "lower")
COLUMNS = ("left", "centre", "right")


@dataclass(frozen=True)
class Group:
    """The lines of one component."""

    component: int
    name: str  # as a person named it, else by its place in the photo
    is_named: bool
    line: int  # id of the line that its name is given to: the one that has it, else the longest in the photo
    lines: int
    share: float  # 0 to 1, of the length of all segments in the model
    guess: float  # 0 to 1, of its own length, at depths that are guesses


@dataclass(frozen=True, eq=False)
class _InModel:
    """The page's lines that are in the model."""

    ids: Int  # (M,)
    middle: Float  # (M, 2) px
    length: Float  # (M,) px
    component: Int  # (M,)
    guess: Bool  # (M,)


def groups_of(now: Now) -> tuple[Group, ...]:
    """The groups of the model that is shown: component 0 first, then those that more of the photo shows."""
    if now.model is None:
        return ()
    found = _in_model(now, now.model.scene)
    names = _names(now, found)
    whole = max(float(found.length.sum()), np.finfo(float).tiny)
    size = now.photo.width, now.photo.height
    groups = []
    for component in np.unique(found.component).tolist():
        own = found.component == component
        length, ids = found.length[own], found.ids[own]
        middle = np.average(found.middle[own], axis=0, weights=length)
        named = names.get(component)
        groups.append(
            Group(
                component,
                named[1] if named else _name(component, middle, size),
                named is not None,
                named[0] if named else int(ids[length.argmax()]),
                int(own.sum()),
                float(length.sum()) / whole,
                float(length[found.guess[own]].sum() / length.sum()),
            )
        )
    return tuple(sorted(groups, key=lambda group: (group.component != 0, -group.share, group.component)))


def _in_model(now: Now, scene: Scene) -> _InModel:
    graph = now.lines.graph
    row = rows_in_scene(graph, scene)
    here = row >= 0
    ends = graph.segments.ends[here]
    return _InModel(
        np.array(now.lines.ids, np.int64)[here],
        ends.mean(axis=1),
        np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1),
        np.asarray(scene.lines.component)[row[here]],
        is_guess(scene)[row[here]],
    )


def _names(now: Now, found: _InModel) -> dict[int, tuple[int, str]]:
    """By component: the line that has its name, and the name; the newest one where groups have become one."""
    component = dict(zip(found.ids.tolist(), found.component.tolist(), strict=True))
    said = now.lines.corrected.names
    return {component[line]: (line, name) for line, name in said.items() if line in component}


def _name(component: int, middle: Float, size: tuple[int, int]) -> str:
    """A name by the part of the photo (ninths) that the middle (2,) px of a group lies in."""
    if component == 0:
        return "Main group"
    column, row = (int(np.searchsorted(THIRDS, (at + 0.5) / side)) for at, side in zip(middle, size, strict=True))
    place = (
        "middle"
        if (row, column) == (1, 1)
        else " ".join(word for word, is_said in ((ROWS[row], row != 1), (COLUMNS[column], column != 1)) if is_said)
    )
    return f"Group {component}, {place}"
