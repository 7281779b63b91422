"""Seams: two walls of one body that little joins part there; what both have in common tells how likely it holds."""

from dataclasses import replace

import numpy as np
import pytest

from linecad.ties.looks import Looks
from linecad.ties.seams import LOG_ODDS, TYPICAL_SHADE, find_seams

RED, BLUE = (170, 60, 50), (50, 70, 170)
BY_PIECES = {"stays": 1.0, "one ground": 0.0}  # as where nothing speaks against a seam


def told(seam, features):
    return replace(seam, features={**seam.features, **BY_PIECES, **features}).probability


def seams_of(setting):
    return find_seams(setting, Looks(setting))


@pytest.fixture(scope="module")
def row(build_town, build_row):
    """Two walls in one plane; three courses of the first end at the second."""
    return build_town(*build_row(3))


@pytest.fixture(scope="module")
def one_body(row, build_setting):
    return build_setting(row, body=np.zeros(len(row.part), int))


def painted(left, right):
    halves = [np.full((2880, times * 192, 3), colour, np.uint8) for colour, times in ((left, 9), (right, 11))]
    return np.concatenate(halves, axis=1)


def seen(setting, pixels):
    return replace(setting, sight=replace(setting.sight, pixels=pixels))


def test_two_walls_part_where_few_courses_join_them(one_body, row):
    seam = seams_of(one_body)[0]
    sides = [set(np.flatnonzero(row.part == part).tolist()) for part in range(2)]
    assert set(seam.larger.tolist()) in sides
    assert set(seam.smaller.tolist()) in sides
    assert [*seam.features, *BY_PIECES] == list(LOG_ODDS)


def test_what_no_crossing_joins_has_no_seam(build_town, build_row, build_setting):
    apart = build_town(*build_row(0))
    assert seams_of(build_setting(apart, body=np.zeros(len(apart.part), int))) == []


def test_two_bodies_have_no_seam_between_them(row, build_setting):
    assert seams_of(build_setting(row)) == []


def test_a_wall_is_no_seam(build_town, build_row, build_setting):
    first, _ = build_row(0)
    alone = build_town(first)
    assert seams_of(build_setting(alone)) == []


def test_walls_of_one_paint_hold_better_than_those_of_two(one_body):
    same, other = (seams_of(seen(one_body, painted(RED, right)))[0] for right in (RED, BLUE))
    assert same.features["shade"] > 0.95
    assert other.features["shade"] < 0.2
    same, other = (replace(each, features={**each.features, **BY_PIECES}) for each in (same, other))
    assert same.probability > other.probability


def test_light_counts_too(one_body):
    dark = seams_of(seen(one_body, painted((200, 200, 200), (90, 90, 90))))[0]
    assert dark.features["shade"] < 0.2


def test_without_a_photo_the_shade_is_the_usual_one(one_body):
    assert seams_of(one_body)[0].features["shade"] == TYPICAL_SHADE


def test_sides_beside_each_other_overlap_down_and_not_across(build_town, build_row, build_setting):
    touching = build_town(*build_row(3, end=0.9))
    found = seams_of(build_setting(touching, body=np.zeros(len(touching.part), int)))[0].features
    assert found["overlap across"] < 0.2
    assert found["overlap down"] > 0.8


def test_a_seam_is_doubtful_where_the_search_moves_its_sides_apart(one_body):
    seam = seams_of(one_body)[0]
    moved, stays = (told(seam, {"stays": share}) for share in (0.0, 1.0))
    assert 0 < moved < stays < 1


def test_a_seam_is_doubtful_where_its_sides_stand_on_two_grounds(one_body):
    seam = seams_of(one_body)[0]
    two, unknown, one = (told(seam, {"one ground": clear}) for clear in (-0.5, 0.0, 0.5))
    assert 0 < two < unknown < one < 1


def test_the_same_setting_has_the_same_seams(one_body):
    one, other = (seams_of(seen(one_body, painted(RED, BLUE))) for _ in range(2))
    assert [seam.features for seam in one] == [seam.features for seam in other]
    assert all((a.smaller == b.smaller).all() for a, b in zip(one, other, strict=True))
