"""Edits about faces in the corrections file: what is missing has its default, what is wrong is told in one line."""

import json

import pytest

from linecad.corrections.edits import MOST_OF_GRID, WallAnchor, Window
from linecad.corrections.file import corrections_from_json
from linecad.errors import CorrectionsFileError

LINE = {"segment": [[10.0, 20.0], [110.0, 25.0]], "axis": "x"}
WINDOW = {"op": "window", "wall": {"normal": "y", "line": LINE}, "corners": [[10, 20], [60, 90]]}
REGION = {"op": "region", "polygon": [[0, 0], [50, 0], [50, 50]], "is": "sky"}


def read(edit):
    head = {"format": "linecad-corrections", "version": 1, "photo": "a.jpg", "width": 640, "height": 480}
    (found,) = corrections_from_json(json.dumps({**head, "edits": [edit]})).edits
    return found


def test_a_window_without_more_is_one_window_of_a_wall_that_its_place_names():
    found = read({"op": "window", "wall": {"normal": "x2"}, "corners": [[10, 20], [60, 90]]})
    assert found == Window(WallAnchor(3, None), ((10, 20), (60, 90)), "window", 1, 1, None)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ({**REGION, "is": "water"}, 'is is "water", expected one of ground, sky, clutter'),
        ({**REGION, "polygon": [[0, 0], [50, 0]]}, "a list of 3 to 1000 points"),
        ({**REGION, "polygon": [[0, 0], [50, 50], [50, 0], [0, 50]]}, "a polygon that does not cross itself"),
        ({**REGION, "polygon": [[0, 0], [50, 50], [100, 100]]}, "a polygon that does not cross itself"),
        ({**WINDOW, "wall": {"normal": "z", "line": LINE}}, "a level direction such as x or y"),
        ({**WINDOW, "corners": [[10, 20], [10, 20]]}, "two corners that differ"),
        ({**WINDOW, "corners": [[10, 20]]}, "a list of 2"),
        ({**WINDOW, "columns": 0}, "columns is 0"),
        ({**WINDOW, "rows": MOST_OF_GRID + 1, "last": [90, 90]}, "rows is 101"),
        ({**WINDOW, "columns": 2}, 'a window with "last", as there are several'),
        ({**WINDOW, "kind": "hatch"}, "one of window, door"),
        ({"op": "no-window"}, "edits[0].at is missing"),
        ({"op": "wall", "lines": [LINE, LINE, LINE]}, "a list of 4"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(edit, message):
    with pytest.raises(CorrectionsFileError) as caught:
        read(edit)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
