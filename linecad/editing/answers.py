"""What the page is sent of a state: all of it, or how it differs from one that the page has.

A photo's state is some megabytes, of which a word about bodies changes the ends of some lines. So each answer has a
number, the page names the one that it has, and is sent what has changed since. Where the server has forgotten that
one, or the page has none, the whole state is sent.
"""

import threading
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import Any

ITEMS = ("lines", "crossings", "planes", "bodies")  # lists whose items have an `id`, and all the same fields
KEPT = 6  # states that differences are told from: a second tab and a late answer find theirs

Document = Mapping[str, Any]


class Answers:
    """The states that were sent last, by their numbers; any thread may call."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._sent: OrderedDict[int, Document] = OrderedDict()
        self._number = 0

    def answer(self, state: Document, known: int | None = None) -> dict[str, Any]:
        """A state with its number as `answer`, or its `difference_of` the state of the number `known`."""
        with self._lock:
            self._number += 1
            self._sent[self._number] = state
            while len(self._sent) > KEPT:
                self._sent.popitem(last=False)
            number, before = self._number, None if known is None else self._sent.get(known)
        told = dict(state) if before is None else difference_of(before, state) | {"differs_from": known}
        return told | {"answer": number}


def difference_of(before: Document, state: Document) -> dict[str, Any]:
    """How a state differs from one before it; page/answers.js makes the state of both.

    `fields` are those that differ, by name, and `items` what differs in the lists of ITEMS.
    """
    items = {name: _difference_of_items(before[name], state[name]) for name in ITEMS}
    return {
        "fields": {name: value for name, value in state.items() if name not in ITEMS and value != before[name]},
        "items": {name: told for name, told in items.items() if told is not None},
    }


def _difference_of_items(before: Sequence[Document], items: Sequence[Document]) -> dict[str, Any] | None:
    """The `ids` in their order, where that is another, and those `changed`: an item's id with what is new of it."""
    if items is before:
        return None
    known = {item["id"]: item for item in before}
    changed = []
    for item in items:
        old = known.get(item["id"], {})
        new = {name: value for name, value in item.items() if name not in old or value != old[name]}
        if new:
            changed.append({"id": item["id"], **new})
    ids = [item["id"] for item in items]
    told = {} if ids == [item["id"] for item in before] else {"ids": ids}
    return {**told, "changed": changed} if told or changed else None
