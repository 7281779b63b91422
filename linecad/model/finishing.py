"""The last strokes of a drawing: ends are closed, stubs that end nowhere go, and what is one line becomes one.

Each of these may leave work for the others: a line that took another in is met elsewhere, and what ended on a stub ends
somewhere else. So they are done until nothing changes.
"""

from dataclasses import replace

from linecad.model.clean.sight import Sight
from linecad.model.frame_ends import with_ends_closed
from linecad.model.frames import FramedLines
from linecad.model.merging import with_merged_lines
from linecad.model.ticks import without_ticks
from linecad.scene import Scene

MOST_ROUNDS = 4  # two or three are usual


def finished(scene: Scene, framed: FramedLines, sight: Sight) -> Scene:
    """The scene with its lines merged, without ticks and with closed ends; a note counts the ticks.

    `framed` are its lines, row by row.
    """
    ticks = 0
    for _ in range(MOST_ROUNDS):
        framed = with_ends_closed(framed, sight)
        scene = replace(scene, lines=framed.in_world())
        found, framed = without_ticks(scene, framed, sight)
        ticks += len(scene.lines) - len(found.lines)
        found, framed = with_merged_lines(found, framed, sight)
        if found is scene:
            break
        scene = found
    if not ticks:
        return scene
    return replace(scene, notes=(*scene.notes, f"{ticks} stubs of detail that end nowhere are left out"))
