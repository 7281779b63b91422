"""One text for one 3DM file: https://developer.rhino3d.com/guides/opennurbs/opennurbs-overview/

openNURBS writes into a chunk of its own when a file was made and last changed. The bytes of a chunk end in a checksum,
the CRC-32 of those before it.
"""

import struct
import zlib

_REVISION_HISTORY = struct.pack("<I", 0x20008021)  # the type of the chunk, its length, 8 bytes, comes next
_MOMENT = struct.Struct("<8i")  # second, minute, hour, day, month from 0, year from 1900, day of week, day of year
_EPOCH = _MOMENT.pack(0, 0, 0, 1, 0, 70, 4, 0)  # Thursday, 1 January 1970
_CHECKSUM = struct.Struct("<I")


def without_dates(data: bytes) -> bytes:
    """The same file as `data`, made and changed at one fixed time; OSError where it has no such chunk as is known."""
    start = data.find(_REVISION_HISTORY) + len(_REVISION_HISTORY)
    (length,) = struct.unpack_from("<q", data, start)
    start += 8
    content = bytearray(data[start : start + length - _CHECKSUM.size])
    checksum = data[start + length - _CHECKSUM.size : start + length]
    if checksum != _CHECKSUM.pack(zlib.crc32(content)):
        raise OSError("the Rhino library writes its history in a way that is not known")
    for place in _moments(content):
        content[place : place + _MOMENT.size] = _EPOCH
    return data[:start] + bytes(content) + _CHECKSUM.pack(zlib.crc32(content)) + data[start + length :]


def _moments(content: bytearray) -> tuple[int, int]:
    """Where the two moments begin: each behind the name of a person, a text of 4 bytes of length and 2 a character."""
    first = 1 + 4 + 2 * _count(content, 1)
    second = first + _MOMENT.size
    return first, second + 4 + 2 * _count(content, second)


def _count(content: bytearray, place: int) -> int:
    """The characters of the text at a place."""
    count: int = struct.unpack_from("<I", content, place)[0]
    return count
