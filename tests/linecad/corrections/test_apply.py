"""Corrections applied to found lines: what each edit does."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.corrections.apply import FIRST_IDS, correcting_of
from linecad.corrections.edits import (
    Anchor,
    Corrections,
    Delete,
    Draw,
    Join,
    KnownLength,
    LabelCrossing,
    Many,
    NameGroup,
    SetAxis,
    SetEnds,
    SetFrame,
    Split,
)
from linecad.errors import CorrectionError


def test_without_edits_the_lines_are_those_found(made, applied):
    lines = applied()
    assert (lines.segments.ends == made.pixels).all()
    assert lines.ids.tolist() == list(range(len(made.axis)))
    assert set(lines.origin) == {"found"}


def test_a_deleted_line_is_gone_and_the_others_keep_their_ids(made, applied, anchor):
    lines = applied(Delete(anchor(3)))
    assert lines.ids.tolist() == [number for number in range(len(made.axis)) if number != 3]


def test_a_split_line_becomes_two_that_meet_at_the_point(made, applied, anchor):
    middle = made.pixels[0].mean(axis=0)
    lines = applied(Split(anchor(0), tuple((middle + np.array([0.4, 0.3])).tolist())))
    count = len(made.axis)
    assert lines.ids[-2:].tolist() == [count, count + 1]
    assert lines.origin[-2:] == ("split", "split")
    first, second = lines.segments.ends[-2:]
    assert first[1] == pytest.approx(second[0])
    assert (first[0], second[1]) == (pytest.approx(made.pixels[0, 0]), pytest.approx(made.pixels[0, 1]))
    assert lines.parted == ((count, count + 1),)


def test_joining_what_was_split_gives_the_line_back(made, applied, anchor):
    point, whole = tuple(made.pixels[0].mean(axis=0).tolist()), anchor(0)
    pieces = Anchor((whole.ends[0], point), whole.axis), Anchor((point, whole.ends[1]), whole.axis)
    lines = applied(Split(whole, point), Join(pieces))
    assert lines.origin[-1] == "joined"
    assert lines.segments.ends[-1] == pytest.approx(made.pixels[0], abs=1e-6)
    assert len(lines.ids) == len(made.axis)


def test_a_length_is_kept_by_the_line_and_can_be_taken_back(applied, anchor):
    known = KnownLength(anchor(4), 3.5)
    assert applied(known).lengths == {4: 3.5}
    assert applied(known, replace(known, metres=None)).lengths == {}


def test_a_name_of_a_group_goes_with_its_line_and_can_be_taken_back(made, applied, anchor):
    named = NameGroup(anchor(4), "Right tower")
    assert applied(named).names == {4: "Right tower"}
    pieces = applied(named, Split(anchor(4), tuple(made.pixels[4].mean(axis=0).tolist())))
    assert pieces.names == {pieces.ids[-2]: "Right tower"}
    assert applied(named, replace(named, name=None)).names == {}


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda _: Delete(Anchor(((5.0, 5.0), (90.0, 9.0)), 0)), "no line runs from .5, 5. to .90, 9. along x"),
        (lambda anchor: Split(anchor(0), anchor(0).ends[0]), "piece would be shorter"),
        (lambda _: Draw(Anchor(((5.0, 5.0), (6.0, 5.0)), 0)), "too short; at least 10 px"),
        (lambda anchor: Join((anchor(0), anchor(0))), "cannot be joined to itself"),
        (lambda anchor: Draw(anchor(0)), "there already"),
        (lambda anchor: SetEnds(anchor(0), (anchor(0).ends[0], anchor(0).ends[0])), "too short; at least 10 px"),
        (lambda anchor: Many((Delete(anchor(2)), Delete(Anchor(((5.0, 5.0), (90.0, 9.0)), 0)))), "no line runs from"),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_line_and_changes_nothing(made, applied, anchor, edit, message):
    lines, _ = correcting_of(made.segments, made.camera, made.frame, Corrections("made.jpg", 1600, 1200))
    before = lines.result()
    with pytest.raises(CorrectionError, match=message) as refused:
        lines.apply(edit(anchor))
    assert "\n" not in str(refused.value)
    assert lines.result().is_like(before)
    assert message.split(";")[0].split(" .")[0].split()[0] in " ".join(applied(edit(anchor)).notes)


def test_lines_of_two_axes_or_side_by_side_are_not_joined(made, applied, anchor):
    other = int(np.flatnonzero(made.axis != made.axis[0])[0])
    assert "give them one axis first" in applied(Join((anchor(0), anchor(other)))).notes[0]
    beside = next(k for k in range(1, len(made.axis)) if made.axis[k] == made.axis[0])
    assert "px beside each other" in applied(Join((anchor(0), anchor(beside)))).notes[0]


def test_many_corrections_that_name_nothing_make_few_notes(applied):
    lost = [Delete(Anchor(((5.0, 5.0 + k), (90.0, 9.0 + k)), 0)) for k in range(30)]
    notes = applied(*lost).notes
    assert len(notes) == 6
    assert notes[-1].startswith("25 more corrections")


def test_lines_found_with_another_frame_are_other_lines(made, applied, anchor):
    drawn = SetFrame(tuple(anchor(line) for line in (0, 1)))
    lines = applied(Delete(anchor(3)), drawn)
    assert lines.ids.min() >= FIRST_IDS
    assert len(lines.ids) == len(made.axis) - 1


def test_axes_named_before_the_frame_was_given_mean_nothing_any_more(made, applied, anchor):
    other = 1 if made.axis[3] != 1 else 0
    lines = applied(SetAxis(anchor(3), other), SetFrame((anchor(0),)))
    assert lines.segments.axis.tolist() == made.axis.tolist()


def test_the_ends_of_a_line_move_along_it_and_it_stays_the_same_line(made, applied, anchor):
    start, end = made.pixels[0]
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([-along[1], along[0]])
    wanted = (start - 30 * along + 5 * across, end + 12 * along)
    label = LabelCrossing((anchor(0), anchor(1)), tuple(start.tolist()), "fake")
    lines = applied(label, SetEnds(anchor(0), tuple(tuple(at.tolist()) for at in wanted)))
    assert lines.ids.tolist() == list(range(len(made.axis)))
    assert lines.segments.ends[0] == pytest.approx(np.array([start - 30 * along, end + 12 * along]))
    assert lines.origin[0] == "found"
    assert lines.labels == applied(label).labels


def test_of_many_edits_in_one_step_those_that_mean_something_still_apply(made, applied, anchor):
    lost = Anchor(((5.0, 5.0), (90.0, 9.0)), 0)
    lines = applied(Many((Delete(anchor(2)), Delete(lost), Delete(anchor(4)))))
    assert lines.ids.tolist() == [number for number in range(len(made.axis)) if number not in (2, 4)]
    assert [note.split(":")[0] for note in lines.notes] == ["correction 1 is left out"]


def test_many_edits_in_one_step_do_what_they_do_one_after_another(made, applied, anchor):
    other = 1 if made.axis[3] != 1 else 0
    edits = (SetAxis(anchor(3), other), Delete(anchor(5)), LabelCrossing((anchor(0), anchor(1)), (9.0, 9.0), "real"))
    once, each = applied(Many(edits)), applied(*edits)
    assert once.is_like(each)
    assert once.labels == each.labels != {}


def test_every_line_knows_what_it_was_found_as(made, applied, anchor):
    """A split, turned or longer line is the line of the photo that it was; a drawn one is as it was drawn."""
    middle = tuple(made.pixels[0].mean(axis=0).tolist())
    longer = tuple(map(tuple, (made.pixels[1] + 0.2 * np.diff(made.pixels[1], axis=0) * [[-1], [1]]).tolist()))
    drawn = Anchor(((300.0, 300.0), (380.0, 290.0)), 0)
    lines = applied(Split(anchor(0), middle), SetEnds(anchor(1), longer), Delete(anchor(2)), Draw(drawn))
    row = {number: row for row, number in enumerate(lines.ids.tolist())}
    count = len(made.axis)
    for number, found in ((1, 1), (3, 3), (count, 0), (count + 1, 0)):
        assert (lines.as_found.ends[row[number]] == made.pixels[found]).all()
        assert lines.as_found.axis[row[number]] == made.axis[found]
    assert (lines.as_found.ends[row[count + 2]] == lines.segments.ends[row[count + 2]]).all()
    assert not (lines.segments.ends[row[1]] == made.pixels[1]).all()
    assert len(lines.as_found) == len(lines.segments)
    turned = applied(SetAxis(anchor(1), (int(made.axis[1]) + 1) % 3))
    assert (turned.as_found.ends == made.pixels).all()
    assert turned.as_found.axis.tolist() == made.axis.tolist()
    joined = applied(Split(anchor(0), middle), Join((piece(made, 0, 0), piece(made, 0, 1))))
    assert (joined.as_found.ends[-1] == made.pixels[0]).all()


def piece(made, line, end):
    """A half of a line, as it is named."""
    ends = [made.pixels[line].mean(axis=0), made.pixels[line, end]][:: 1 if end else -1]
    return Anchor(tuple(tuple(each.tolist()) for each in ends), int(made.axis[line]))
