"""Depth in a portable float map: rows of single-precision numbers from the bottom up.

Format: `Pf`, width, height and scale in text, then the numbers; a negative scale says that they are little-endian.
"""

import re
from pathlib import Path

import numpy as np

from linecad.depth.depth_map import WHAT_TO_ASK_FOR, Content, Reading, check_size
from linecad.errors import DepthMapError

MAGICS = (b"Pf", b"PF")
LONGEST_HEADER = 256  # bytes
HEADER = re.compile(rb"(P[fF])\s+(\d{1,9})\s+(\d{1,9})\s+([+-]?[\d.]{1,20}(?:[eE][+-]?\d{1,2})?)\s")


def read_pfm(path: Path, _reading: Reading) -> Content:
    """The depth in a .pfm, which does not tell its kind. Raises DepthMapError."""
    with path.open("rb") as file:
        header = HEADER.match(file.read(LONGEST_HEADER))
        if header is None:
            raise DepthMapError(f"{path} is damaged: its header is not that of a .pfm; save it again")
        if header[1] == b"PF":
            raise DepthMapError(f"{path} is a coloured picture, not depth; {WHAT_TO_ASK_FOR}")
        width, height = int(header[2]), int(header[3])
        check_size(width, height, path)
        needed = width * height * 4
        file.seek(header.end())
        data = file.read(needed)
    if len(data) < needed:
        raise DepthMapError(f"{path} is cut off: {len(data):,} of {needed:,} bytes are there; copy it again")
    order = "<f4" if header[4].startswith(b"-") else ">f4"
    return Content(np.frombuffer(data, order).reshape(height, width)[::-1])
