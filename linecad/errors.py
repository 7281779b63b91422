"""Everything that can go wrong and that a user can act on.

LinecadError
├── InputError         a file that cannot be used: photo, camera, scene
│   ├── PhotoError     not an image, truncated, too large, too small
│   ├── CameraError    a calibration that is malformed or of another size
│   ├── SceneFileError a scene file that does not say what its format promises
│   ├── DepthMapError  not a depth map, damaged, too coarse or too large
│   ├── DatasetError   a made dataset that is damaged or was begun with other options
│   └── CorrectionsFileError a corrections file that is malformed or belongs to another photo
├── OptionError        an option that does not exist, or a value that it does not take
├── ScaleError         a known length that the scene does not hold
├── GroupError         a place in the photo at which the scene has nothing
├── ConfidenceError    a confidence that no line of the scene reaches, or of which it tells nothing
├── OutputError        a result that cannot be written: suffix, folder, disk
│   └── UnwrittenError some of several results cannot be written, the others are
├── ReconstructionError the photo was read, but holds too little for a model
├── CorrectionError    an edit that names no line, or that cannot be done
├── EditorError        the page cannot be served
└── SolverError        the solver ended without any usable answer
    └── ContradictionError annotations of crossings cannot all be true

The text of each is one line: what was found, and what to do about it.
"""

from collections.abc import Sequence
from pathlib import Path


class LinecadError(Exception):
    """Base of every error that is the user's to act on; the command line prints it and exits with 1."""


class InputError(LinecadError):
    """A file given to linecad cannot be used."""


class PhotoError(InputError):
    """The photo cannot be read or is of a size that linecad does not take."""


class CameraError(InputError):
    """The calibration is malformed or does not belong to the photo."""


class SceneFileError(InputError):
    """The scene file breaks the promises of docs/reference/scene-file.md."""


class DepthMapError(InputError):
    """The file holds no depth that linecad can measure in, or does not belong to the photo."""


class DatasetError(InputError):
    """A dataset breaks the promises of docs/reference/datasets.md, or was begun with other options."""


class CorrectionsFileError(InputError):
    """The corrections file breaks the promises of docs/reference/corrections.md, or was made for another photo."""


class OptionError(LinecadError):
    """An option does not exist, or does not take the value that was given."""


class ScaleError(LinecadError):
    """A known length was given that cannot be measured in the scene."""


class GroupError(LinecadError):
    """Nothing stands at a place in the photo that was to tell what the scene is about."""


class ConfidenceError(LinecadError):
    """No line of the scene is as sure as was asked for, or the scene does not tell how sure its lines are."""


class OutputError(LinecadError):
    """A result cannot be written."""


class UnwrittenError(OutputError):
    """Some of several results cannot be written; the others are."""

    def __init__(self, text: str, unwritten: Sequence[Path] = ()) -> None:
        """Where nothing else is said, which ones is not known."""
        super().__init__(text)
        self.unwritten = tuple(unwritten)


class ReconstructionError(LinecadError):
    """The photo holds too little structure for the step that failed."""


class SolverError(LinecadError):
    """The solver ended without a usable answer."""


class ContradictionError(SolverError):
    """What a person said and what no depths satisfy together: crossings called real, or facts; a smallest such set."""

    def __init__(
        self,
        text: str,
        lines: tuple[int, ...],
        crossings: tuple[tuple[int, int], ...],
        facts: tuple[object, ...] = (),
    ) -> None:
        """The lines in it, the pairs of them that cross, and the facts (`linecad.corrections.edits.Fact`).

        Lines are nodes of the graph, or ids where the lines have some.
        """
        super().__init__(text)
        self.lines = lines
        self.crossings = crossings
        self.facts = facts


class CorrectionError(LinecadError):
    """An edit names a line that is not there, or cannot be done."""


class EditorError(LinecadError):
    """The page cannot be served: a missing library, a port in use."""
