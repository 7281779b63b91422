"""Take the photo out of an fSpy project, which is the photo as linecad measured it: fspy_photo.py PROJECT.fspy PHOTO"""

import struct
import sys
from pathlib import Path

MAGIC, VERSION = b"fspy", 1
HEADER = struct.Struct("<4sIII")  # magic, version, sizes of the state and of the picture in bytes


def main(project, target):
    """Write the picture that follows the state; ValueError where this is no whole project."""
    data = Path(project).read_bytes()
    magic, version, state, picture = HEADER.unpack_from(data)
    if (magic, version) != (MAGIC, VERSION) or len(data) != HEADER.size + state + picture:
        raise ValueError(f"{project} is no whole fSpy project of version {VERSION}")
    Path(target).write_bytes(data[HEADER.size + state :])


if __name__ == "__main__":
    main(*sys.argv[1:])
