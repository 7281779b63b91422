"""One photo to files, with everything a user chooses about it as one value: what each photo of a batch gets."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from exporters.options import Value
from linecad.camera.distortion import open_photo
from linecad.camera.intrinsics import read_calibration
from linecad.camera.photo import Photo
from linecad.model.scale import Known, set_scale
from linecad.options import Options
from linecad.outputs import write_outputs
from linecad.pipeline import reconstruct
from linecad.progress import StageReport
from linecad.scene import Scene
from solver.options import Progress


@dataclass(frozen=True)
class Conversion:
    """How a photo becomes a scene. Plain values throughout, so that it travels to other processes and has a hash."""

    camera: Path | None = None  # the calibration of the photo; not together with `focal`
    focal: float | None = None  # px
    options: Options = field(default_factory=Options)
    known: Known | None = None  # a length that sets the scale
    values: Mapping[str, Value] = field(default_factory=dict)  # options of formats, as exporters.formats reads them

    def checked(self) -> Self:
        """This conversion, once it is known that its camera can be read at all. Raises CameraError."""
        if self.camera is not None:
            read_calibration(self.camera)
        return self

    def read(self, photo: Path) -> Photo:
        """The photo with its camera. Raises PhotoError or CameraError."""
        return open_photo(photo, self.camera, self.focal)

    def reconstruct(self, photo: Photo, on_progress: Callable[[Progress], None] | None, on_stage: StageReport) -> Scene:
        """The scene of the photo. Raises ReconstructionError, SolverError, or LinecadError for an unknown length."""
        scene = reconstruct(photo, self.options, on_progress, on_stage)
        return scene if self.known is None else set_scale(scene, self.known)

    def write(self, scene: Scene, photo: Photo, outputs: Sequence[Path]) -> None:
        """Write a scene in the formats that the suffixes choose, each file whole or not at all. Raises OutputError."""
        write_outputs(scene, photo.pixels, outputs, self.values)
