"""Facts in words that a person would use."""

from linecad.corrections.edits import Cut, Fact, Foot, Meet, OnePlane, anchors_of
from linecad.directions import UP


def said(fact: Fact) -> str:
    """A fact in a few words, with its place in the photo."""
    (a, b), (c, d) = anchors_of(fact)[0].ends
    return f"{what_is_said(fact)} at ({(a + c) / 2:.0f}, {(b + d) / 2:.0f})"


def what_is_said(fact: Fact) -> str:
    """The kind of a fact."""
    match fact:
        case Meet():
            return "these meet"
        case OnePlane():
            return "same height" if fact.normal == UP else "one plane"
        case Foot():
            return "stands on the ground"
        case Cut():
            return "not connected"
        case _:
            return "a part of it stands here" if fact.part else "stands here"
