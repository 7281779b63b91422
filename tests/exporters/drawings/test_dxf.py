"""DXF, read back by ezdxf: metres in model space, and a sheet in mm with a viewport at scale."""

from collections import Counter
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
from ezdxf import recover

from exporters.formats import export


@pytest.fixture(scope="module")
def path(facade, marked, tmp_path_factory):
    path = tmp_path_factory.mktemp("dxf") / "a.elevation.dxf"
    export(facade, path, marked, {"drawing-scale": "1:50"})
    return path


@pytest.fixture(scope="module")
def document(path):
    return ezdxf.readfile(path)


@pytest.fixture(scope="module")
def sheet(document):
    return document.layouts.get("Sheet")


def test_the_file_has_no_faults(path):
    document, auditor = recover.readfile(path)
    assert auditor.errors == []
    assert document.audit().errors == []


def test_openings_have_their_lengths_in_metres(document):
    lines = document.modelspace().query('LINE[layer=="OPENINGS"]')
    lengths = sorted(line.dxf.start.distance(line.dxf.end) for line in lines)
    assert np.allclose(lengths, [1.2] * 6 + [1.6] * 6, atol=1e-9)
    assert document.units == ezdxf.units.M


def test_dimensions_measure_what_the_drawing_says(sheet, drawing):
    found = []
    for dimension in sheet.query("DIMENSION"):
        style = sheet.doc.dimstyles.get(dimension.dxf.dimstyle)
        found.append(dimension.get_measurement() * style.dxf.dimlfac)
        assert dimension.dxf.text in ("", "<>")  # what is written is what it measures
    assert np.allclose(found, [each.length for each in drawing.dimensions], atol=1e-9)
    assert len(found) == 16


def test_the_numbers_that_dimensions_show_are_rounded_lengths(sheet, drawing):
    shown = []
    for dimension in sheet.query("DIMENSION"):
        texts = [entity for entity in dimension.virtual_entities() if entity.dxftype() in ("MTEXT", "TEXT")]
        (text,) = texts
        shown.append(text.plain_text() if text.dxftype() == "MTEXT" else text.dxf.text)
    assert shown == [drawing.unit.text(each.length) for each in drawing.dimensions]


def test_the_viewport_shows_model_space_to_scale(sheet, drawing):
    (viewport,) = [each for each in sheet.query("VIEWPORT") if each.dxf.id != 1]
    assert np.isclose(viewport.dxf.height / viewport.dxf.view_height, 1000 / 50)
    assert np.isclose(viewport.get_scale(), 1000 / 50)
    centre = np.array(viewport.dxf.view_center_point)[:2]
    placed = drawing.view.to_paper(centre)
    assert np.allclose(placed, np.array(viewport.dxf.center)[:2])


def test_the_sheet_is_the_paper(sheet):
    assert (sheet.dxf.paper_width, sheet.dxf.paper_height) == (420, 297)
    assert "Scale: 1:50 on A3" in [text.dxf.text for text in sheet.query("TEXT")]


def test_layers_have_pens(document):
    weights = {layer.dxf.name: layer.dxf.lineweight for layer in document.layers}
    assert (weights["OUTLINES"], weights["OPENINGS"], weights["DETAILS"], weights["GROUND"]) == (35, 25, 13, 70)
    used = Counter(entity.dxf.layer for entity in document.modelspace())
    assert {"OUTLINES", "OPENINGS", "FACES", "GROUND", "PHOTO"} == set(used)


def test_the_photo_is_a_picture_beside_the_file_in_its_place(document, path):
    (image,) = document.modelspace().query("IMAGE")
    file = path.parent / image.image_def.dxf.filename
    assert file.is_file()
    assert file.parent.name == "a.elevation.dxf.pictures"
    columns, rows = image.image_def.dxf.image_size.x, image.image_def.dxf.image_size.y
    step = 25.4 / 200 / (1000 / 50)
    assert np.isclose(image.dxf.u_pixel.magnitude, step)
    assert np.isclose(image.dxf.v_pixel.magnitude, step)
    assert np.isclose(image.dxf.insert.x, -0.08 * 12)
    assert columns > rows > 0


def test_the_plan_has_no_picture(facade, tmp_path):
    export(facade, tmp_path / "a.plan.dxf")
    document = ezdxf.readfile(tmp_path / "a.plan.dxf")
    assert not document.modelspace().query("IMAGE")
    assert document.modelspace().query('LINE[layer=="WALLS"]')


def test_guesses_are_on_dashed_layers_of_their_own(facade, told, tmp_path):
    export(replace(facade, lines=told.lines), tmp_path / "a.elevation.dxf")
    document = ezdxf.readfile(tmp_path / "a.elevation.dxf")
    assert document.layers.get("OUTLINES_GUESS").dxf.linetype == "GUESS"
    assert document.layers.get("OUTLINES").dxf.linetype == "Continuous"
    lines = {name: document.modelspace().query(f'LINE[layer=="{name}"]') for name in ("OUTLINES", "OUTLINES_GUESS")}
    assert all(lines.values())
    assert {line.dxf.linetype for line in lines["OUTLINES_GUESS"]} == {"BYLAYER"}
