"""One text for one STEP file: https://www.steptools.com/stds/step/IS_final_p21e3.html

OCCT writes the same model as another file each time. It lists the colours in the order of memory addresses, and the
ids of assembly parts come from a counter of the whole process. The geometry itself is always in the same order. So
the entities are numbered anew from the geometry on, and the colours are sorted by what they say in these numbers.
"""

import functools
import itertools
import re
from collections.abc import Iterator

_OCCURRENCE = re.compile(r"(?<=NEXT_ASSEMBLY_USAGE_OCCURRENCE\()\s*'[^']*'")
_STRING = re.compile(r"('(?:[^']|'')*')")
_REFERENCE = re.compile(r"#\d+")
_REFERENCE_OR_STRING = re.compile(r"(#\d+|'\d+')")
_STYLES = re.compile(r"(MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION\('\d+',\()([#\d,]+)(\),#\d+\))")


def canonical(text: str) -> str:
    """The same model as `text`, a whole STEP file of OCCT, in a form that does not depend on the process."""
    head, data = text.split("\nDATA;\n", 1)
    data, tail = data.rsplit("ENDSEC;", 1)
    counter = itertools.count(1)
    data = _OCCURRENCE.sub(lambda _: f"'{next(counter)}'", data)
    # Strings may hold any mark of the language, so they stand aside until the end, as their place among all strings.
    parts = _STRING.split(data)  # every other one is a string
    strings = sorted(set(parts[1::2]))
    place = {string: f"'{number}'" for number, string in enumerate(strings)}
    entities = dict(_statements(_replaced(parts, place)))
    order = _ordered(entities)
    final = {name: f"#{number}" for number, name in enumerate(order, start=1)}
    final |= {short: string for string, short in place.items()}
    lines = "\n".join(f"{name}={entities[name]};" for name in order)
    return f"{head}\nDATA;\n{_replaced(_REFERENCE_OR_STRING.split(lines), final)}\nENDSEC;{tail}"


def _replaced(parts: list[str], by: dict[str, str]) -> str:
    """The text of parts, every other one of which stands for another."""
    # Some tens of thousands: half the time of a function that is called for each.
    parts[1::2] = map(by.__getitem__, parts[1::2])
    return "".join(parts)


def _statements(data: str) -> Iterator[tuple[str, str]]:
    """The name of each entity and what it is, without breaks of lines. Strings must stand aside."""
    for statement in "".join(map(str.strip, data.split("\n"))).split(";"):
        name, equals, entity = statement.partition("=")
        if equals:
            yield name.rstrip(), entity.lstrip()


def _ordered(entities: dict[str, str]) -> dict[str, int]:
    """The names of all entities in their new order, with their places; each list of styles is sorted in place."""
    refers = {name: _REFERENCE.findall(entity) for name, entity in entities.items()}
    referred = set(itertools.chain.from_iterable(refers.values()))
    roots = [name for name in entities if name not in referred]
    lists = {name: found for name in roots if (found := _STYLES.fullmatch(entities[name]))}
    order: dict[str, int] = {}
    for root in roots:
        if root not in lists:
            _append(root, refers, order)

    @functools.cache  # most styles are those of many parts
    def described(name: str) -> str:
        """The entity's text, with the place of what is geometry and the text of what is not."""
        return _REFERENCE.sub(
            lambda other: f"#{order[other[0]]}" if other[0] in order else described(other[0]), entities[name]
        )

    for name, found in lists.items():
        before, styles, after = found.groups()
        entities[name] = before + ",".join(sorted(styles.split(","), key=described)) + after
        refers[name] = _REFERENCE.findall(entities[name])
    for name in sorted(lists, key=described):
        _append(name, refers, order)
    return order


def _append(root: str, refers: dict[str, list[str]], order: dict[str, int]) -> None:
    """Append `root` and all that it refers to, depth first, where they have no place yet."""
    waiting = [root]
    while waiting:
        name = waiting.pop()
        if name not in order:
            order[name] = len(order)
            waiting += reversed(refers[name])
