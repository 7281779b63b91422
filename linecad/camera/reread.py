"""The photo of a scene read again, so that its pixels are those that the scene was measured in."""

from pathlib import Path

from linecad.camera.photo import Photo, read_photo, read_photo_of
from linecad.errors import CameraError, PhotoError
from linecad.scene import Camera

SAME_CAMERA = 1e-9  # of the focal length, by which rounding may change a calibration


def find_beside(photo: str, scene_file: Path) -> Path | None:
    """The photo of that name beside a scene file; None where there is none.

    Only its name counts: a scene file does not send us to other folders.
    """
    path = scene_file.parent / Path(photo).name
    return path if path.is_file() else None


def reread_photo(path: Path, name: str, camera: Camera, camera_file: Path | None = None) -> Photo:
    """The photo of a scene, which calls it `name`, with the pixels of the scene's `camera`.

    The camera tells how the photo was straightened; where `camera_file` is given, it must tell the same. Scenes of
    earlier versions do not tell fy of pixels that were not square, so that they need it. Raises PhotoError or
    CameraError where file or calibration are missing, or not the scene's.
    """
    if camera_file is None and camera.is_resampled and camera.taken_fy is None:
        raise CameraError(f"{name} was straightened by its calibration; give that with --camera")
    if camera_file is None and (camera.distortion or camera.taken_fy is not None):
        return read_photo_of(path, camera)
    photo = read_photo(path, camera_file, None if camera_file else camera.focal)
    check_size(photo, path, camera)
    if photo.camera is not None and camera_file is not None:
        same = abs(photo.camera.matrix - camera.matrix).max() <= SAME_CAMERA * camera.focal
        if not same or photo.camera.distortion != camera.distortion:
            raise CameraError(f"{camera_file} is not the calibration that the scene was made with; give that one")
    return photo


def check_size(photo: Photo, path: Path, camera: Camera) -> None:
    """Raise PhotoError unless a photo has the size of the scene's."""
    if (photo.width, photo.height) != (camera.width, camera.height):
        raise PhotoError(
            f"{path} has {photo.width} x {photo.height} px, the scene's photo {camera.width} x {camera.height}; "
            "name the right one with --photo"
        )
