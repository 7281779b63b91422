"""The work of `linecad edit`: a photo, its corrections file and the page, from the first look to the last save."""

import contextlib
import signal
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

from linecad.camera.photo import Photo
from linecad.corrections.edits import Corrections
from linecad.corrections.file import check_belongs, read_corrections, write_corrections
from linecad.depth.for_photo import open_depth_map
from linecad.editing.guard import HOST, new_token
from linecad.editing.labelling import camera_of_labels, labels_to_json
from linecad.editing.saving import Saver
from linecad.editing.session import Session
from linecad.editing.solving import SolvingProcess
from linecad.editing.state import ToSave
from linecad.errors import EditorError
from linecad.io.files import check_output, write_text_atomically
from linecad.io.locks import alone
from linecad.lines.segments import find_segments
from linecad.options import Options

try:
    from linecad.editing.listening import listen, serve
    from linecad.editing.server import Editor
except ModuleNotFoundError as missing:
    raise EditorError(
        f"the page needs the library {missing.name}; install it with: pip install 'linecad[editor]'"
    ) from missing


@dataclass(frozen=True)
class EditOptions:
    """What a user can choose about the page."""

    corrections: Path  # read if it is there, written on every change
    port: int = 0  # 0: any free one
    reconstruct: Options = field(default_factory=Options)
    labels: Path | None = None  # written on every change, beside the photo
    camera_file: Path | None = None  # the photo's calibration, which the labels name
    depth: Path | None = None  # a depth map of the photo, which every solve is given


def edit(photo: Photo, options: EditOptions, on_ready: Callable[[str], None], on_stage: Callable[[str], None]) -> None:
    """Serve the page until Ctrl-C; `on_ready` is told its address, which holds the token.

    Raises EditorError when it cannot be served, OutputError when the corrections cannot be saved, LinecadError when
    another page writes the same file, and CorrectionsFileError, DepthMapError or ReconstructionError for a file or a
    photo that cannot be used.
    """
    if options.reconstruct.solve.fast:
        raise EditorError("the page solves with what you say of crossings, which a fast fit cannot; leave out --fast")
    check_output(options.corrections)
    with contextlib.ExitStack() as stack:
        for path in (options.corrections, options.labels):
            if path is not None:
                stack.enter_context(_only_writer(path))
        _edit(photo, options, on_ready, on_stage)


def _only_writer(path: Path) -> contextlib.AbstractContextManager[None]:
    target = path.resolve()
    who = f"another linecad edit writes {path}"
    return alone(target.with_name(f".{target.name}.lock"), who, "end that one first, or name another file")


def _edit(photo: Photo, options: EditOptions, on_ready: Callable[[str], None], on_stage: Callable[[str], None]) -> None:
    corrections = Corrections(photo.name, photo.width, photo.height)
    if options.corrections.exists():
        corrections = read_corrections(options.corrections)
        check_belongs(corrections, str(options.corrections), photo.width, photo.height)
    depth = None
    if options.depth is not None:
        on_stage("reading the depth map")
        depth = open_depth_map(options.depth, photo, options.reconstruct)
    listener = listen(options.port)
    try:
        on_stage("finding segments")
        raw = find_segments(photo.grey)
        on_stage("finding the Manhattan frame")
        camera = camera_of_labels(photo, options.camera_file)

        def write(newest: ToSave) -> None:
            write_corrections(newest.corrections, options.corrections)
            if options.labels is not None:
                graph, annotations = newest.lines.graph, newest.lines.annotations
                write_text_atomically(options.labels, labels_to_json(photo, camera, graph, annotations))

        saver = Saver(write)
        session = Session(photo, raw, options.reconstruct, corrections, saver.save)
        solving = SolvingProcess(photo, options.reconstruct, session.hear, session.take, depth)
        try:
            token, port = new_token(), listener.getsockname()[1]
            app = Editor(session, solving, saver, camera, depth).app(token, port)
            solving.start(session.task(session.now().version))
            signal.signal(signal.SIGTERM, _end)
            serve(app, listener, lambda: on_ready(f"http://{HOST}:{port}/#{token}"))
        finally:
            solving.close()
            saver.close()
    finally:
        listener.close()


def _end(_number: int, _frame: FrameType | None) -> None:
    """SIGTERM ends as Ctrl-C does, with everything saved."""
    raise KeyboardInterrupt
