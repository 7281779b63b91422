"""Corrections of the made scene: anchors of its lines, edits applied to them."""

import pytest

from linecad.corrections.apply import correct
from linecad.corrections.edits import Anchor, Corrections


@pytest.fixture(scope="session")
def anchor(made):
    """A function that names a line of the made scene by its number."""

    def named(line):
        (a, b), (c, d) = made.pixels[line].tolist()
        return Anchor(((a, b), (c, d)), int(made.axis[line]))

    return named


@pytest.fixture
def applied(made):
    """A function that applies edits to the exact lines of the made scene."""

    def apply(*edits, segments=None):
        corrections = Corrections("made.jpg", made.camera.width, made.camera.height, edits)
        return correct(made.segments if segments is None else segments, made.camera, made.frame, corrections)

    return apply
