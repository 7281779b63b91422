"""JSON read strictly: a value that is not what it should be ends in one line that says where it stands.

A *node* is a JSON value with its *place*, the way to it from the top of the file, such as `lines[3].ends`.
"""

import json
import sys
from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LARGEST_EXACT = 2**53 - 1  # whole numbers up to here are the same in every program, also where all numbers are doubles
MOST_VALUES = 10_000_000  # in one text, at up to 100 bytes each in memory; a scene of 2,000 lines has 200,000
SHOWN_LENGTH = 40  # characters of a wrong value that are repeated in a message


class JsonError(ValueError):
    """The text is not JSON, or a value in it is not what its reader needs."""


@dataclass(frozen=True)
class Node:
    """A JSON value and its place; every method raises JsonError when the value is not what is asked for."""

    value: object
    place: str = ""

    def wrong(self, wanted: str) -> JsonError:
        """The error that says what stands here and what was wanted instead."""
        return JsonError(f"{self.place or 'the file'} is {_shown(self.value)}, expected {wanted}")

    def __getitem__(self, key: str) -> "Node":
        """The member `key`, which must be there."""
        member = self.get(key)
        if member is None:
            raise JsonError(f"{self._place_of(key)} is missing")
        return member

    def get(self, key: str) -> "Node | None":
        """The member `key`, or None where the object has none."""
        if not isinstance(self.value, dict):
            raise self.wrong("an object")
        return Node(self.value[key], self._place_of(key)) if key in self.value else None

    def _place_of(self, key: str) -> str:
        return f"{self.place}.{key}" if self.place else key

    def items(self) -> list["Node"]:
        """The elements of a list."""
        if not isinstance(self.value, list):
            raise self.wrong("a list")
        return [Node(value, f"{self.place}[{index}]") for index, value in enumerate(self.value)]

    def text(self) -> str:
        """A string."""
        if not isinstance(self.value, str):
            raise self.wrong("a string")
        return self.value

    def one_of(self, words: tuple[str, ...]) -> str:
        """One of these words."""
        if self.value not in words:
            raise self.wrong("one of " + ", ".join(words))
        return str(self.value)

    def boolean(self) -> bool:
        """True or false."""
        if not isinstance(self.value, bool):
            raise self.wrong("true or false")
        return self.value

    def number(self, largest: float = sys.float_info.max) -> float:
        """A number of absolute value at most `largest`; true and false are no numbers."""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            raise self.wrong("a number")
        if not abs(self.value) <= largest:  # also where it is not a number at all (NaN)
            limit = "" if largest == sys.float_info.max else f" of at most {largest:g}"
            raise self.wrong(f"a finite number{limit}")
        return float(self.value)

    def integer(self, smallest: int = 0, largest: int = LARGEST_EXACT) -> int:
        """A whole number; 3.0 is one, since JSON has but one kind of number."""
        value = self.value
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int) or not smallest <= value <= largest:
            raise self.wrong(f"a whole number from {smallest} to {largest}")
        return value

    def array(self, *shape: int | None, largest: float = sys.float_info.max) -> NDArray[np.float64]:
        """Numbers in nested lists of this shape, None standing for any length."""
        return np.array(self._numbers(shape, largest), np.float64).reshape([-1 if n is None else n for n in shape])

    def _numbers(self, shape: tuple[int | None, ...], largest: float) -> list[float]:
        """The numbers of an array, row by row."""
        if not shape:
            return [self.number(largest)]
        if not isinstance(self.value, list) or shape[0] not in (None, len(self.value)):
            raise self.wrong("a list" + ("" if shape[0] is None else f" of {shape[0]}"))
        return [number for item in self.items() for number in item._numbers(shape[1:], largest)]


def _shown(value: object) -> str:
    """A value as it may stand in a message of one line."""
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    try:
        text = json.dumps(value)
    except ValueError:  # Python refuses to print whole numbers of thousands of digits
        return "a number of too many digits"
    return text if len(text) <= SHOWN_LENGTH else text[:SHOWN_LENGTH] + "..."


def _without_duplicates(pairs: list[tuple[str, object]]) -> dict[str, object]:
    members = dict(pairs)
    if len(members) != len(pairs):
        counts = Counter(key for key, _ in pairs)
        twice = next(key for key, count in counts.items() if count > 1)
        raise JsonError(f"the key {_shown(twice)} stands twice in one object")
    return members


def _refuse_constant(token: str) -> object:
    raise JsonError(f"{token} stands for a number, which JSON does not allow")


def parse(text: str) -> Node:
    """The top of a JSON text.

    Raises JsonError when it is not JSON, has NaN or Infinity, has one key twice, nests too deeply, or holds so many
    values that they would not fit into memory.
    """
    if sum(map(text.count, ",[{")) > MOST_VALUES:
        raise JsonError(f"it holds more than {MOST_VALUES:,} values")
    try:
        return Node(json.loads(text, object_pairs_hook=_without_duplicates, parse_constant=_refuse_constant))
    except JsonError:
        raise
    except RecursionError:
        raise JsonError("lists or objects are nested too deeply") from None
    except json.JSONDecodeError as error:
        raise JsonError(f"not JSON: {error.msg} in line {error.lineno}, column {error.colno}") from None
    except ValueError:  # Python's guard against whole numbers of thousands of digits
        raise JsonError("a number has too many digits") from None
