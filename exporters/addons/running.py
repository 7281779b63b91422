"""The command in a process of its own: what is asked of it, how far it is, what it said.

`linecad addon` writes this file into the add-on for Blender and the macro for FreeCAD. So it runs in the Pythons of
these programs: it needs Python 3.10 with its standard library, and nothing of linecad, which is not installed there.
"""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

WRITTEN_BY = ""  # path of the command that wrote the add-on, which `linecad addon` puts here
PATIENCE = 3.0  # s that a command has to end before it is killed
_LEFT = ".linecad-*"  # what a command that was killed may leave beside its outputs


class AddonError(Exception):
    """What the user can act on, in one line."""


@dataclass(frozen=True)
class Request:
    """What is asked of `linecad convert`."""

    photo: Path
    camera: Path | None = None
    depth: Path | None = None
    scale: str = ""  # LINE=METRES or U,V:U,V=METRES
    camera_height: float = 0.0  # m; 0: not known
    is_fast: bool = False
    is_corrected: bool = False  # with what the page corrected
    options: tuple[str, ...] = ()  # KEY=VALUE

    @property
    def folder(self) -> Path:
        """Where the files of this photo are written: beside it, in a folder that holds nothing else."""
        return self.photo.with_name(f"{self.photo.name}.linecad")

    @property
    def corrections(self) -> Path:
        """Where the page keeps its corrections of this photo."""
        return self.photo.with_name(f"{self.photo.name}.corrections.json")

    def output(self, suffix: str) -> Path:
        """The file of this format, such as `.glb`."""
        return self.folder / f"{self.photo.stem}{suffix}"

    def words_to_convert(self, suffixes: Sequence[str]) -> list[str]:
        """The arguments of the command that writes these formats; AddonError for what cannot be asked."""
        if not self.photo.is_file():
            raise AddonError(f"{self.photo} is not there; choose a photo")
        words = ["convert", str(self.photo), *self._words_of_inputs()]
        if self.scale.strip() and self.camera_height > 0:
            raise AddonError("a known length and the height of the camera are both given; clear one of them")
        if self.scale.strip():
            words.append(f"--scale={self.scale.strip()}")
        if self.camera_height > 0:
            words += ["--camera-height", f"{self.camera_height:.6g}"]
        if self.is_corrected:
            if not self.corrections.is_file():
                raise AddonError(f"{self.corrections} is not there; correct the photo on the page first")
            words += ["--corrections", str(self.corrections)]
        if self.is_fast:
            words.append("--fast")
        for option in self.options:
            words += ["--option", option]
        for suffix in suffixes:
            words += ["-o", str(self.output(suffix))]
        return words

    def words_to_edit(self) -> list[str]:
        """The arguments of the command that opens the page."""
        return ["edit", str(self.photo), *self._words_of_inputs()]

    def _words_of_inputs(self) -> list[str]:
        words = []
        for name, path in (("--camera", self.camera), ("--depth", self.depth)):
            if path is not None:
                words += [name, str(path)]
        return words


def find_command(chosen: str) -> str:
    """The path of the command: the one that is chosen, else that on PATH, else the one that wrote this file.

    AddonError where there is none.
    """
    if chosen:
        found = shutil.which(str(Path(chosen).expanduser()))
        if found is None:
            raise AddonError(f"{chosen} is no command that can be started; choose the file linecad of its environment")
        return found
    for name in ("linecad", WRITTEN_BY):
        found = shutil.which(name) if name else None
        if found is not None:
            return found
    raise AddonError(
        "linecad was not found; install it in an environment of its own, and choose the file linecad in that one's bin"
    )


def environment_for(given: Mapping[str, str]) -> dict[str, str]:
    """The environment of the command: without what this program, or its AppImage, says to its own Python."""
    environment = {name: value for name, value in given.items() if name not in ("PYTHONHOME", "PYTHONPATH")}
    image = given.get("APPDIR")
    if image and "LD_LIBRARY_PATH" in environment:
        folders = environment["LD_LIBRARY_PATH"].split(os.pathsep)
        environment["LD_LIBRARY_PATH"] = os.pathsep.join(each for each in folders if not each.startswith(image))
    return environment | {"PYTHONIOENCODING": "utf-8"}


