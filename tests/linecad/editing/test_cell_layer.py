"""The picture of what each part of the photo was taken for."""

import cv2
import numpy as np

from linecad.editing.cell_layer import BORDER, COLOURS
from linecad.scene import CELL_KINDS


def rgb(colour):
    return [int(colour[at : at + 2], 16) for at in (1, 3, 5)]


def test_every_kind_has_a_colour_of_its_own():
    assert tuple(COLOURS) == CELL_KINDS
    assert len({*COLOURS.values(), BORDER}) == len(CELL_KINDS) + 1


def test_without_a_model_there_is_no_layer(page):
    assert page.state()["cells"] is None
    assert page.get("cells").status_code == 404


def test_the_picture_has_the_colours_that_the_state_names(page):
    told = page.solve()["cells"]
    answer = page.get("cells")
    assert answer.headers["content-type"] == "image/png"
    picture = cv2.imdecode(np.frombuffer(answer.content, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
    cells = page.session.scene().cells
    assert picture.shape[:2] == cells.number.shape
    seen = {tuple(colour) for colour in np.unique(picture.reshape(-1, 3), axis=0).tolist()}
    assert seen == {tuple(rgb(kind["colour"])) for kind in told["kinds"]} | {tuple(rgb(BORDER))}
    assert {kind["name"] for kind in told["kinds"]} == {cells.kinds[each] for each in np.unique(cells.number)}
    middle = cells.number[10:-10, 10:-10]
    row, column = (
        np.argwhere((middle == cells.number[9:-11, 10:-10]) & (middle == cells.number[10:-10, 9:-11]))[len(middle)] + 10
    )
    assert picture[row, column].tolist() == rgb(COLOURS[cells.kinds[cells.number[row, column]]])


def test_another_model_has_another_number(page):
    first = page.solve()["cells"]["number"]
    page.edit(op="delete", line=0)
    assert page.state()["cells"]["number"] == first
    assert page.solve()["cells"]["number"] > first
