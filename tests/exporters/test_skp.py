"""SKP, read back with openskp, the only open reader; nobody here has SketchUp."""

import sys
import time
import uuid
from dataclasses import replace

import numpy as np
import pytest

from exporters.formats import export
from exporters.model import build_model
from linecad.errors import OutputError

openskp = pytest.importorskip("openskp", reason="the extra `sketchup` is not installed")

INCH = 0.0254  # m


def saved(scene, folder):
    path = folder / "a.skp"
    export(scene, path)
    return openskp.SkpFile.open(str(path)).parse()


def groups(model):
    """The words of each group with its layer, its name and its definition, in their order in the file."""
    definitions = list(model.definitions.values())
    assert len(definitions) == len(model.root.instances)
    return [
        (dict(group.attribute_dictionaries["linecad"]), group.layer, group.name, definition)
        for group, definition in zip(model.root.instances, definitions, strict=True)
    ]


def place(definition, vertex):
    found = definition.vertices[vertex]
    return np.array([found.x, found.y, found.z]) * INCH


def corners(definition, loop):
    """(V, 3) m, where the edges of a loop begin."""
    edges = [(definition.edges[number], forward) for number, forward in loop]
    return np.array([place(definition, edge.v1_id if forward == 1 else edge.v2_id) for edge, forward in edges])


def turned(ring):
    """A ring from its smallest point on."""
    points = [tuple(point) for point in np.round(ring, 7)]
    first = points.index(min(points))
    return points[first:] + points[:first]


def test_lines_are_edges_in_the_group_and_on_the_layer_of_their_own(scene, line_ends, tmp_path):
    found = {}
    for words, layer, name, definition in groups(saved(scene, tmp_path)):
        if name.startswith("lines_"):
            assert layer == name
            for number, edge in zip(words["ids"], definition.edges.values(), strict=True):
                found[int(number)] = np.array([place(definition, edge.v1_id), place(definition, edge.v2_id)])
    assert found.keys() == line_ends.keys()
    assert max(np.abs(found[number] - ends).max() for number, ends in line_ends.items()) < 1e-9


def test_faces_have_their_holes_and_look_to_where_they_are_seen_from(row, scene, tmp_path):
    for each in (row, scene):
        rings = [face.rings for face in build_model(each).faces]
        normals = [face.normal for face in build_model(each).faces]
        found = [
            (tuple(corners(definition, loop) for loop in face.loops), face.normal)
            for *_, definition in groups(saved(each, tmp_path))
            for face in definition.faces.values()
        ]
        wanted = sorted(
            (sorted(turned(ring) for ring in own), tuple(np.round(normal, 6) + 0.0))
            for own, normal in zip(rings, normals, strict=True)
        )
        shown = sorted(
            (sorted(turned(ring) for ring in own), tuple(np.round(normal, 6) + 0.0)) for own, normal in found
        )
        assert len(shown) == len(wanted)
        for (loops, normal), (others, side) in zip(shown, wanted, strict=True):
            assert normal == pytest.approx(side)
            for loop, ring in zip(loops, others, strict=True):
                assert np.array(loop) == pytest.approx(np.array(ring), abs=1e-6)


def test_an_opening_is_a_group_of_its_faces(row, tmp_path):
    found = {
        name: (layer, len(definition.faces), words) for words, layer, name, definition in groups(saved(row, tmp_path))
    }
    assert {name: told[:2] for name, told in found.items() if not name.startswith("lines_")} == {
        "wall": ("faces_wall", 1),
        "ground": ("faces_ground", 1),
        **{f"window {number}": ("openings_window", 5) for number in (1, 2, 3)},
    }
    assert found["window 2"][2]["opening"] == "1"


def test_the_unit_and_ids_of_any_size_are_told(large_ids, row, tmp_path):
    for scene, note in ((large_ids, "lengths are in metres"), (row, "the scale of the photo is not known")):
        for words, _, name, _ in groups(saved(scene, tmp_path)):
            assert words["unit"].startswith(note)
            assert not name.startswith("lines_") or all(number.isdecimal() for number in words["ids"])


def test_the_library_asks_the_clock_again_afterwards(row, tmp_path):
    saved(row, tmp_path)
    library = sys.modules["openskp.create"]
    assert (library.time, library.uuid) == (time, uuid)


def test_a_face_that_is_too_small_is_told(scene, tmp_path):
    face = scene.planes[0].faces[0]
    small = replace(face, outline=face.outline[0] + (face.outline - face.outline[0]) * 1e-12, holes=())
    plane = replace(scene.planes[0], faces=(small,))
    with pytest.raises(OutputError, match="face_0000 is too small or too thin"):
        export(replace(scene, planes=(plane,)), tmp_path / "a.skp")
