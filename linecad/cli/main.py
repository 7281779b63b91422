"""The command line: options, one call into the library, one line of output.

Results go to stdout or files, progress to stderr. Exit codes: 0 done, 1 an error that the user can act on (one line on
stderr), 2 wrong usage. argparse, because it costs nothing to load: `--help` answers at once and without any library.
"""

import argparse
import atexit
import gc
import importlib.util
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from linecad import __version__
from linecad.cli import addon, batch, camera, convert, dataset, edit, elevation, evaluate, export, options
from linecad.cli.arguments import Parser
from linecad.errors import LinecadError

COLLECT_EVERY = 100_000  # objects; at Python's 700 the loading of libraries is interrupted a thousand times


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the exit code."""
    gc.set_threshold(COLLECT_EVERY)
    atexit.register(gc.freeze)  # what the libraries made goes with the process: to look at it once more takes 0.3 s
    parsed = _parser().parse_args(arguments)
    try:
        check_packages()
        code: int = parsed.run(parsed)
        sys.stdout.flush()
    except LinecadError as error:
        print(f"linecad: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        if not _is_cut_off():
            raise  # another pipe than the output's: a fault of ours
        return 1
    except KeyboardInterrupt:
        print("linecad: interrupted; a file that was not written yet is as it was before", file=sys.stderr)
        return 1
    return code


def _is_cut_off() -> bool:
    """Whether who reads the output has seen enough, as in `linecad options | head`; then the rest goes nowhere."""
    try:
        print(flush=True)  # only another write tells
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python would complain again at exit
        return True
    return False


def check_packages() -> None:
    """Raise LinecadError when a file of the user's hides one of our packages with a generic name."""
    home = Path(__file__).resolve().parents[2]
    for name in ("solver", "exporters"):
        spec = importlib.util.find_spec(name)
        found = Path(spec.origin).resolve() if spec and spec.origin else None
        if found != home / name / "__init__.py":
            raise LinecadError(
                f"linecad's package '{name}' is hidden by {found or 'nothing installed'}; "
                "start linecad from another folder, or install linecad in an environment of its own"
            )


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="linecad", description="From one photo of a Manhattan scene to 3D lines, planes and CAD files."
    )
    parser.add_argument("--version", action="version", version=f"linecad {__version__}")
    commands = parser.add_subparsers(dest="command", required=True)
    for command in (convert, camera, batch, edit, evaluate, export, elevation, addon, options, dataset):
        command.add_to(commands)
    return parser
