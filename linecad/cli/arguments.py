"""Arguments that several commands share, and what their values may be."""

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import TypeAlias

    from exporters.options import Value
    from linecad.model.scale import Known
    from linecad.model.wanted import Wanted
    from linecad.options import Options

    Commands: TypeAlias = argparse._SubParsersAction["Parser"]

GROUPS = ("main", "all")  # as linecad.model.groups has them, which loads NumPy
DETAILS = ("none", "openings", "all")  # as linecad.model.choice has them, which loads NumPy
LONGEST_ID = 17  # digits; ids are below 2^53
LARGEST_PIXEL = 1e6
_LENGTH = "a known length: between two px of the photo, U,V:U,V=METRES, or of a line by its id, LINE=METRES"


class Parser(argparse.ArgumentParser):
    """An argument parser that says what is wrong in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        """End with exit code 2."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def add_outputs(parser: argparse.ArgumentParser) -> None:
    """The files to write."""
    parser.add_argument(
        "-o", "--output", type=Path, action="append", default=[], metavar="OUT",
        help="file to write; its suffix chooses the format (linecad export --formats); repeat for more",
    )  # fmt: skip


def add_camera(parser: argparse.ArgumentParser) -> None:
    """Where the camera comes from."""
    camera = parser.add_mutually_exclusive_group()
    camera.add_argument(
        "--camera", type=Path, metavar="FILE",
        help='calibration: JSON with width, height, K, "distortion", or an fSpy project',
    )  # fmt: skip
    camera.add_argument(
        "--focal", type=positive, metavar="PX", help="focal length in px; else EXIF, else vanishing points"
    )


def add_depth(parser: argparse.ArgumentParser) -> None:
    """A depth map of the one photo."""
    parser.add_argument("--depth", type=Path, metavar="FILE", help="depth map of the photo, from a network or a phone")


def add_depth_maps(parser: argparse.ArgumentParser) -> None:
    """Depth maps of many photos."""
    parser.add_argument(
        "--depth-maps", action="store_true", help="use depth maps that lie beside the photos (photo.depth.npz, ...)"
    )


def add_reconstruction(parser: argparse.ArgumentParser, options: str) -> None:
    """How a photo is reconstructed; `options` says whose keys --option takes."""
    parser.add_argument("--fast", action="store_true", help="a robust fit in tenths of a second, nothing proven")
    parser.add_argument(
        "--time-limit", type=positive, metavar="S", help="seconds for the solver (none; gain 10, paper 60)"
    )
    add_option(parser, options)


def add_option(parser: argparse.ArgumentParser, options: str) -> None:
    """What has no argument of its own."""
    parser.add_argument(
        "--option", action="append", default=[], metavar="KEY=VALUE",
        help=f"{options}; linecad options lists them all; repeat for more",
    )  # fmt: skip


def add_scale(parser: argparse.ArgumentParser) -> None:
    """A known length."""
    scale = parser.add_mutually_exclusive_group()
    scale.add_argument("--scale", type=_length, dest="known", metavar="WHAT=METRES", help=_LENGTH)
    add_camera_height(scale)


def add_length(parser: argparse.ArgumentParser) -> None:
    """A known length, where --scale is the scale of a drawing."""
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--length", type=_length, dest="known", metavar="WHAT=METRES", help=_LENGTH)
    add_camera_height(length)


def add_camera_height(parser: "argparse._ActionsContainer") -> None:
    """A known height."""
    parser.add_argument(
        "--camera-height", type=_camera_height, dest="known", metavar="METRES",
        help="of the camera above the ground",
    )  # fmt: skip


def add_confidence(parser: argparse.ArgumentParser) -> None:
    """How sure a line must be to be written."""
    parser.add_argument(
        "--confidence", type=_probability, metavar="P",
        help="leave out lines less likely right than P, 0 to 1",
    )  # fmt: skip


def add_groups(parser: argparse.ArgumentParser) -> None:
    """Which groups of lines are written."""
    parser.add_argument(
        "--groups", choices=GROUPS, default="all", metavar="WHICH",
        help="of lines: main (component 0) or all (all)",
    )  # fmt: skip


