"""A photo to files, with everything a user chooses as one value: Python, command line and batch go this way."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import linecad.pipeline
from exporters.drawings.sizes import FIT
from exporters.format_options import DRAWING_SCALE
from exporters.options import Value
from linecad.camera.distortion import open_photo
from linecad.camera.intrinsics import read_calibration
from linecad.camera.photo import Photo
from linecad.corrections.file import check_belongs, read_corrections
from linecad.depth.for_photo import check_depth_options, open_depth_map
from linecad.depth.read import check_depth_file
from linecad.errors import LinecadError, OptionError, OutputError, UnwrittenError
from linecad.model.wanted import Wanted
from linecad.options import Options
from linecad.outputs import export_command, keep_scene, write_outputs
from linecad.progress import StageReport, silent
from linecad.scene import Scene
from solver.options import OnProgress


@dataclass(frozen=True)
class Conversion:
    """How a photo becomes a scene. Plain values throughout, so that it travels to other processes and has a hash."""

    camera: Path | None = None  # the calibration of the photo; not together with `focal`
    focal: float | None = None  # px
    options: Options = field(default_factory=Options)
    values: Mapping[str, Value] = field(default_factory=dict)  # options of formats, as linecad.outputs reads them
    corrections: Path | None = None  # a person's, of this one photo
    depth: Path | None = None  # a depth map of this one photo
    wanted: Wanted = field(default_factory=Wanted)  # what of the scene is written, and at which scale

    def checked(self, maps_come: bool = False) -> Self:
        """This conversion, once its files are known to be readable and its options to go together.

        `maps_come` says that photos get depth maps of their own, each in place of `depth`. Raises CameraError,
        CorrectionsFileError, DepthMapError where the first bytes of the map tell that it is none, or OptionError where
        what is said of a map has no use, or what is wanted is known to be missing from the scene.
        """
        check_depth_options(self.options, maps_come or self.depth is not None)
        self._check_wanted()
        if self.depth is not None:
            check_depth_file(self.depth)
        if self.camera is not None:
            read_calibration(self.camera)
        if self.corrections is not None:
            read_corrections(self.corrections)
        return self

    def _check_wanted(self) -> None:
        """Raise OptionError where what is wanted needs what no scene of this conversion tells."""
        if self.wanted.confidence is not None and not self.options.uses_bodies:
            raise OptionError(
                "only formulation=bodies tells how likely the depth of a line is right; leave out --confidence, or "
                "what chooses another: --fast, or options of the program, its joins, weights, collinear pairs or reach"
            )
        scale = self.values.get(DRAWING_SCALE, FIT)
        if scale != FIT and self.wanted.known is None and self.corrections is None:
            raise OptionError(
                f"option {DRAWING_SCALE}={scale} needs a known length; give --camera-height, for a single photo also "
                "--scale or corrections that hold one, or leave the option out"
            )

    def read(self, photo: Path) -> Photo:
        """The photo with its camera. Raises PhotoError or CameraError."""
        return open_photo(photo, self.camera, self.focal)

    def reconstruct(self, photo: Photo, on_progress: OnProgress = None, on_stage: StageReport = silent) -> Scene:
        """The whole scene of the photo, of which `wanted` tells what is to be written.

        Raises ReconstructionError, SolverError, CorrectionsFileError for corrections of another photo, or DepthMapError
        for a depth map that cannot be used.
        """
        corrections = None
        if self.corrections is not None:
            corrections = read_corrections(self.corrections)
            check_belongs(corrections, str(self.corrections), photo.width, photo.height)
        depth = None
        if self.depth is not None:
            on_stage("reading the depth map")
            depth = open_depth_map(self.depth, photo, self.options)
        return linecad.pipeline.reconstruct(photo, self.options, on_progress, on_stage, corrections, depth)

    def write(
        self,
        scene: Scene,
        photo: Photo,
        source: Path,
        outputs: Sequence[Path],
        on_stage: Callable[[str], None] | None = None,
    ) -> Scene:
        """Write what is wanted of a scene, each file whole or not at all, and return it.

        `source` is the file of the photo. Whatever cannot be done, the scene file is written where a disk takes it, so
        that nothing has to be solved again. Raises OutputError, ScaleError or ConfidenceError, which tells the command
        to go on with.
        """
        try:
            wanted = self.wanted.of(scene)
        except LinecadError as error:
            raise self._kept(error, scene, source, outputs, outputs) from error
        try:
            write_outputs(wanted, photo.pixels, outputs, self.values, on_stage)
        except UnwrittenError as error:
            raise self._kept(error, wanted, source, outputs, error.unwritten) from error
        return wanted

    def _kept(
        self, error: LinecadError, scene: Scene, source: Path, outputs: Sequence[Path], missing: Sequence[Path]
    ) -> LinecadError:
        """The same error, once the scene is kept, with how to go on to those of the outputs that are missing."""
        try:
            file = keep_scene(scene, outputs)
        except OutputError as other:
            return type(error)(f"{error}; the scene was not kept either: {other}")
        more = [] if isinstance(error, UnwrittenError) else self.wanted.again(error)
        if not self.wanted.is_whole:
            missing = [path for path in missing if path != file]  # what holds all of the scene is not written over
        command = export_command(file, source, more, missing, self.values)
        return type(error)(f"{error}; the scene is kept in {file}, go on with: {command}")


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
