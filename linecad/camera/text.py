"""A camera and how sure it is, in words for people: one line, or a table of a dozen."""

import math

from linecad.camera.report import Angle, CameraReport, VanishingPoint
from linecad.scene import AXES, Camera, Certainty

NAME_WIDTH = 19  # characters, of the names in the table
FINEST = 0.005  # px and degrees; smaller errors are not given with more digits

SOURCES = {
    "file": "the camera file",
    "focal option": "--focal",
    "exif": "EXIF",
    "vanishing points": "the vanishing points",
    "default": "nothing: a usual one is assumed",
}

GIVEN = ("file", "focal option")


def summary(camera: Camera, certainty: Certainty) -> str:
    """One line: focal length, its error, and how good the camera is."""
    return f"camera {certainty.quality}: {certainty.reason}; {focal_words(camera, certainty)} ({camera.source})"


def focal_words(camera: Camera, certainty: Certainty) -> str:
    """The focal length with its error, if it has one."""
    if certainty.focal is None:
        return f"focal length {camera.focal:.0f} px"
    return f"focal length {_estimate(camera.focal, certainty.focal)} px"


def table(report: CameraReport) -> list[str]:
    """Everything about the camera, a line each."""
    camera, certainty = report.camera, report.certainty
    across, along = (f"{math.degrees(angle):.1f}" for angle in report.field_of_view)
    rows = [
        ("photo", f"{' '.join(report.photo.name.split())}, {camera.width} x {camera.height} px"),
        ("quality", f"{certainty.quality}: {certainty.reason}"),
        ("focal length", _focal(report)),
        ("field of view", f"{across} degrees across, {along} from top to bottom"),
        ("principal point", _principal_point(camera, certainty)),
        ("radial distortion", _radial(camera, certainty)),
        ("camera from", SOURCES[camera.source]),
        ("tilt", tilt_words(report.tilt)),
        ("roll", roll_words(report.roll)),
        ("horizon", _horizon(report)),
    ]
    names = ["vanishing points", "", ""]
    for name, point in zip(names, report.vanishing_points, strict=True):
        place = place_words(point)
        if point.pixel is None:
            place += f", its lines at {_slope(point):.1f} degrees to the photo's rows"
        rows.append((name, f"{AXES[point.axis]}  {place}, {point.share:.0%} of the segment length"))
    rows.append(("", f"none of them: {report.unexplained:.0%}"))
    return [f"{name:{NAME_WIDTH}}{text}" for name, text in rows] + [f"note: {note}" for note in report.notes]


def facts(report: CameraReport) -> tuple[str, ...]:
    """What stands under the picture, short."""
    certainty = report.certainty
    across = math.degrees(report.field_of_view[0])
    found = [
        f"{report.equivalent:.0f} mm (35 mm equivalent), {across:.0f} degrees across",
        f"camera from {SOURCES[report.camera.source]}",
        f"tilt {tilt_words(report.tilt)}",
        f"roll {roll_words(report.roll)}",
    ]
    if certainty.center is not None:
        found.append(f"principal point ± {_error(certainty.center[0])}, ± {_error(certainty.center[1])} px")
    if any(report.camera.distortion):
        found.append(f"radial distortion {_radial(report.camera, certainty)}")
    return tuple(found)


def _slope(point: VanishingPoint) -> float:
    """Degrees, 0 to 180, by which lines to a point at infinity rise to the right."""
    x, y = point.direction
    return math.degrees(math.atan2(-y, x)) % 180


def tilt_words(tilt: Angle) -> str:
    """How far up or down the camera looks."""
    return _angle(tilt, "up", "down")


def roll_words(roll: Angle) -> str:
    """How far the camera is turned about its line of sight."""
    return _angle(roll, "clockwise", "counter-clockwise")


def _angle(angle: Angle, positive: str, negative: str) -> str:
    degrees, error = math.degrees(angle.value), math.degrees(angle.error)
    return f"{_estimate(abs(degrees), error)} degrees {positive if degrees >= 0 else negative}"


def _error(error: float) -> str:
    """A standard error with the digits that mean something."""
    return "0" if error < FINEST else f"{error:.{_digits(error)}f}"


def _estimate(value: float, error: float) -> str:
    """A number and its standard error, both with as many digits after the point."""
    return f"{value:.{_digits(error)}f} ± {_error(error)}"


def _digits(error: float) -> int:
    return 2 if error < 0.1 else 1 if error < 10 else 0


def _focal(report: CameraReport) -> str:
    camera, certainty = report.camera, report.certainty
    text = f"{camera.focal:.1f} px"
    if camera.source in GIVEN:
        text += ", as given"
    if certainty.focal is not None:
        text = f"{_estimate(camera.focal, certainty.focal)} px ({certainty.focal / camera.focal:.1%})"
    return f"{text}; {report.equivalent:.1f} mm (35 mm equivalent)"


def _principal_point(camera: Camera, certainty: Certainty) -> str:
    x, y = camera.matrix[:2, 2].tolist()
    if certainty.center is not None:
        return f"({_estimate(x, certainty.center[0])}, {_estimate(y, certainty.center[1])}) px"
    how = "as given" if camera.source == "file" else "the middle of the photo, assumed"
    return f"({x:.1f}, {y:.1f}) px, {how}"


def _radial(camera: Camera, certainty: Certainty) -> str:
    if not any(camera.distortion):
        return "none" if camera.source == "file" else "none removed"
    text = f"k1 = {camera.distortion[0]:.4f}"
    text += ", as given" if certainty.radial is None else f" ± {certainty.radial:.4f}, from the photo's own lines"
    return f"{text}; removed from the photo before measuring"


def _horizon(report: CameraReport) -> str:
    ends = report.horizon
    if ends is None:
        return "none: the camera looks straight up or down"
    (x, y), (u, v) = ends.tolist()
    return f"from ({x:.0f}, {y:.0f}) to ({u:.0f}, {v:.0f}) px"


def place_words(point: VanishingPoint) -> str:
    """Where a vanishing point lies."""
    return "at infinity" if point.pixel is None else f"({point.pixel[0]:.0f}, {point.pixel[1]:.0f}) px"
