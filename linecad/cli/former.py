"""Arguments of earlier versions: each ends the command with exit code 2 and a line that names the new spelling."""

import argparse
import re
from collections.abc import Sequence
from typing import Any

PLAIN = re.compile(r"[\w.,+-]{1,40}")  # values that a message repeats
SWITCHED = {  # without a value: the option that they set
    "--collinear": "collinear=on",
    "--no-collinear": "collinear=off",
    "--faint": "faint=on",
    "--largest-component": "largest-component=on",
}
OBJECTIVE = ("--weights", "--mu-planarity", "--mu-boundary")
VALUED = (*OBJECTIVE, "--formulation", "--backend", "--without", "--gap", "--seed", "--extension")
GONE = {"--witnesses": "--witnesses is gone; use --option joins=stable, biconnected or all"}
GONE_VALUES = {("--weights", "fitted"): "--weights fitted is gone, it measured no better than odds"}
ALL = (*VALUED, *SWITCHED, *GONE)


def add_former(parser: argparse.ArgumentParser, flags: Sequence[str] = ALL) -> None:
    """Take former `flags`, which no help shows, and say what they are now."""
    for flag in flags:
        parser.add_argument(flag, action=_Former, nargs=0 if flag in SWITCHED else "?", help=argparse.SUPPRESS)


class _Former(argparse.Action):
    def __call__(
        self, parser: argparse.ArgumentParser, _namespace: object, values: Any, _option: str | None = None
    ) -> None:
        """End the command."""
        flag = self.option_strings[0]
        parser.exit(2, f"{parser.prog}: {new_spelling(flag, values or None)}\n")


def new_spelling(flag: str, value: str | None) -> str:
    """What a former flag with its value is now, in one line."""
    if flag in GONE:
        return GONE[flag]
    if flag in SWITCHED:
        return f"{flag} is now --option {SWITCHED[flag]}"
    if value is not None and (flag, value) in GONE_VALUES:
        return GONE_VALUES[flag, value]
    shown = value if value is not None and PLAIN.fullmatch(value) else "VALUE"
    return f"{flag} {shown} is now --option {flag.removeprefix('--')}={shown}"
