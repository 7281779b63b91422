"""What counts as far from an edit."""

import numpy as np
import pytest

from linecad.corrections.edits import Anchor, Cut, Delete, LabelCrossing, SetFrame, Split
from linecad.editing.distant import FAR, distant

WIDTH = 3840
LINE = Anchor(((1000.0, 1000.0), (2000.0, 1000.0)), 0)
OTHER = Anchor(((1000.0, 1400.0), (1000.0, 2400.0)), 2)


def far(edits, *places):
    return distant(range(len(places)), {k: np.array(place) for k, place in enumerate(places)}, edits, WIDTH)


@pytest.mark.parametrize(("off", "is_far"), [(0.0, False), (199.0, False), (201.0, True)])
@pytest.mark.parametrize("edit", [Delete(LINE), LabelCrossing((LINE, OTHER), (1500.0, 1000.0), "real")])
def test_it_is_measured_from_all_that_the_edit_names(edit, off, is_far):
    assert far([edit], (1500.0, 1000.0 - off)) == ({0} if is_far else set())
    assert far([edit], (2000.0 + off, 1000.0)) == ({0} if is_far else set())


def test_what_is_near_one_of_the_edits_is_not_far():
    places = (1500.0, 1100.0), (1000.0, 2000.0), (3000.0, 2000.0)
    assert far([Delete(LINE)], *places) == {1, 2}
    assert far([Delete(LINE), Split(OTHER, (1000.0, 2000.0))], *places) == {2}


def test_a_point_that_an_edit_names_counts():
    assert far([Split(LINE, (3000.0, 2000.0))], (3000.0, 2000.0 + FAR.at_reference / 2)) == frozenset()


@pytest.mark.parametrize("edit", [SetFrame((LINE,)), Cut((LINE, OTHER))])
def test_edits_about_the_whole_photo_ask_for_every_change(edit):
    assert far([edit], (3500.0, 100.0)) == frozenset()


def test_without_an_edit_or_a_change_nothing_is_far():
    assert far([], (3500.0, 100.0)) == frozenset()
    assert far([Delete(LINE)]) == frozenset()
