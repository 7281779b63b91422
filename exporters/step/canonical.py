"""One text for one STEP file: https://www.steptools.com/stds/step/IS_final_p21e3.html

OCCT writes the same model as another file each time. It lists the colours in the order of memory addresses, and the
ids of assembly parts come from a counter of the whole process. The geometry itself is always in the same order. So
the entities are numbered anew from the geometry on, and the colours are sorted by what they say in these numbers.
"""

import functools
import itertools
import re

_OCCURRENCE = re.compile(r"(?<=NEXT_ASSEMBLY_USAGE_OCCURRENCE\()\s*'[^']*'")
_STRING = re.compile(r"'(?:[^']|'')*'")
_STATEMENT = re.compile(r"(#\d+)\s*=\s*([^;]*);")
_BREAK = re.compile(r"\s*\n\s*")
_REFERENCE = re.compile(r"#\d+")
_REFERENCE_OR_STRING = re.compile(r"#\d+|'\d+'")
_STYLES = re.compile(r"(MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION\('\d+',\()([#\d,]+)(\),#\d+\))")


def canonical(text: str) -> str:
    """The same model as `text`, a whole STEP file of OCCT, in a form that does not depend on the process."""
    head, data = text.split("\nDATA;\n", 1)
    data, tail = data.rsplit("ENDSEC;", 1)
    counter = itertools.count(1)
    data = _OCCURRENCE.sub(lambda _: f"'{next(counter)}'", data)
    # Strings may hold any mark of the language, so they stand aside until the end, as their place among all strings.
    strings = sorted(set(_STRING.findall(data)))
    place = {string: f"'{number}'" for number, string in enumerate(strings)}
    data = _STRING.sub(lambda string: place[string[0]], data)

    entities = dict(_STATEMENT.findall(_BREAK.sub("", data)))
    order = _ordered(entities)
    final = {name: f"#{number}" for number, name in enumerate(order, start=1)}
    final |= {short: string for string, short in place.items()}
    lines = "\n".join(f"{name}={entities[name]};" for name in order)
    return f"{head}\nDATA;\n{_REFERENCE_OR_STRING.sub(lambda found: final[found[0]], lines)}\nENDSEC;{tail}"


def _ordered(entities: dict[str, str]) -> dict[str, int]:
    """The names of all entities in their new order, with their places; each list of styles is sorted in place."""
    referred = set(_REFERENCE.findall("\n".join(entities.values())))
    roots = [name for name in entities if name not in referred]
    lists = {name: found for name in roots if (found := _STYLES.fullmatch(entities[name]))}
    order: dict[str, int] = {}
    for root in roots:
        if root not in lists:
            _append(root, entities, order)

    @functools.cache  # most styles are those of many parts
    def described(name: str) -> str:
        """The entity's text, with the place of what is geometry and the text of what is not."""
        return _REFERENCE.sub(
            lambda other: f"#{order[other[0]]}" if other[0] in order else described(other[0]), entities[name]
        )

    for name, found in lists.items():
        before, styles, after = found.groups()
        entities[name] = before + ",".join(sorted(styles.split(","), key=described)) + after
    for name in sorted(lists, key=described):
        _append(name, entities, order)
    return order


def _append(root: str, entities: dict[str, str], order: dict[str, int]) -> None:
    """Append `root` and all that it refers to, depth first, where they have no place yet."""
    waiting = [root]
    while waiting:
        name = waiting.pop()
        if name not in order:
            order[name] = len(order)
            waiting += reversed(_REFERENCE.findall(entities[name]))
