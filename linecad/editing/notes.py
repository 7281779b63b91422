"""What a person should know about the model, in a person's words, the worst first.

The notes of a scene tell what the program did; these tell what that means for who uses the model.
"""

from linecad.camera.text import summary
from linecad.editing.groups import Group
from linecad.editing.state import Now
from linecad.model.known_lengths import DISAGREE, SAYS_NOTHING

LEAST_NAMED = 0.01  # of all lines in the photo; smaller groups that nobody has named are counted
MOSTLY, PARTLY = 0.5, 0.1  # of a group's length: at guessed depths
POOR = "poor"  # the quality of a camera that bends a whole model


def notes_of(now: Now, groups: tuple[Group, ...]) -> tuple[str, ...]:
    """One line each; `groups` are those of the model that is shown."""
    certainty = now.found.certainty
    camera = () if certainty is None else (summary(now.found.camera, certainty),)
    is_poor = certainty is not None and certainty.quality == POOR
    notes = [*_corrections(now), *(camera if is_poor else ()), *_depths(groups)]
    if now.model is not None:
        notes += [*_depth_map(now), *_scale(now), *_missing(now, groups)]
    return (*notes, *(() if is_poor else camera))


def _corrections(now: Now) -> list[str]:
    """What a person said and the model does not have."""
    known = () if now.model is None else now.model.scene.notes
    lengths = [note for note in known if any(words in note for words in (SAYS_NOTHING, DISAGREE))]
    return [*now.lines.corrected.notes, *lengths]


def _depths(groups: tuple[Group, ...]) -> list[str]:
    unsure = sorted((group for group in groups if group.guess > PARTLY), key=lambda group: -group.guess * group.share)
    large = [group for group in unsure if group.share >= LEAST_NAMED or group.is_named]
    notes = [
        f"{group.name}: depth is a guess ({group.share:.0%} of the lines in the photo)"
        if group.guess > MOSTLY
        else f"{group.name}: depth is a guess for {group.guess:.0%} of it"
        for group in large
    ]
    small = len(unsure) - len(large)
    if small:
        notes.append(f"{small} small group{'s' if small > 1 else ''}: depth is a guess")
    return notes


def _depth_map(now: Now) -> list[str]:
    report = None if now.model is None else now.model.scene.depth_map
    return [f"The depth map is not used: {report.left_out}"] if report is not None and report.left_out else []


def _scale(now: Now) -> list[str]:
    if now.model is None or now.model.scene.metres_per_unit is not None:
        return []
    return ["No length is known, so the model has no scale: select a line and press M"]


def _missing(now: Now, groups: tuple[Group, ...]) -> list[str]:
    missing = len(now.lines.ids) - sum(group.lines for group in groups)
    return [f"{missing} lines are not in the model (dotted): they meet too few others"] if missing else []
