"""What a photo shows before anything is connected: the details that are left for faces."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.camera.photo import Photo
from linecad.corrections.apply import correct
from linecad.corrections.edits import Anchor, Corrections, Delete
from linecad.finding import FoundLines, _labelled, find_lines
from linecad.geometry import segment_coordinates
from linecad.line_graph import Segments
from linecad.pipeline import taken_away
from tests.linecad.camera.test_frame_labels import CAMERA, HORIZON, SINGLE, facades


@pytest.fixture
def found(made):
    """The exact lines of the made scene, with one detail more, 20 px beside the first line and along its axis."""
    beside = made.segments.subset(np.array([0]))
    across = np.array([[0.0, -1.0], [1.0, 0.0]]) @ (beside.ends[0, 1] - beside.ends[0, 0])
    ends = beside.ends + 20 * across / np.linalg.norm(across)
    return FoundLines(made.camera, made.frame, made.segments, (), details=Segments(ends, beside.axis))


def runs_along(segments, line):
    """Whether one of the segments runs along a line (2, 2) over half of it."""
    place, beside = segment_coordinates(segments.ends, line)
    length = np.linalg.norm(line[1] - line[0])
    overlap = np.minimum(place.max(axis=1), length) - np.maximum(place.min(axis=1), 0)
    return bool(((np.abs(beside).max(axis=1) < 3) & (overlap > length / 2)).any())


def test_details_are_whole_lines_of_all_that_was_found(found):
    details = found.details_for_faces(Segments.none())
    assert runs_along(details, found.segments.ends[0])
    assert runs_along(details, found.details.ends[0])


def test_what_a_person_took_away_does_not_come_back_as_a_detail(found):
    first = found.segments.ends[0]
    (a, b), (c, d) = first.tolist()
    anchor = Anchor(((a, b), (c, d)), int(found.segments.axis[0]))
    camera = found.camera
    edits = Corrections("made.jpg", camera.width, camera.height, (Delete(anchor),))
    corrected = correct(found.segments, camera, found.frame, edits)
    gone = taken_away(found.segments, corrected)
    assert gone.ends.tolist() == [first.tolist()]
    details = found.details_for_faces(gone)
    assert not runs_along(details, first)
    assert runs_along(details, found.details.ends[0])


def test_without_corrections_nothing_was_taken_away(found):
    assert len(taken_away(found.segments, None)) == 0


def test_where_nobody_looked_for_details_faces_get_none(found):
    assert replace(found, details=None).details_for_faces(Segments.none()) is None


def test_in_photos_of_one_frame_too_neighbours_tell_level_lines_apart():
    segments, axis = facades(0.6, SINGLE, 1, (HORIZON - 100, HORIZON + 100))
    labels = dict(zip(segments.ends[:, 0, 0].tolist(), axis.tolist(), strict=True))
    found = _labelled(segments, segments.subset(np.zeros(len(segments), bool)), CAMERA, SINGLE)
    assert len(found) > 100
    assert sum(labels[start] != own for start, own in zip(found.ends[:, 0, 0], found.axis, strict=True)) < 3


def test_a_photo_is_looked_at_for_details(made):
    photo = Photo("made.png", np.repeat(made.image()[..., None], 3, axis=2), made.camera)
    found = find_lines(photo)
    assert find_lines(photo, with_details=False).details is None
    assert len(found.details) > 0
    assert set(found.details.axis.tolist()) <= {0, 1, 2}
