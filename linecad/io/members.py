"""Members of scene files that may be missing, and ids."""

from linecad.io.strict_json import JsonError, Node

LARGEST_NUMBER = 1e12  # px, scene units and metres: beyond it a double keeps less than a tenth of a millimetre


def optional_items(node: Node, key: str) -> list[Node]:
    """The items of the member `key`; none where it is missing."""
    member = node.get(key)
    return [] if member is None else member.items()


def optional_boolean(node: Node, key: str) -> bool:
    """The member `key`; false where it is missing."""
    member = node.get(key)
    return member is not None and member.boolean()


def known_member(node: Node, key: str) -> Node | None:
    """The member `key` where it is neither missing nor null."""
    member = node.get(key)
    return None if member is None or member.value is None else member


def count_or_zero(node: Node | None) -> int:
    """A count that files written before it was known do not have."""
    return 0 if node is None else node.integer()


def distinct_ids(nodes: list[Node]) -> list[int]:
    """The ids at these nodes, no two the same."""
    places: dict[int, str] = {}
    for node in nodes:
        number = node.integer()
        if number in places:
            raise JsonError(f"{node.place} is {number}, as is {places[number]}, expected different ids")
        places[number] = node.place
    return list(places)


def line_ids(node: Node, known: set[int]) -> list[int]:
    """The ids of lines of the scene, no two the same."""
    ids = distinct_ids(node.items())
    for item, number in zip(node.items(), ids, strict=True):
        if number not in known:
            raise JsonError(f"{item.place} is {number}, but no line has this id")
    return ids
