"""A file and the pictures that it refers to, which lie in a folder named after it: whole together, or as before.

The name of a picture says what is in it. So new pictures come to lie among the old ones and replace none, then the
file that refers to them takes the place of the old one in one step, and then the old pictures go. Whenever that is
cut off, the file that is there finds all that it refers to; pictures that nothing refers to may be left in the folder
and go with the next export. A material library is on the way from old to new one that holds the materials of both.
"""

import contextlib
import hashlib
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from linecad.errors import OutputError
from linecad.io.files import check_output, write_atomically

if sys.platform != "win32":
    import fcntl

_OURS = re.compile(r"photo-[0-9a-f]{16}\.jpg")  # what may be removed from the folder; a user's own pictures stay
_FOLDER, _LIBRARY = ".textures", ".mtl"
_LONGEST = 200  # bytes; file systems take 255, and a suffix follows
_UNSAFE = re.compile(r"[^\w.-]")  # blanks end a name in OBJ and MTL, and quotes may in USD
_DIGITS = 8  # of the digest that tells names apart which lose their unsafe characters


def folder_name(path: Path) -> str:
    """The name of the folder beside `path` that its pictures lie in."""
    return _safe(path.name) + _FOLDER


def library_name(path: Path) -> str:
    """The name of the material library beside `path`."""
    return _safe(path.name) + _LIBRARY


def _safe(name: str) -> str:
    readable = _UNSAFE.sub("_", os.fsencode(name).decode(errors="replace"))
    short = readable.encode()[:_LONGEST].decode(errors="ignore")
    if short == name:
        return name
    return f"{short}-{hashlib.sha256(os.fsencode(name)).hexdigest()[:_DIGITS]}"


def write_with_pictures(
    path: Path, writer: Callable[[Path], None], pictures: Mapping[str, bytes], library: str | None = None
) -> None:
    """Let `writer` make the file for `path`, with its pictures by name in its folder and its material library.

    Whatever goes wrong, all is as it was before. Raises OutputError where something cannot be written.
    """
    check_output(path)
    folder, library_path = path.with_name(folder_name(path)), path.with_name(library_name(path))
    with _alone(path.parent) as alone:
        before = _read(library_path)
        added = [folder / name for name in pictures if not (folder / name).exists()]
        done = False
        try:
            _write_pictures(folder, pictures)
            if library is not None:
                write_atomically(library_path, _writing(library.encode() + before))
            write_atomically(path, writer)
            done = True
        finally:
            if not done:
                _take_back(added, library_path, before if library is not None else None)
        # What follows only tidies up: the file and all that it refers to are there.
        with contextlib.suppress(OSError, OutputError):
            if library is not None:
                write_atomically(library_path, _writing(library.encode()))
            if alone:
                _remove_old(folder, pictures)
                if library is None and before:
                    library_path.unlink()


def _write_pictures(folder: Path, pictures: Mapping[str, bytes]) -> None:
    if not pictures:
        return
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise OutputError(f"the folder {folder} for its pictures cannot be made: {error.strerror}") from error
    for name, data in pictures.items():
        write_atomically(folder / name, _writing(data))


def _writing(data: bytes) -> Callable[[Path], None]:
    def write(file: Path) -> None:
        file.write_bytes(data)

    return write


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return b""
    except OSError as error:
        raise OutputError(f"{path} is in the way and cannot be read: {error.strerror}; move it") from error


def _take_back(added: list[Path], library: Path, before: bytes | None) -> None:
    """Remove what a failed export has added. `before` is what the library held, None where it was not touched."""
    with contextlib.suppress(OSError, OutputError):
        for picture in added:
            picture.unlink(missing_ok=True)
        if added:
            added[0].parent.rmdir()
    with contextlib.suppress(OSError, OutputError):
        if before:
            write_atomically(library, _writing(before))
        elif before is not None:
            library.unlink(missing_ok=True)


def _remove_old(folder: Path, pictures: Mapping[str, bytes]) -> None:
    if folder.is_dir():
        for file in folder.iterdir():
            if _OURS.fullmatch(file.name) and file.name not in pictures:
                file.unlink()
        if not any(folder.iterdir()):
            folder.rmdir()


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[bool]:
    """Whether no other export works in this folder at the same time; one that does is waited for.

    Without this, one of two exports to the same name could remove pictures that the other one has just made.
    """
    if sys.platform == "win32":
        yield False
        return
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        yield False
        return
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            locked = True
        except OSError:  # some network file systems have no locks
            locked = False
        yield locked
    finally:
        os.close(descriptor)
