"""Lines and faces parted by the components of the scene, in every format that has groups."""

import json
import re
import struct
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
from pxr import Usd

from exporters.formats import export
from exporters.model import build_model

ON = {"components": True}


@pytest.fixture(scope="module")
def one(row):
    """All of one component."""
    return replace(row, lines=replace(row.lines, component=np.zeros(len(row.lines), int)))


@pytest.fixture(scope="module")
def parted(one):
    """Component 3 is of some lines, which lie in the wall with windows and in no other plane."""
    wall, own = one.openings[0].plane, tuple(one.lines.id[:7:2].tolist())
    planes = [
        replace(plane, lines=own if plane.id == wall else tuple(line for line in plane.lines if line not in own))
        for plane in one.planes
    ]
    component = np.where(np.isin(one.lines.id, own), 3, 0)
    return replace(one, planes=tuple(planes), lines=replace(one.lines, component=component))


@pytest.fixture(scope="module")
def model(parted):
    return build_model(parted, by_component=True)


def test_a_line_is_in_the_group_of_its_component(parted, model):
    component = dict(zip(parted.lines.id.tolist(), parted.lines.component.tolist(), strict=True))
    for group in model.groups:
        assert {component[number] for number in group.ids.tolist()} == {group.component}
        assert group.name.endswith("_component_3") == (group.component == 3)
    assert sorted(number for group in model.groups for number in group.ids.tolist()) == sorted(component)
    assert model.components == (0, 3)


def test_panes_and_reveals_are_of_the_component_of_their_wall(parted, model):
    wall = parted.openings[0].plane
    own = {opening.id for opening in parted.openings if opening.plane == wall}
    for face in model.faces:
        assert face.component == (3 if face.plane == wall or face.opening in own else face.component)
    assert {face.component for face in model.faces if face.opening in own} == {3}
    assert {face.component for face in model.faces} == {0, 3}


def test_a_plane_is_of_the_component_of_most_of_its_lines(parted):
    plane = next(plane for plane in parted.planes if len(plane.lines) >= 3)
    rows = [int(np.flatnonzero(parted.lines.id == line)[0]) for line in plane.lines]
    component = parted.lines.component.copy()
    component[rows] = [1, 2, *[2] * (len(rows) - 2)]
    changed = replace(parted, lines=replace(parted.lines, component=component))
    assert changed.components_of_planes[plane.id] == 2


def test_without_the_option_all_is_as_if_there_were_one(parted, tmp_path):
    single = replace(parted, lines=replace(parted.lines, component=np.zeros(len(parted.lines), int)))
    for suffix in (".dxf", ".step", ".glb", ".usda", ".obj"):
        export(parted, tmp_path / f"a{suffix}")
        export(single, tmp_path / f"b{suffix}")
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_one_component_has_the_names_that_it_has_without_the_option(one, tmp_path):
    for suffix in (".dxf", ".step", ".glb", ".usda", ".obj"):
        export(one, tmp_path / f"a{suffix}", options=ON)
        export(one, tmp_path / f"b{suffix}")
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_layers_of_a_dxf(parted, model, tmp_path):
    export(parted, tmp_path / "a.dxf", options=ON)
    document = ezdxf.readfile(tmp_path / "a.dxf")
    found = {}
    for entity in document.modelspace():
        kind, number = entity.get_xdata("LINECAD")[:2]
        found.setdefault((kind.value, number.value), set()).add(entity.dxf.layer)
    for group in model.groups:
        assert {layer for number in group.ids.tolist() for layer in found["line", number]} == {group.name.upper()}
        plain = document.layers.get(group.name.removesuffix("_component_3").upper())
        assert document.layers.get(group.name).color == plain.color
    for face in model.faces:
        more = "_COMPONENT_3" if face.component else ""
        assert found["face", face.id] == {f"FACES{more}", f"FACE_OUTLINES{more}"}


def test_nodes_of_a_glb(parted, model, tmp_path):
    export(parted, tmp_path / "a.glb", options=ON)
    data = (tmp_path / "a.glb").read_bytes()
    nodes = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])["nodes"]
    parent = {nodes[child]["name"]: node["name"] for node in nodes for child in node.get("children", [])}
    above = {fitting.label: fitting.component for fitting in model.fittings}
    assert parent["faces_component_3"] == "faces"
    assert parent["lines_component_3"] == "lines"
    for group in model.groups:
        assert parent[group.name] == ("lines_component_3" if group.component else "lines")
    for face in model.loose_faces:
        assert parent[face.name] == ("faces_component_3" if face.component else "faces")
    for label, component in above.items():
        assert parent[label] == ("faces_component_3" if component else "faces")


@pytest.mark.parametrize("instances", [False, True])
def test_prims_of_a_stage(parted, model, tmp_path, instances):
    export(parted, tmp_path / "a.usda", options={**ON, "instances": instances})
    stage = Usd.Stage.Open(str(tmp_path / "a.usda"))
    for group in model.groups:
        below = "component_3/" if group.component else ""
        assert stage.GetPrimAtPath(f"/Reconstruction/Lines/{below}{group.name}")
    for name, component in [(face.name, face.component) for face in model.loose_faces] + [
        (fitting.key, fitting.component) for fitting in model.fittings
    ]:
        assert stage.GetPrimAtPath(f"/Reconstruction/Faces/{'component_3/' if component else ''}{name}")


@pytest.mark.parametrize("options", [{}, {"sewn": True}, {"instances": True}])
def test_parts_of_a_step_file(parted, model, tmp_path, options):
    export(parted, tmp_path / "a.step", options={**ON, **options})
    names = set(re.findall(r"PRODUCT\('([^']*)'", (tmp_path / "a.step").read_text()))
    assert {"faces", "faces_component_3", "lines", "lines_component_3"} <= names
    assert {group.name for group in model.groups} <= names


def test_groups_of_an_obj(parted, model, tmp_path):
    export(parted, tmp_path / "a.obj", options=ON)
    groups, last = {}, None
    for row in (tmp_path / "a.obj").read_text().splitlines():
        word, _, rest = row.partition(" ")
        if word == "g":
            last = rest
        elif word == "o":
            groups[rest] = last
    for face in model.faces:
        assert groups[face.name] == ("faces_component_3" if face.component else "faces")
    for group in model.groups:
        assert groups[group.name] == ("lines_component_3" if group.component else "lines")
