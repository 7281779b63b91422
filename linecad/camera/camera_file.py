"""A photo's camera written to files: one that `--camera` reads again, an fSpy project, and a picture."""

import json
from pathlib import Path

from linecad.camera.report import CameraReport
from linecad.camera.text import facts, focal_words, place_words
from linecad.errors import OutputError
from linecad.io.files import write_atomically, write_text_atomically
from linecad.io.scene_document import certainty_document
from linecad.scene import AXES

SUFFIXES = (".json", ".fspy", ".png")


def check_suffix(path: Path) -> None:
    """Raise OutputError where `write_camera` knows no such file."""
    if path.suffix.lower() not in SUFFIXES:
        found = f"unknown suffix {path.suffix}" if path.suffix else "no suffix"
        raise OutputError(f"{path.name}: {found}; a camera is written as {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")


def write_camera(report: CameraReport, path: Path) -> None:
    """Write the camera as the suffix of `path` says, whole or not at all. Raises OutputError."""
    check_suffix(path)
    match path.suffix.lower():
        case ".json":
            write_text_atomically(path, json_of(report))
        case ".fspy":
            from exporters.fspy import write as fspy

            rotation, pixels = report.frame.rotation, report.photo.pixels
            write_atomically(
                path, lambda file: fspy.write_camera(report.camera, rotation, report.segments, file, pixels)
            )
        case _:
            _write_picture(report, path)


def json_of(report: CameraReport) -> str:
    """The camera file: `width`, `height`, `K` and `distortion` are of the photo as it was taken, as its reader wants.

    All other keys are for other programs, and of the photo without its distortion. A key a line.
    """
    taken, horizon = report.taken, report.horizon
    document = {
        "width": taken.width,
        "height": taken.height,
        "K": taken.matrix.tolist(),
        "distortion": list(taken.distortion),
        "photo": Path(report.photo.name).name.encode(errors="replace").decode(),
        "source": report.camera.source,
        "certainty": certainty_document(report.certainty),
        "R_cam_from_world": report.frame.rotation.tolist(),
        "horizon": None if horizon is None else horizon.tolist(),
        "vanishing_points": [
            {
                "axis": AXES[point.axis],
                "pixel": None if point.pixel is None else list(point.pixel),
                "direction": list(point.direction),
                "share": point.share,
            }
            for point in report.vanishing_points
        ],
        "notes": list(report.notes),
    }
    rows = [f" {json.dumps(key)}: {json.dumps(value, allow_nan=False)}" for key, value in document.items()]
    return "{\n" + ",\n".join(rows) + "\n}\n"


def _write_picture(report: CameraReport, path: Path) -> None:
    from exporters.picture.camera import CameraPicture, write

    points = report.vanishing_points
    picture = CameraPicture(
        camera=report.camera,
        rotation=report.frame.rotation,
        segments=report.segments,
        certainty=report.certainty,
        horizon=report.horizon,
        places=tuple(place_words(point) for point in points),
        shares=(*(point.share for point in points), report.unexplained),
        title=f"{Path(report.photo.name).name}: {focal_words(report.camera, report.certainty)}",
        facts=facts(report),
    )
    write_atomically(path, lambda file: write(picture, file, report.photo.pixels))
