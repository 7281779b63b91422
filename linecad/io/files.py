"""Files that appear whole or not at all."""

import contextlib
import errno
import os
import secrets
import shutil
import stat
from collections.abc import Callable
from pathlib import Path

from linecad.errors import LinecadError, OutputError

# The hidden name says nothing about the result: no library can copy the result's name out of it into the file.
UNFINISHED = ".linecad-"  # what the names of files and folders begin with that are gone when their writer is done
_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
_FORBIDDEN = {errno.EACCES, errno.EPERM, errno.EROFS}


def check_output(path: Path) -> None:
    """Raise OutputError where no file can be written at `path`, before any work is done for it."""
    shown = _shown(path)
    try:
        if path.is_dir():
            raise OutputError(f"{shown} is a folder; give the name of a file in it")
        if not path.parent.is_dir():
            raise OutputError(f"the folder {_shown(path.parent)} does not exist; make it first")
        with contextlib.suppress(FileNotFoundError):
            if not stat.S_ISREG(path.stat().st_mode):
                raise OutputError(f"{shown} is not a regular file; give another name")
            if not _allowed(path, os.W_OK):
                raise OutputError(f"{shown} is write-protected; give another name or change its mode")
        if not _allowed(_target(path).parent, os.W_OK | os.X_OK):
            raise OutputError(f"the folder {_shown(path.parent)} cannot be written; choose another one")
    except (OSError, ValueError) as error:  # a name that is too long, or that holds a null character
        raise OutputError(f"{shown} cannot be used as a file name: {_reason(error)}; give another name") from error


def write_atomically(path: Path, writer: Callable[[Path], None]) -> None:
    """Let `writer` make a file beside `path` under a hidden name, then put it in the place of `path` in one step.

    The hidden name has the suffix of `path` in lower case, for libraries that choose a format by it. Whatever goes
    wrong, `path` keeps what it held before and the hidden file goes. A symbolic link stays, and what it points to is
    replaced; a file that was there keeps its mode. Raises OutputError where the file cannot be written, such as on a
    full disk: a writer says so by raising any OSError.
    """
    check_output(path)
    try:
        target = _target(path)
        temporary, mode = _reserve(target)
        try:
            writer(temporary)
            _flush(temporary)
            temporary.chmod(mode)  # a library may have put a file of its own in the place of the reserved one
            temporary.replace(target)
        finally:
            temporary.unlink(missing_ok=True)
        _flush_folder(target.parent)
    except OSError as error:
        raise _output_error(path, error) from error


def remove_unfinished(folder: Path) -> None:
    """Remove what writers that were killed left in a folder, where none is at work. Raises OSError."""
    for left in folder.glob(f"{UNFINISHED}*"):
        if left.is_dir() and not left.is_symlink():
            shutil.rmtree(left)
        else:
            left.unlink()


def write_text_atomically(path: Path, text: str) -> None:
    """The same for a text: UTF-8, lines ending as they do in `text` on every system."""
    write_atomically(path, lambda file: _write_text(file, text))


def write_bytes_atomically(path: Path, data: bytes) -> None:
    """The same for bytes."""
    write_atomically(path, lambda file: _write_bytes(file, data))


def _write_bytes(file: Path, data: bytes) -> None:
    file.write_bytes(data)


def _write_text(file: Path, text: str) -> None:
    file.write_text(text, encoding="utf-8", newline="\n")


def _allowed(path: Path, mode: int) -> bool:
    return os.access(path, mode, effective_ids=os.access in os.supports_effective_ids)


def _target(path: Path) -> Path:
    """Where the file comes to lie: through links, so that a link stays one."""
    return Path(os.path.realpath(path))  # Path.resolve raises on a circle of links in Python before 3.13


def _reserve(target: Path) -> tuple[Path, int]:
    """Make an empty file beside `target` under a name that nobody else uses; also the mode that the result gets."""
    while True:
        temporary = target.with_name(f"{UNFINISHED}{secrets.token_hex(8)}{target.suffix.lower()}")
        with contextlib.suppress(FileExistsError):
            # open, and not tempfile, whose files only their owner may read: the user's umask decides here.
            os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
            break
    try:
        return temporary, stat.S_IMODE(target.stat().st_mode)
    except FileNotFoundError:
        return temporary, stat.S_IMODE(temporary.stat().st_mode)


def _flush(file: Path) -> None:
    """Return when the file's bytes are on the disk, so that a power cut cannot leave a name without content."""
    with file.open("rb+") as stream:
        os.fsync(stream.fileno())


def _flush_folder(folder: Path) -> None:
    # Some file systems, and Windows, cannot do this; the file itself is whole in any case.
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _output_error(path: Path, error: OSError) -> OutputError:
    shown = _shown(path)
    if error.errno in _FULL:
        return OutputError(f"{shown} was not written: no space is left for it; free some or choose another disk")
    if error.errno in _FORBIDDEN:
        return OutputError(f"{shown} was not written: writing there is not allowed; choose another folder")
    if error.errno == errno.ENAMETOOLONG:
        return OutputError(f"{shown} was not written: the name is too long; give a shorter one")
    return OutputError(f"{shown} was not written: {_reason(error)}; check the disk or choose another folder")


def _reason(error: OSError | ValueError) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


def _shown(path: Path) -> str:
    """The path on one line, printable even where its name is not UTF-8."""
    return " ".join(os.fsencode(path).decode(errors="replace").splitlines()) or "."


def read_text(path: str | os.PathLike[str], largest: int, name: str, error: type[LinecadError]) -> str:
    """The text of a file of at most `largest` bytes in UTF-8; an `error` that calls it by `name` where it is not so."""
    shown = " ".join(str(path).splitlines())
    try:
        with Path(path).open("rb") as file:
            size = os.fstat(file.fileno()).st_size
            data = file.read(largest + 1) if size <= largest else b""
    except (OSError, ValueError) as failure:  # ValueError: a path with a null character
        reason = failure.strerror if isinstance(failure, OSError) else str(failure)
        raise error(f"{shown} cannot be read: {reason}; give a {name}") from failure
    if max(size, len(data)) > largest:
        raise error(f"{shown} is larger than {largest // 2**20} MiB; a {name} is smaller")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as failure:
        raise error(f"{shown}: byte {failure.start} is not UTF-8; give a {name}, saved as UTF-8") from None
