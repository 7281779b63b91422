"""Arrays in .npy and .npz files, read without ever unpickling, and no larger than their headers and limits allow.

Format: docs of NumPy, `numpy.lib.format`, versions 1 to 3. NumPy's own reader takes memory for what a header promises
before it sees that the file is shorter; here the promise is compared with the file first.
"""

import ast
import math
import re
import struct
import zipfile
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from linecad.depth.depth_map import MOST_BYTES
from linecad.errors import DepthMapError

NPY_MAGIC = b"\x93NUMPY"
ZIP_MAGIC = b"PK"
LONGEST_HEADER = 10_000  # bytes, NumPy's own limit
MOST_ARRAYS = 64  # in one .npz; networks write up to a dozen
NUMBERS = re.compile(r"[<>|=]?(?:b1|[iu][1248]|f[248])")

Header = tuple[tuple[int, ...], np.dtype[Any], bool]  # shape, type, whether columns come first


class Archive:
    """The arrays of an .npz, of which headers are read at once and numbers when they are asked for."""

    def __init__(self, path: Path, archive: zipfile.ZipFile) -> None:
        """Raises DepthMapError where an array is none of numbers, or there are too many."""
        members = [info for info in archive.infolist() if info.filename.endswith(".npy")]
        if len(members) > MOST_ARRAYS:
            raise DepthMapError(f"{path} holds {len(members)} arrays, expected at most {MOST_ARRAYS}; keep the depth")
        self.path = path
        self._archive = archive
        self._members = {info.filename.removesuffix(".npy"): info for info in members}
        self.shapes: dict[str, tuple[int, ...]] = {}  # of the arrays of numbers; others, such as texts, are left alone
        for name, info in self._members.items():
            with archive.open(info) as stream:
                header = _read_header(stream, f"{name} in {path}")
            if header is not None:
                self.shapes[name] = header[0]

    def __contains__(self, name: str) -> bool:
        return name in self.shapes

    def read(self, name: str) -> NDArray[Any]:
        """The array of that name."""
        info = self._members[name]
        with self._archive.open(info) as stream:
            return _read_array(stream, info.file_size, f"{name} in {self.path}")


def read_npy(path: Path) -> NDArray[Any]:
    """The array of an .npy file. Raises DepthMapError where it is none of numbers, or cut off."""
    with path.open("rb") as stream:
        return _read_array(stream, path.stat().st_size, f"{path}")


def _read_array(stream: IO[bytes], size: int, where: str) -> NDArray[Any]:
    """The array that starts here, of `size` bytes with its header."""
    header = _read_header(stream, where)
    if header is None:
        raise DepthMapError(f"{where} holds Python objects or texts, which linecad never loads; save plain numbers")
    shape, kind, is_fortran = header
    needed = math.prod(shape) * kind.itemsize
    if needed > MOST_BYTES:
        raise DepthMapError(f"{where} would take over {MOST_BYTES / 1e9:.1f} GB, too much for depth; save that alone")
    if needed > size:
        raise DepthMapError(f"{where} is cut off: {size:,} of {needed:,} bytes are there; copy it again")
    data = stream.read(needed)
    if len(data) < needed:
        raise DepthMapError(f"{where} is cut off: {len(data):,} of {needed:,} bytes are there; copy it again")
    return np.frombuffer(data, kind).reshape(shape, order="F" if is_fortran else "C")


def _read_header(stream: IO[bytes], where: str) -> Header | None:
    """Shape and type of the array that starts here; None where it is not of real numbers."""
    damaged = DepthMapError(f"{where} is damaged: its header is not NumPy's; save it again")
    start = stream.read(8)
    if len(start) < 8 or start[:6] != NPY_MAGIC or start[6] not in (1, 2, 3):
        raise damaged
    count, code = (2, "<H") if start[6] == 1 else (4, "<I")
    told = stream.read(count)
    if len(told) < count or struct.unpack(code, told)[0] > LONGEST_HEADER:
        raise damaged
    try:
        record = ast.literal_eval(stream.read(struct.unpack(code, told)[0]).decode("latin-1").strip())
        descr, is_fortran, shape = record["descr"], record["fortran_order"], record["shape"]
    except (ValueError, SyntaxError, TypeError, KeyError, MemoryError, RecursionError) as error:
        raise damaged from error
    whole = isinstance(shape, tuple) and all(type(length) is int and length >= 0 for length in shape)
    if not whole or len(shape) > 8 or not isinstance(is_fortran, bool):
        raise damaged
    if not isinstance(descr, str) or not NUMBERS.fullmatch(descr):
        return None
    return shape, np.dtype(descr), is_fortran