class Running:
    """A command in a process of its own; its stages come by stderr, a line each."""

    def __init__(self, words: Sequence[str], folder: Path | None = None) -> None:
        """Start it; AddonError where that fails. `folder` is made before, and holds the outputs."""
        self.folder = folder
        self.was_ended = False
        self.started = time.monotonic()
        self._said: list[str] = []  # on stderr
        self._told: list[str] = []  # on stdout
        try:
            if folder is not None:
                folder.mkdir(exist_ok=True)
            self._process = _started(words)
        except OSError as error:
            raise AddonError(f"{error.filename or words[0]}: {error.strerror}; linecad was not started") from error
        # Both pipes are read as they fill, or the command would wait for ever.
        pipes = ((self._process.stderr, self._said), (self._process.stdout, self._told))
        self._readers = [threading.Thread(target=_read_all, args=pipe, daemon=True) for pipe in pipes]
        for reader in self._readers:
            reader.start()

    @property
    def stage(self) -> str:
        """What the command does at the moment, in words, and for how long it has been at work."""
        stages = [line for line in self._said if not line.startswith("linecad")]
        return f"{stages[-1] if stages else 'starting linecad'} ({time.monotonic() - self.started:.0f} s)"

    @property
    def is_done(self) -> bool:
        """Whether the command has ended and all that it said is here."""
        return self._process.poll() is not None and not any(reader.is_alive() for reader in self._readers)

    def wait(self) -> None:
        """Until the command has ended."""
        self._process.wait()
        for reader in self._readers:
            reader.join()

    @property
    def problem(self) -> str:
        """Why the command failed, in its own line; empty where it did not, is still at work or was ended."""
        code = self._process.returncode
        return failure(code, self._said) if code and not self.was_ended else ""

    def result(self) -> list[str]:
        """The lines that the command wrote to stdout; AddonError with its own line where it failed."""
        if self.was_ended:
            raise AddonError("cancelled; what was there before is as it was")
        if self.problem:
            raise AddonError(self.problem)
        return self._told

    def end(self) -> None:
        """End the command and what it started, and remove what it left half written."""
        if self._process.poll() is None:
            self.was_ended = True
            _signal(self._process, is_patient=True)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(PATIENCE)
            _signal(self._process, is_patient=False)  # what it started may be there still, and hold the pipes
        self.wait()
        if self.was_ended and self.folder is not None:
            for left in self.folder.glob(_LEFT):
                with contextlib.suppress(OSError):
                    left.unlink()


def _started(words: Sequence[str]) -> subprocess.Popen[str]:
    # A group of its own on POSIX, so that what the command starts ends with it; no console window on Windows.
    quiet = getattr(subprocess, "CREATE_NO_WINDOW", 0)
    return subprocess.Popen(  # noqa: S603, the command is the user's own
        list(words), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
        errors="replace", env=environment_for(os.environ), start_new_session=os.name == "posix", creationflags=quiet,
    )  # fmt: skip


def _read_all(pipe: IO[str], lines: list[str]) -> None:
    with pipe:
        for line in pipe:
            if line.strip():
                lines.append(line.rstrip())  # at once: somebody else looks at the last one


def _signal(process: subprocess.Popen[str], is_patient: bool) -> None:
    if sys.platform != "win32":
        with contextlib.suppress(ProcessLookupError, PermissionError):  # gone; so says macOS
            os.killpg(process.pid, signal.SIGTERM if is_patient else signal.SIGKILL)
    else:
        process.terminate()


def failure(code: int, lines: Sequence[str]) -> str:
    """What a command that failed said last, in one line and without its name."""
    if not lines:
        return f"linecad ended with {code} and gave no reason"
    name, colon, rest = lines[-1].partition(": ")
    return rest if colon and name.split(" ")[0] == "linecad" else lines[-1].strip()
