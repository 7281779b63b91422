"""The bytes of a 3DM file without its dates."""

import base64
import struct
import zlib

import pytest

from exporters.rhino.archive import without_dates

rhino3dm = pytest.importorskip("rhino3dm", reason="the extra `rhino` is not installed")

HISTORY = struct.pack("<I", 0x20008021)


@pytest.fixture
def data():
    file = rhino3dm.File3dm()
    file.Objects.AddPoint(rhino3dm.Point3d(1, 2, 3))
    return base64.b64decode(file.Encode())


def history(data):
    """The content of the chunk and its checksum."""
    start = data.index(HISTORY) + 12
    (length,) = struct.unpack_from("<q", data, start - 8)
    return data[start : start + length - 4], data[start + length - 4 : start + length]


def test_the_moments_are_fixed_and_the_checksum_is_right(data):
    content, checksum = history(without_dates(data))
    epoch = struct.pack("<8i", 0, 0, 0, 1, 0, 70, 4, 0)
    assert content.count(epoch) == 2
    assert checksum == struct.pack("<I", zlib.crc32(content))
    assert epoch not in history(data)[0]


def test_nothing_else_changes_and_the_file_is_read(data):
    changed = without_dates(data)
    start = data.index(HISTORY)
    end = start + 12 + len(history(data)[0]) + 4
    assert len(changed) == len(data)
    assert (changed[:start], changed[end:]) == (data[:start], data[end:])
    (only,) = rhino3dm.File3dm.FromByteArray(changed).Objects
    assert only.Geometry.Location.Y == 2


def test_a_history_that_is_not_known_is_told(data):
    place = data.index(HISTORY) + 20
    broken = data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]
    with pytest.raises(OSError, match="in a way that is not known"):
        without_dates(broken)
