"""A window that something hides shows what the photo shows of an equal one."""

from dataclasses import replace

import numpy as np
import pytest

from exporters.model import build_model
from exporters.textures.behind import FILLS
from exporters.textures.build import build_textures
from exporters.textures.equal import fill_from_equal
from exporters.textures.layout import MARGIN

RED, GREEN, BLUE = (200, 40, 40), (40, 200, 40), (40, 40, 200)


def patch(colour, rows=20, columns=12):
    return np.tile(np.array(colour, np.uint8), (rows + 2 * MARGIN, columns + 2 * MARGIN, 1))


@pytest.fixture
def panes(row):
    """The model of a row of equal windows and the ids of their panes."""
    model = build_model(row)
    (equal,) = (fittings for fittings in model.equal_fittings if len(fittings) > 1)
    return model, [fitting.faces[0].id for fitting in equal]


def test_a_hidden_pane_is_that_of_the_equal_one_that_is_seen_best(panes):
    model, ids = panes
    painted = {ids[0]: patch(RED), ids[1]: patch(GREEN), ids[2]: patch(BLUE, 40, 24)}
    cover = np.zeros(painted[ids[0]].shape[:2], np.uint8)
    cover[: MARGIN + 10] = 255
    shown = dict.fromkeys(ids, 0.0) | {ids[0]: 900.0, ids[1]: 5.0, ids[2]: 7.0}
    fill_from_equal(model, painted, {ids[0]: cover}, shown)
    own = painted[ids[0]][MARGIN:-MARGIN, MARGIN:-MARGIN]
    assert (own[:10] == BLUE).all()
    assert (own[10:] == RED).all()
    assert (painted[ids[1]] == GREEN).all()


def test_without_an_equal_one_in_plain_view_nothing_changes(panes):
    model, ids = panes
    painted = {pane: patch(RED) for pane in ids}
    covers = {pane: np.full(painted[pane].shape[:2], 255, np.uint8) for pane in ids}
    fill_from_equal(model, painted, covers, dict.fromkeys(ids, 10.0))
    assert all((colours == RED).all() for colours in painted.values())


def test_where_two_are_mixed_the_colours_pass_into_each_other(panes):
    model, ids = panes
    painted = {ids[0]: patch(RED), ids[1]: patch(GREEN)}
    cover = np.full(painted[ids[0]].shape[:2], 51, np.uint8)
    fill_from_equal(model, painted, {ids[0]: cover}, dict.fromkeys(ids, 1.0))
    mixed = np.rint(0.8 * np.array(RED) + 0.2 * np.array(GREEN))
    assert (painted[ids[0]][MARGIN:-MARGIN, MARGIN:-MARGIN] == mixed).all()


@pytest.mark.parametrize("fill", FILLS)
def test_in_a_scene_a_hedge_before_a_window_is_not_on_it(row, photo, fill):
    model = build_model(row)
    ids = [fitting.faces[0].id for fitting in model.fittings]
    hedged = [
        replace(plane, faces=tuple(replace(f, hidden=(f.outline,)) if f.id == ids[0] else f for f in plane.faces))
        for plane in row.planes
    ]
    scene = replace(row, planes=tuple(hedged))
    textures = build_textures(scene, photo, 4096, fill)
    assert textures.files != build_textures(row, photo, 4096, fill).files
    own, grey = (build_textures(scene, photo, 4096, each) for each in FILLS)
    assert own.files != grey.files
    assert grey.shown == own.shown