def add_main(parser: argparse.ArgumentParser) -> None:
    """What the scene is about."""
    parser.add_argument(
        "--main", type=_place, metavar="U,V",
        help="a place in the photo, px, that component 0 is at",
    )  # fmt: skip


def add_detail(parser: argparse.ArgumentParser) -> None:
    """Which lines are written."""
    parser.add_argument(
        "--detail", choices=DETAILS, default="all", metavar="WHAT",
        help="lines beside outlines: none, openings or all (all)",
    )  # fmt: skip


def add_loudness(parser: argparse.ArgumentParser) -> None:
    """How much progress is shown."""
    loudness = parser.add_mutually_exclusive_group()
    loudness.add_argument("--quiet", action="store_true", help="no progress")
    loudness.add_argument("--verbose", action="store_true", help="the time of every stage")


def wanted_of(parsed: argparse.Namespace) -> "Wanted":
    """What of a scene is to be written, and at which scale."""
    from linecad.model.wanted import Wanted

    main = getattr(parsed, "main", None)  # a batch has none: photos show what they show at other places
    return Wanted(main, parsed.known, parsed.groups, parsed.confidence, parsed.detail)


def reconstruction_of(parsed: argparse.Namespace, texts: "Iterable[str]") -> "Options":
    """The options of a reconstruction from --fast, --time-limit and texts KEY=VALUE.

    Raises OptionError for a key or value that is not accepted, SolverError for what does not go together.
    """
    from linecad.options import Options, read_options
    from solver.options import SolveOptions

    return read_options(texts, Options(solve=SolveOptions(time_limit_s=parsed.time_limit, fast=parsed.fast)))


def options_of(parsed: argparse.Namespace, outputs: "Sequence[Path]") -> "tuple[Options, dict[str, Value]]":
    """The options of a reconstruction, and those of the formats of `outputs` by key, from one list of KEY=VALUE.

    Raises as `reconstruction_of`, and OutputError for an unknown format, or a key that neither has.
    """
    from exporters.formats import SCENE_FILE, options_for
    from linecad.options import is_switch

    own = [text for text in parsed.option if is_switch(text)]
    others = [text for text in parsed.option if not is_switch(text)]
    values = options_for([path for path in outputs if path.suffix.lower() != SCENE_FILE], others)
    return reconstruction_of(parsed, own), values


def count(text: str) -> int:
    """A whole number of 1 or more."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of 1 or more")
    return int(text)


def positive(text: str) -> float:
    """A finite number above zero."""
    value = _not_negative(text)
    if value == 0:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def identity(text: str) -> int:
    """A whole number of 0 or more, as ids are."""
    if not (text.isascii() and text.isdecimal() and len(text) < LONGEST_ID):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of 0 or more")
    return int(text)


def _not_negative(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
    if not 0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a number of zero or more")
    return value


def _probability(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not 0 <= value <= 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0 to 1")
    return value


def _length(text: str) -> "Known":
    from linecad.model.scale import LineLength, PointDistance

    what, equals, length = text.rpartition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text!r} is no length; write it like 840,310:840,655=2.1 or 45237=3.5")
    metres = positive(length)
    if what.isascii() and what.isdecimal() and len(what) < LONGEST_ID:
        return LineLength(int(what), metres)
    numbers = re.split("[,:]", what)
    if len(numbers) != 4 or not re.fullmatch("[^:]*:[^:]*", what):
        raise argparse.ArgumentTypeError(f"{what!r} is neither the id of a line nor two px like 840,310:840,655")
    a, b, c, d = map(_pixel, numbers)
    return PointDistance(((a, b), (c, d)), metres)


def _place(text: str) -> tuple[float, float]:
    numbers = text.split(",")
    if len(numbers) != 2:
        raise argparse.ArgumentTypeError(f"{text!r} is no place in a photo; write it like 840,310")
    u, v = map(_pixel, numbers)
    return u, v


def _pixel(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of px") from None
    if not abs(value) <= LARGEST_PIXEL:
        raise argparse.ArgumentTypeError(f"{text} px lies outside every photo")
    return value


def _camera_height(text: str) -> "Known":
    from linecad.model.scale import CameraHeight

    return CameraHeight(positive(text))
