"""A photo to files, with everything a user chooses as one value: Python, command line and batch go this way."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import linecad.pipeline
from exporters.options import Value
from linecad.camera.distortion import open_photo
from linecad.camera.intrinsics import read_calibration
from linecad.camera.photo import Photo
from linecad.confidence import keep_probable
from linecad.corrections.file import check_belongs, read_corrections
from linecad.depth.for_photo import check_depth_options, open_depth_map
from linecad.depth.read import check_depth_file
from linecad.model.choice import Detail, keep_drawn
from linecad.model.scale import Known, set_scale
from linecad.options import Options
from linecad.outputs import write_outputs
from linecad.progress import StageReport, silent
from linecad.scene import Scene
from solver.options import OnProgress


@dataclass(frozen=True)
class Conversion:
    """How a photo becomes a scene. Plain values throughout, so that it travels to other processes and has a hash."""

    camera: Path | None = None  # the calibration of the photo; not together with `focal`
    focal: float | None = None  # px
    options: Options = field(default_factory=Options)
    known: Known | None = None  # a length that sets the scale
    values: Mapping[str, Value] = field(default_factory=dict)  # options of formats, as linecad.outputs reads them
    corrections: Path | None = None  # a person's, of this one photo
    confidence: float | None = None  # 0 to 1; lines whose depth is right with a smaller probability are left out
    depth: Path | None = None  # a depth map of this one photo
    detail: Detail = "all"  # which lines are written

    def checked(self, maps_come: bool = False) -> Self:
        """This conversion, once its files are known to be readable and its options to go together.

        `maps_come` says that photos get depth maps of their own, each in place of `depth`. Raises CameraError,
        CorrectionsFileError, DepthMapError where the first bytes of the map tell that it is none, or OptionError where
        what is said of a map has no use.
        """
        check_depth_options(self.options, maps_come or self.depth is not None)
        if self.depth is not None:
            check_depth_file(self.depth)
        if self.camera is not None:
            read_calibration(self.camera)
        if self.corrections is not None:
            read_corrections(self.corrections)
        return self

    def read(self, photo: Path) -> Photo:
        """The photo with its camera. Raises PhotoError or CameraError."""
        return open_photo(photo, self.camera, self.focal)

    def reconstruct(self, photo: Photo, on_progress: OnProgress = None, on_stage: StageReport = silent) -> Scene:
        """The scene of the photo.

        Raises ReconstructionError, SolverError, CorrectionsFileError for corrections of another photo, DepthMapError
        for a depth map that cannot be used, ScaleError for a length that the scene does not hold, or ConfidenceError
        where no line is as sure as was asked for.
        """
        corrections = None
        if self.corrections is not None:
            corrections = read_corrections(self.corrections)
            check_belongs(corrections, str(self.corrections), photo.width, photo.height)
        depth = None
        if self.depth is not None:
            on_stage("reading the depth map")
            depth = open_depth_map(self.depth, photo, self.options)
        scene = linecad.pipeline.reconstruct(photo, self.options, on_progress, on_stage, corrections, depth)
        if self.known is not None:
            scene = set_scale(scene, self.known)  # first, because the known line itself may be left out
        if self.confidence is not None:
            scene = keep_probable(scene, self.confidence)
        return keep_drawn(scene, self.detail)

    def write(
        self,
        scene: Scene,
        photo: Photo,
        outputs: Sequence[Path],
        on_stage: Callable[[str], None] | None = None,
    ) -> None:
        """Write a scene in the formats that the suffixes choose, each file whole or not at all. Raises OutputError."""
        write_outputs(scene, photo.pixels, outputs, self.values, on_stage)


def reconstruct(
    photo: Path | str,
    camera: Path | str | None = None,
    focal: float | None = None,
    options: Options = Options(),
    corrections: Path | str | None = None,
    depth: Path | str | None = None,
) -> Scene:
    """The lines, planes and boundaries of a photo's scene.

    The camera comes from the calibration in the file `camera`, else from `focal` (px), else from EXIF and the photo's
    vanishing points; `corrections` is a file that `linecad edit` wrote, `depth` a depth map of the photo, as
    networks and phones write them. Raises PhotoError, CameraError, CorrectionsFileError or DepthMapError for a file
    that cannot be used, OptionError for options that do not go together, ReconstructionError where the photo shows too
    little, and SolverError: all of them a LinecadError, in one line.
    """
    conversion = Conversion(
        None if camera is None else Path(camera),
        focal,
        options,
        corrections=None if corrections is None else Path(corrections),
        depth=None if depth is None else Path(depth),
    ).checked()
    return conversion.reconstruct(conversion.read(Path(photo)))
