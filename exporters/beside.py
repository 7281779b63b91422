"""What lies beside an export: the file and all that it refers to are there whole together, or as they were before.

Two kinds of file may lie there. *Parts* lie in a folder of the export's own, and the name of a part says what is in
it: two parts of one name are the same. A *library* is one text that may hold the entries of two versions.

So new parts come to lie among the old ones and replace none, then the file that refers to them takes the place of the
old one in one step, and then the old parts go. Whenever that is cut off, the file that is there finds all that it
refers to; parts that nothing refers to may be left in the folder and go with the next export. On the way from old to
new, the library has the entries of both.
"""

import contextlib
import hashlib
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from linecad.errors import OutputError
from linecad.io.files import check_output, write_atomically, write_bytes_atomically
from linecad.io.locks import waiting_for

_LONGEST = 200  # bytes; file systems take 255, and an ending follows
_UNSAFE = re.compile(r"[^\w.-]")  # blanks end a name in OBJ and MTL, and quotes may in USD
_DIGITS = 8  # of the digest that tells names apart which lose their unsafe characters


class Names(NamedTuple):
    """What a format calls the things beside one export, as seen from there."""

    folder: str  # of the parts; empty where the format has none
    library: str  # empty where the format has none


class SideFiles(NamedTuple):
    """What an export needs beside it."""

    parts: Mapping[str, bytes]  # by name
    library: str | None = None  # the text; None: no library is needed


NO_FILES = SideFiles({})


@dataclass(frozen=True)
class Beside:
    """Which files may lie beside the exports of a format: its row says so, and nobody else knows their names."""

    folder: str = ""  # ending of the folder that the parts lie in, such as `.textures`; empty: no parts
    part: re.Pattern[str] = re.compile(r"(?!)")  # the whole name of a part; other files in the folder are the user's
    library: str = ""  # ending of the library, such as `.mtl`; empty: no library
    keeps_name: bool = False  # readers find the library by the very name of the export, whatever it is

    def names(self, path: Path) -> Names:
        """The names for the export `path`: made of its own, fit for every reader, and unlike those of other exports."""
        stem = path.name if self.keeps_name else _safe(path.name)
        return Names(self.folder and stem + self.folder, self.library and stem + self.library)

    def places(self, path: Path) -> list[Path]:
        """The library and the folder that the export `path` may make or change, whether they are there or not."""
        names = self.names(path)
        return [path.with_name(name) for name in (names.library, names.folder) if name]

    def found(self, path: Path) -> list[Path]:
        """The files that lie beside the export `path` now, in a fixed order."""
        files = [
            file
            for place in self.places(path)
            for file in (sorted(place.iterdir()) if place.is_dir() else [place])
            if file.is_file()
        ]
        return [file for file in files if self.allows(path, file)]

    def allows(self, path: Path, file: Path) -> bool:
        """Whether `file` is one that the export `path` may have beside it, by its place and name alone."""
        names = self.names(path)
        if file.parent == path.parent:
            return bool(names.library) and file.name == names.library
        in_folder = bool(names.folder) and file.parent == path.with_name(names.folder)
        return in_folder and self.part.fullmatch(file.name) is not None

    def folders_in(self, folder: Path) -> list[Path]:
        """The folders of parts of all exports that lie in `folder`."""
        return [place for place in folder.glob(f"*{self.folder}") if place.is_dir()] if self.folder else []


NOTHING = Beside()


def _safe(name: str) -> str:
    readable = _UNSAFE.sub("_", os.fsencode(name).decode(errors="replace"))
    short = readable.encode()[:_LONGEST].decode(errors="ignore")
    if short == name:
        return name
    return f"{short}-{hashlib.sha256(os.fsencode(name)).hexdigest()[:_DIGITS]}"


def write_with_side_files(path: Path, beside: Beside, writer: Callable[[Path], SideFiles]) -> None:
    """Let `writer` make the file for `path` and return what it needs beside it, which is put there first.

    Whatever goes wrong, all is as it was before. Raises OutputError where something cannot be written.
    """
    check_output(path)
    with waiting_for(path.parent) as alone:
        change = _Change(path, beside)
        try:
            write_atomically(path, lambda temporary: change.begin(writer(temporary)))
        except BaseException:
            change.undo()
            raise
        change.finish(alone)


@dataclass
class _Change:
    """What lies beside one export, on the way from the old version to the new one."""

    path: Path
    beside: Beside
    needed: SideFiles = NO_FILES
    added: list[Path] = field(default_factory=list)  # parts that were not there
    replaced: bytes | None = None  # what was in the library, nothing if there was none; None: it was not touched

    @property
    def _folder(self) -> Path:
        return self.path.with_name(self.beside.names(self.path).folder)

    @property
    def _library(self) -> Path:
        return self.path.with_name(self.beside.names(self.path).library)

    def begin(self, needed: SideFiles) -> None:
        """Put the new files among the old ones."""
        assert all(map(self.beside.part.fullmatch, needed.parts)), f"{list(needed.parts)}, unlike the format's row"
        assert needed.library is None or self.beside.library, "a library, and none in the format's row"
        self.needed = needed
        if needed.parts:
            self._add_parts(needed.parts)
        if needed.library is not None:
            before = _read(self._library)
            write_bytes_atomically(self._library, needed.library.encode() + before)
            self.replaced = before

    def _add_parts(self, parts: Mapping[str, bytes]) -> None:
        folder = self._folder
        self.added = [folder / name for name in parts if not (folder / name).exists()]
        try:
            folder.mkdir(exist_ok=True)
        except OSError as error:
            raise OutputError(f"the folder {folder} beside {self.path} cannot be made: {error.strerror}") from error
        for name, data in parts.items():
            write_bytes_atomically(folder / name, data)

    def undo(self) -> None:
        """Take back what was begun."""
        with contextlib.suppress(OSError, OutputError):
            for part in self.added:
                part.unlink(missing_ok=True)
            if self.added:
                self._folder.rmdir()
        with contextlib.suppress(OSError, OutputError):
            if self.replaced:
                write_bytes_atomically(self._library, self.replaced)
            elif self.replaced is not None:
                self._library.unlink(missing_ok=True)

    def finish(self, alone: bool) -> None:
        """Remove what the new version, which is whole now, does not need; parts only where no other export works."""
        with contextlib.suppress(OSError, OutputError):
            if self.needed.library is not None:
                write_bytes_atomically(self._library, self.needed.library.encode())
            if alone:
                self._remove_old_parts()
                if self.needed.library is None and self.beside.library:
                    self._library.unlink(missing_ok=True)

    def _remove_old_parts(self) -> None:
        if not self.beside.folder:
            return
        folder = self._folder
        if not folder.is_dir():
            return
        for file in folder.iterdir():
            if self.beside.part.fullmatch(file.name) and file.name not in self.needed.parts:
                file.unlink()
        if not any(folder.iterdir()):
            folder.rmdir()


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return b""
    except OSError as error:
        raise OutputError(f"{path} is in the way and cannot be read: {error.strerror}; move it") from error
