"""What the ids of a scene's things follow from."""

from dataclasses import replace

import numpy as np

from exporters.identity import identity_of


def test_scenes_that_hold_the_same_have_one_identity(scene, free_unit):
    again = replace(scene, lines=replace(scene.lines), notes=("a note",))
    assert identity_of(again) == identity_of(scene) == identity_of(free_unit)
    assert identity_of(replace(scene, photo=f"folder/{scene.photo}")) == identity_of(scene)


def test_scenes_that_differ_have_others(scene, row):
    moved = replace(scene.lines, ends=scene.lines.ends + np.array([0, 0, 1e-9]))
    faces = replace(scene, planes=scene.planes[1:])
    others = [row, faces, replace(scene, lines=moved), replace(scene, photo="other.jpg"), replace(scene, turns=(0.2,))]
    assert len({identity_of(each) for each in (scene, *others)}) == 1 + len(others)
