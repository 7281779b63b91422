"""The groups of a model, their names and places, and what a person should know first."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.editing.document import document_of
from linecad.editing.groups import Group, groups_of
from linecad.editing.notes import notes_of


@pytest.fixture
def solved(page):
    page.solve()
    return page


def in_parts(now, component, probability):
    """A state whose model has these components (N,) and probabilities (N,)."""
    lines = replace(now.model.scene.lines, component=component, probability=probability)
    return replace(now, model=replace(now.model, scene=replace(now.model.scene, lines=lines)))


@pytest.fixture
def two_sides(solved):
    """A state in which the lines right of the middle are a group of their own, at guessed depths."""
    now = solved.session.now()
    right = now.model.scene.lines.segment.mean(axis=1)[:, 0] > now.photo.width / 2
    return in_parts(now, right.astype(int), np.where(right, 0.3, 0.95))


def test_before_a_model_there_are_none(page):
    assert groups_of(page.session.now()) == ()
    assert page.state()["groups"] == []


def test_groups_are_called_by_their_place_and_counted(two_sides):
    main, other = groups_of(two_sides)
    assert (main.component, main.name, main.guess) == (0, "Main group", 0.0)
    assert other.name.startswith("Group 1, ")
    assert other.name.endswith("right")
    assert (other.guess, other.is_named) == (1.0, False)
    assert main.share + other.share == pytest.approx(1.0)
    shown = [line for line in document_of(two_sides, 1, is_saved=True)["lines"] if line["ends"] is not None]
    assert main.lines + other.lines == len(shown)


def test_a_name_is_kept_by_geometry_and_changes_no_model(solved):
    state = solved.state()
    group = state["groups"][0]
    named = solved.edit(op="name", line=group["line"], text="The house")
    assert (named["groups"][0]["name"], named["groups"][0]["named"]) == ("The house", True)
    assert named["solve"]["fresh"]  # nothing is to be solved again
    assert named["lines"] == state["lines"]
    again = solved.edit(op="name", line=named["groups"][0]["line"], text=None)
    assert again["groups"] == state["groups"]
    assert solved.change("undo")["groups"][0]["name"] == "The house"
    assert "a name of 1 to 60" in solved.refused(422, "edit", edit={"op": "name", "line": group["line"], "text": " "})


def test_notes_begin_with_the_largest_group_at_a_guessed_depth(two_sides):
    groups = groups_of(two_sides)
    notes = notes_of(two_sides, groups)
    assert notes[0] == f"{groups[1].name}: depth is a guess ({groups[1].share:.0%} of the lines in the photo)"
    assert any("no scale" in note for note in notes)
    assert notes[-1].startswith("camera ")  # it is good, so it is told last
    measured = replace(two_sides.model, scene=replace(two_sides.model.scene, metres_per_unit=2.0, scale_source="a"))
    assert not any("no scale" in note for note in notes_of(replace(two_sides, model=measured), groups))


def test_groups_that_hardly_show_are_counted_and_a_poor_camera_comes_first(two_sides):
    small = [Group(number, f"Group {number}", False, number, 1, 0.002, 1.0) for number in (2, 3)]
    partly = Group(1, "Right tower", True, 1, 40, 0.3, 0.25)
    certainty = replace(two_sides.found.certainty, quality="poor")
    now = replace(two_sides, found=replace(two_sides.found, certainty=certainty))
    notes = notes_of(now, (partly, *small))
    assert notes[0].startswith("camera poor")
    assert notes[1:3] == ("Right tower: depth is a guess for 25% of it", "2 small groups: depth is a guess")


def test_a_length_that_says_nothing_is_told_first(solved):
    now = solved.session.now()
    count = len(now.model.scene.lines)
    guessed = in_parts(now, np.zeros(count, int), np.full(count, 0.2))
    note = "a line of known length (3 m) stands at a depth that is a guess, so its length says nothing about the scale"
    scene = replace(guessed.model.scene, notes=(*guessed.model.scene.notes, note))
    told = replace(guessed, model=replace(guessed.model, scene=scene))
    assert notes_of(told, groups_of(told))[0] == note
