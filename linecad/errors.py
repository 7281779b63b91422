"""Everything that can go wrong and that a user can act on.

LinecadError
├── InputError         a file that cannot be used: photo, camera, scene
│   ├── PhotoError     not an image, truncated, too large, too small
│   ├── CameraError    a calibration that is malformed or of another size
│   ├── SceneFileError a scene file that does not say what its format promises
│   └── DatasetError   a made dataset that is damaged or was begun with other options
├── ScaleError         a known length that the scene does not hold
├── OutputError        a result that cannot be written: suffix, folder, disk
├── ReconstructionError the photo was read, but holds too little for a model
└── SolverError        the solver ended without any usable answer

The text of each is one line: what was found, and what to do about it.
"""


class LinecadError(Exception):
    """Base of every error that is the user's to act on; the command line prints it and exits with 1."""


class InputError(LinecadError):
    """A file given to linecad cannot be used."""


class PhotoError(InputError):
    """The photo cannot be read or is of a size that linecad does not take."""


class CameraError(InputError):
    """The calibration is malformed or does not belong to the photo."""


class SceneFileError(InputError):
    """The scene file breaks the promises of docs/scene-file.md."""


class DatasetError(InputError):
    """A dataset breaks the promises of docs/dataset.md, or was begun with other options."""


class ScaleError(LinecadError):
    """A known length was given that cannot be measured in the scene."""


class OutputError(LinecadError):
    """A result cannot be written."""


class ReconstructionError(LinecadError):
    """The photo holds too little structure for the step that failed."""


class SolverError(LinecadError):
    """The solver ended without a usable answer."""
