"""What a person knows about faces, kept with the ids of the lines that it names, so that it outlives their edits."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import assert_never

from linecad.corrections.edits import Anchor, FaceEdit, NoWindow, Region, WallAnchor, WallByEdges, Window
from linecad.directions import UP, partner
from linecad.errors import CorrectionError

Find = Callable[[Anchor], int]  # the id of the line that an anchor names; CorrectionError when there is none
Look = Callable[[int], Anchor | None]  # what a line looks like now; None when it is no line any more


@dataclass(frozen=True)
class ToldFace:
    """One edit with the ids of the lines that it names."""

    edit: FaceEdit
    lines: tuple[int, ...] = ()

    def now(self, look: Look) -> FaceEdit | None:
        """The same with its lines as they look now; None where it has lost one that it cannot do without."""
        match self.edit:
            case Region() | NoWindow():
                return self.edit
            case Window():
                line = look(self.lines[0]) if self.lines else None
                return replace(self.edit, wall=WallAnchor(self.edit.wall.normal, line))
            case WallByEdges():
                one, two, three, four = (look(line) for line in self.lines)
                if one is None or two is None or three is None or four is None:
                    return None
                return WallByEdges((one, two, three, four))
            case _:
                assert_never(self.edit)


def told(edit: FaceEdit, find: Find, look: Look, before_frame: bool) -> ToldFace:
    """An edit with the ids of its lines; CorrectionError where one is not there or they are no edges of a wall.

    `before_frame`: the frame was given anew later, so that the axes in it meant others.
    """
    match edit:
        case Region() | NoWindow():
            return ToldFace(edit)
        case Window():
            line = None if edit.wall.line is None else find(edit.wall.line)
            axis = None if line is None else _axis(look(line))
            if before_frame:
                if axis is None or axis == UP:
                    raise CorrectionError("its wall was named in a frame that was replaced; draw the window again")
                edit = replace(edit, wall=WallAnchor(int(partner(axis)), edit.wall.line))
            elif axis not in (None, UP, int(partner(edit.wall.normal))):
                raise CorrectionError("the line that names the window's wall does not lie in it; draw the window again")
            return ToldFace(edit, () if line is None else (line,))
        case WallByEdges():
            lines = tuple(find(line) for line in edit.lines)
            axes = [_axis(look(line)) for line in lines]
            level = {axis for axis in axes if axis != UP}
            if len(set(lines)) < len(lines) or axes.count(UP) != len(lines) // 2 or len(level) != 1:
                raise CorrectionError("a wall has two upright edges and two along one level axis; choose these")
            return ToldFace(edit, lines)
        case _:
            assert_never(edit)


def _axis(line: Anchor | None) -> int | None:
    return None if line is None else line.axis
