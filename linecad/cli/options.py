"""`linecad options`: everything that --option KEY=VALUE takes."""

import argparse
import textwrap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from linecad.cli.arguments import Commands

WIDTH = 80  # characters


def add_to(commands: "Commands") -> None:
    """Add the command."""
    command = commands.add_parser(
        "options",
        help="list what --option KEY=VALUE takes",
        description="List all options that are given as KEY=VALUE, with what they take and their defaults.",
        epilog="example: linecad convert facade.jpg -o facade.glb --option extension=60 --option tubes=on",
    )
    command.set_defaults(run=run)


def run(_parsed: argparse.Namespace) -> int:
    """Print them."""
    from exporters.formats import FORMATS
    from linecad.options import SWITCHES

    print("--option KEY=VALUE of the reconstruction, for convert, batch, edit and evaluate:")
    for switch in SWITCHES:
        _print(switch.key, switch.phrase, switch.accepted, switch.usual)
    print("\n--option KEY=VALUE of formats, for convert, batch and export:")
    for option in dict.fromkeys(option for row in FORMATS.values() for option in row.options):
        suffixes = [suffix for suffix, row in FORMATS.items() if option in row.options]
        _print(option.key, f"{', '.join(suffixes)}: {option.phrase}", option.accepted, option.usual)
    return 0


def _print(key: str, phrase: str, accepted: str, usual: str) -> None:
    text = f"{phrase}; {accepted} (default: {usual})"
    print(textwrap.fill(text, WIDTH, initial_indent=f"  {key:<18}", subsequent_indent=" " * 20))
