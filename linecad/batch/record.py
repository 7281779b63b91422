"""The record of a batch, `batch.jsonl`: one line of JSON a photo that was worked on, only ever added to.

A line is written at once and is on the disk before the batch goes on. A line that a crash cut off is no JSON any more;
it is closed by a line break when the record is opened again, and never read.
"""

import dataclasses
import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Self, cast

from linecad import __version__
from linecad.batch.job import STATUSES, Figures, Outcome, Status
from linecad.convert import Conversion
from linecad.depth.read import files_of_map
from linecad.errors import InputError, OutputError
from linecad.io.strict_json import JsonError, Node, parse
from linecad.scene import QUALITIES, Quality

NAME = "batch.jsonl"
LARGEST_RECORD = 2 * 2**30  # bytes; a million photos take about half of it
LARGEST_LINE = 2**20  # bytes


@dataclass(frozen=True)
class Row:
    """One line of the record."""

    photo: str  # absolute path
    sha256: str  # of its bytes; empty where they could not be read
    options: str  # hash of everything that decides what is made of them
    name: str  # of the made files, without suffix
    outcome: Outcome
    finished: str = ""  # UTC, ISO 8601
    depth: str = ""  # absolute path of the photo's depth map; empty where it had none


def options_hash(conversion: Conversion, suffixes: tuple[str, ...]) -> str:
    """64 hexadecimal digits that change with anything that decides what is made of a photo; InputError, OSError.

    Files, such as the calibration, count by what is in them; a depth map with what lies beside it and is read with it.
    """
    beside = [] if conversion.depth is None else files_of_map(conversion.depth)[1:]
    document = {
        "linecad": __version__,
        "suffixes": sorted(suffixes),
        "conversion": _plain(conversion),
        "beside": {file.name: _plain(file) for file in beside},
    }
    return hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()


def _plain(value: object) -> object:
    """A value of a conversion as JSON."""
    if dataclasses.is_dataclass(value):
        members = {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
        return {"": type(value).__name__, **members}  # two kinds of value may have the same members
    if isinstance(value, Path):
        try:
            with value.open("rb") as file:  # a depth map may be large
                return hashlib.file_digest(file, "sha256").hexdigest()
        except OSError as error:
            raise InputError(f"{value} cannot be read: {error.strerror}; check the name") from error
    if isinstance(value, dict):
        return {str(key): _plain(member) for key, member in value.items()}
    if isinstance(value, frozenset):
        return sorted(map(str, value))
    if isinstance(value, list | tuple):
        return [_plain(member) for member in value]
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"a conversion has a {type(value).__name__}, which has no lasting hash")


class Record:
    """The record of a folder, open for adding lines."""

    def __init__(self, path: Path) -> None:
        """Open or begin the record. Raises OutputError, or InputError where what is there is no record."""
        self.path = path
        self.damaged = 0  # lines that are none of ours: cut off by a crash, or changed by hand
        self.rows: list[Row] = []  # those that were there
        try:
            if path.exists() and not path.is_file():
                raise OutputError(f"{path} is not a file; choose another folder")
            self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
            if os.fstat(self._descriptor).st_size > LARGEST_RECORD:
                os.close(self._descriptor)
                raise InputError(f"{path} is larger than {LARGEST_RECORD // 2**30} GiB, too large for a record")
            self._read()
        except OSError as error:
            raise OutputError(f"{path} cannot be used: {error.strerror}; choose another folder") from error

    def _read(self) -> None:
        last = b"\n"
        with os.fdopen(os.dup(self._descriptor), "rb") as file:
            while line := file.readline(LARGEST_LINE):
                last = line
                row = parse_row(line)
                if row is None:
                    self.damaged += 1
                else:
                    self.rows.append(row)
        if not last.endswith(b"\n"):
            self._append(b"\n")

    def add(self, row: Row) -> None:
        """Add a line and return when it is on the disk. Raises OutputError."""
        try:
            self._append(row_line(row))
        except OSError as error:
            raise OutputError(
                f"{self.path} was not written: {error.strerror}; free space or mend the disk, then run it again"
            ) from error

    def _append(self, data: bytes) -> None:
        written = os.write(self._descriptor, data)
        while written < len(data):  # a full disk takes a part, and says why at the next try
            written += os.write(self._descriptor, data[written:])
        os.fsync(self._descriptor)

    def close(self) -> None:
        """No more lines."""
        os.close(self._descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()


def row_line(row: Row) -> bytes:
    """A row as a line of ASCII, names that are not UTF-8 as lone surrogates."""
    outcome = row.outcome
    figures = None if outcome.figures is None else dataclasses.asdict(outcome.figures)
    document = {
        "photo": row.photo,
        "depth": row.depth,
        "sha256": row.sha256,
        "options": row.options,
        "name": row.name,
        "status": outcome.status,
        "error": outcome.error,
        "seconds": round(outcome.seconds, 3),
        "cpu_seconds": round(outcome.cpu_seconds, 3),
        "memory_mb": round(outcome.memory_mb, 1),
        **({} if figures is None else figures),
        "files": outcome.files,
        "finished": row.finished,
    }
    return json.dumps(document, allow_nan=False).encode() + b"\n"


def parse_row(line: bytes) -> Row | None:
    """The row that a line tells, or None where it is damaged or leads out of the folder."""
    try:
        top = parse(line.decode("ascii"))
        outcome = Outcome(
            cast(Status, top["status"].one_of(STATUSES)),
            top["error"].text(),
            top["seconds"].number(),
            top["cpu_seconds"].number(),
            top["memory_mb"].number(),
            _figures(top) if top.get("lines") is not None else None,
            _files(top["files"]),
        )
        depth = top.get("depth")
        row = Row(
            photo=top["photo"].text(),
            sha256=top["sha256"].text(),
            options=top["options"].text(),
            name=top["name"].text(),
            outcome=outcome,
            finished=top["finished"].text(),
            depth="" if depth is None else depth.text(),
        )
    except (JsonError, UnicodeDecodeError):
        return None
    return row if _is_plain(row.name) and all(map(_is_within, outcome.files)) else None


def _figures(top: Node) -> Figures:
    gap, camera = top["gap"], top.get("camera")
    return Figures(
        lines=top["lines"].integer(),
        crossings=top["crossings"].integer(),
        real=top["real"].integer(),
        planes=top["planes"].integer(),
        faces=top["faces"].integer(),
        gap=None if gap.value is None else gap.number(),
        solver=top["solver"].text(),
        notes=tuple(note.text() for note in top["notes"].items()),
        camera=None if camera is None or camera.value is None else cast(Quality, camera.one_of(QUALITIES)),
    )


def _files(node: Node) -> dict[str, int]:
    if not isinstance(node.value, dict):
        raise node.wrong("an object")
    return {name: node[name].integer() for name in node.value}


def _is_plain(name: str) -> bool:
    """Whether a name is that of a file in the folder, neither hidden nor elsewhere."""
    return bool(name) and not name.startswith(".") and not set(name) & set("/\\\0\n")


def _is_within(file: str) -> bool:
    """Whether a file lies in the output folder or one folder below."""
    parts = file.split("/")
    return len(parts) <= 2 and all(map(_is_plain, parts))


def settled(row: Row, folder: Path) -> bool:
    """Whether a row tells of a photo that is done and whose files are all there, as large as they were made."""
    if row.outcome.status != "done":
        return False
    try:
        return all((folder / file).stat().st_size == size for file, size in row.outcome.files.items())
    except OSError:
        return False
