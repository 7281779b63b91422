"""What a user can choose about one format alone, given as KEY=VALUE.

A format lists its options in FORMATS. Its `write` takes each as a keyword of the option's name, already read from the
text. Two formats may share an option; they then name the same record, so that a key means one thing.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from linecad.errors import OutputError

Value = bool | int | float | str

_SWITCH = {"on": True, "off": False}
_DECIMAL = re.compile(r"[0-9]{1,9}(\.[0-9]{1,9})?")


@dataclass(frozen=True)
class Option:
    """One choice. The kind of `default` says what is accepted: a bool on or off, a str one of `words`, an int or a
    float a number.

    Beside every choice stands what happens without it, so files are the same for everybody who chooses nothing.
    """

    key: str  # lower case, with hyphens, as the user writes it
    default: Value
    phrase: str  # what it does, for people
    words: tuple[str, ...] = ()  # what may be chosen where `default` is a str
    least: float = 0  # the smallest number where `default` is one
    most: float = 0  # the largest

    @property
    def name(self) -> str:
        """The key as a name in Python."""
        return self.key.replace("-", "_")

    @property
    def accepted(self) -> str:
        """What a value may be, for people."""
        if isinstance(self.default, bool):
            return "on or off"
        if isinstance(self.default, int):
            return f"a whole number from {self.least} to {self.most}"
        if isinstance(self.default, float):
            return f"a number from {self.least:g} to {self.most:g}"
        return " or ".join(self.words)

    @property
    def usual(self) -> str:
        """The default as the user would write it."""
        if isinstance(self.default, bool):
            return "on" if self.default else "off"
        return str(self.default)

    def read(self, text: str) -> Value:
        """The value that a text tells, in upper or lower case; OutputError where it is none that is accepted."""
        if isinstance(self.default, bool):
            if text.lower() in _SWITCH:
                return _SWITCH[text.lower()]
        elif isinstance(self.default, int):
            digits = len(text) <= len(str(self.most)) and text.isascii() and text.isdecimal()
            if digits and self.least <= int(text) <= self.most:
                return int(text)
        elif isinstance(self.default, float):
            if _DECIMAL.fullmatch(text) and self.least <= float(text) <= self.most:
                return float(text)
        else:
            for word in self.words:
                if text.lower() == word.lower():
                    return word
        raise OutputError(f"option {self.key} is {_shown(text)}, expected {self.accepted}")


def read_options(texts: Iterable[str], formats: Mapping[str, tuple[Option, ...]]) -> dict[str, Value]:
    """The values that texts KEY=VALUE give, by key; where a key stands twice, the last one counts.

    `formats` has the options of each suffix that will be written. Raises OutputError for a text of another form, a
    value that is not accepted, and a key that none of these formats has.
    """
    known = {option.key: option for options in formats.values() for option in options}
    values: dict[str, Value] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise OutputError(f"option {_shown(text)} has no value; write it like KEY=VALUE")
        if key not in known:
            given = f"has {', '.join(known)}" if known else "has no options"
            written = ", ".join(sorted(formats)) or "the scene file"
            raise OutputError(
                f"there is no option {_shown(key)} for {written}, which {given}; `linecad options` lists them all"
            )
        values[key] = known[key].read(value)
    return values


def _shown(text: str) -> str:
    return ascii(text[:40])
