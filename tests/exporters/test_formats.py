"""What holds for every format: a new row in FORMATS is taken up by itself."""

import os
import re
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from pxr import Usd

from exporters import formats
from exporters.beside import NOTHING, Beside, SideFiles
from exporters.formats import FORMATS, Format, export, find_format, options_for, suffixes
from exporters.options import Option
from linecad.errors import OutputError
from linecad.io.scene_file import write_scene

FACES_ONLY = {".ply", ".stl"}
NO_FACES = {".fspy", ".png"}  # the picture draws faces as they are, the project has none
DRAWINGS = {suffix for suffix, row in FORMATS.items() if row.module.startswith("exporters.drawings.")}
REPOSITORY = Path(__file__).parents[2]
HEAVY = {"OCP", "build123d", "cv2", "ezdxf", "ifcopenshell", "openskp", "pxr", "rhino3dm", "shapely", "trimesh"}


def save(scene, path):
    """Export without a photo, or with a black one where the format cannot do without."""
    camera = scene.camera
    black = np.zeros((camera.height, camera.width, 3), np.uint8) if find_format(path).needs_photo else None
    export(scene, path, black)


every_format = pytest.mark.parametrize("suffix", FORMATS)
with_lines = pytest.mark.parametrize("suffix", [suffix for suffix in FORMATS if suffix not in FACES_ONLY | DRAWINGS])


def start(script, *arguments, **environment):
    command = [sys.executable, "-c", script, *map(str, arguments)]
    return subprocess.Popen(command, cwd=REPOSITORY, env=os.environ | environment, stdout=subprocess.PIPE, text=True)


def run(script, *arguments):
    process = start(script, *arguments)
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 0
    return output


def files(folder):
    """Every file in a folder and the folders in it, by its name as seen from there."""
    return {str(path.relative_to(folder)): path for path in sorted(folder.rglob("*")) if path.is_file()}


def names(folder):
    return list(files(folder))


def exported(folder, *suffixes):
    """The names of the files `a` of these suffixes, and of all that lies beside them by their rows."""
    paths = [folder / f"a{suffix}" for suffix in suffixes]
    found = [file for path in paths for file in (path, *find_format(path).beside.found(path))]
    return sorted(str(file.relative_to(folder)) for file in found)


@pytest.fixture(scope="module")
def reference(scene, tmp_path_factory):
    """The bytes of the scene in every format, by suffix."""
    folder = tmp_path_factory.mktemp("reference")
    for suffix in FORMATS:
        save(scene, folder / f"a{suffix}")
    assert names(folder) == exported(folder, *FORMATS)
    return {suffix: (folder / f"a{suffix}").read_bytes() for suffix in FORMATS}


@every_format
def test_a_file_is_written_and_nothing_else(scene, tmp_path, suffix):
    save(scene, tmp_path / f"a{suffix}")
    assert names(tmp_path) == exported(tmp_path, suffix)
    assert (tmp_path / f"a{suffix}").stat().st_size > 1000


EXPORT_ALL = """
import sys
from pathlib import Path
import numpy as np
from exporters.formats import FORMATS, export
from linecad.io.scene_file import read_scene
scene = read_scene(Path(sys.argv[1]))
black = np.zeros((scene.camera.height, scene.camera.width, 3), np.uint8)
for suffix, row in FORMATS.items():
    export(scene, Path(sys.argv[2]) / ("a" + suffix), black if row.needs_photo else None)
"""


@pytest.mark.thorough
def test_the_same_scene_gives_the_same_bytes_in_fresh_processes(scene, reference, tmp_path):
    write_scene(scene, tmp_path / "scene.json")
    folders = [tmp_path / seed for seed in ("1", "2")]
    for folder in folders:
        folder.mkdir()
    processes = [start(EXPORT_ALL, tmp_path / "scene.json", path, PYTHONHASHSEED=path.name) for path in folders]
    for process in processes:
        process.communicate(timeout=120)
        assert process.returncode == 0
    first, second = ({name: path.read_bytes() for name, path in files(folder).items()} for folder in folders)
    assert first.keys() == second.keys()
    assert [name for name, data in first.items() if data != second[name]] == []
    assert [suffix for suffix in FORMATS if first[f"a{suffix}"] != reference[suffix]] == []


@every_format
def test_neither_the_name_nor_the_time_changes_the_bytes(scene, reference, tmp_path, suffix):
    path = tmp_path / f"""Häuschen "家" it's {suffix.upper()}"""
    save(scene, path)
    assert path.read_bytes() == reference[suffix]


BY_BAND = [suffix for suffix, row in FORMATS.items() if "probability" in [option.key for option in row.options]]


def written(scene, path):
    export(scene, path)
    return path.read_bytes().lower()


def holds(data, word):
    """Whether a file holds a word, with one byte a character or two as in 3DM."""
    return word.encode() in data or word.encode("utf-16-le") in data


@pytest.mark.parametrize("suffix", BY_BAND)
def test_groups_by_probability_are_there_only_where_the_scene_tells_it(scene, told, reference, tmp_path, suffix):
    export(scene, tmp_path / f"a{suffix}", options={"probability": True})
    assert (tmp_path / f"a{suffix}").read_bytes() == reference[suffix]
    export(told, tmp_path / f"a{suffix}", options={"probability": True})
    by_band = (tmp_path / f"a{suffix}").read_bytes().lower()
    assert by_band != written(told, tmp_path / f"b{suffix}")
    if suffix not in (".usdc", ".usdz"):  # these are compressed
        assert all(holds(by_band, f"lines_x_boundary_{band}") for band in ("sure", "likely", "guess"))


@pytest.mark.parametrize("suffix", BY_BAND)
def test_without_the_option_groups_have_their_plain_names(told, tmp_path, suffix):
    export(told, tmp_path / f"a{suffix}", options={"probability": False})
    assert written(told, tmp_path / f"b{suffix}") == (tmp_path / f"a{suffix}").read_bytes().lower()
    assert not holds((tmp_path / f"a{suffix}").read_bytes().lower(), "boundary_sure")


def test_every_format_with_names_for_lines_has_them_by_probability():
    assert set(BY_BAND) == set(FORMATS) - FACES_ONLY - NO_FACES - DRAWINGS


@with_lines
def test_a_single_line_without_any_face(one_line, tmp_path, suffix):
    save(one_line, tmp_path / f"a{suffix}")
    assert names(tmp_path) == exported(tmp_path, suffix)


@every_format
def test_faces_without_any_line(no_lines, tmp_path, suffix):
    save(no_lines, tmp_path / f"a{suffix}")
    assert names(tmp_path) == exported(tmp_path, suffix)


@pytest.mark.parametrize("suffix", sorted(FACES_ONLY))
def test_lines_alone_do_not_fit_into_formats_for_faces(no_faces, tmp_path, suffix):
    with pytest.raises(OutputError, match=f"{suffix} holds faces only and the scene has none"):
        export(no_faces, tmp_path / f"a{suffix}")
    assert names(tmp_path) == []


@pytest.mark.parametrize("suffix", sorted(DRAWINGS))
def test_a_drawing_needs_a_wall(no_faces, tmp_path, suffix):
    with pytest.raises(OutputError, match="a drawing shows walls and the scene has no upright face"):
        save(no_faces, tmp_path / f"a{suffix}")
    assert names(tmp_path) == []


def test_the_longest_suffix_chooses():
    assert find_format(Path("a.Elevation.DXF")) is FORMATS[".elevation.dxf"]
    assert find_format(Path("a.elevation.png")) is FORMATS[".png"]
    assert find_format(Path("elevation.dxf")) is FORMATS[".dxf"]


@every_format
def test_large_ids(large_ids, tmp_path, suffix):
    save(large_ids, tmp_path / f"a{suffix}")
    assert names(tmp_path) == exported(tmp_path, suffix)


@every_format
def test_a_scene_of_unknown_scale(free_unit, tmp_path, suffix):
    save(free_unit, tmp_path / f"a{suffix}")
    assert names(tmp_path) == exported(tmp_path, suffix)


@every_format
def test_an_empty_scene_is_refused(no_lines, tmp_path, suffix):
    with pytest.raises(OutputError, match="nothing to write"):
        save(replace(no_lines, planes=()), tmp_path / f"a{suffix}")
    assert names(tmp_path) == []


@every_format
def test_a_face_that_is_no_polygon_is_named_or_drawn(scene, tmp_path, suffix):
    """The picture shows what there is; the others would hold a face that no program can use."""
    broken = replace(scene.planes[0].faces[0], id=77, holes=(), outline=scene.planes[0].faces[0].outline[[0, 2, 1, 5]])
    with_broken = replace(scene, planes=(replace(scene.planes[0], faces=(broken,)),))
    if suffix in NO_FACES:
        save(with_broken, tmp_path / f"a{suffix}")
    else:
        with pytest.raises(OutputError, match="face_0077 is not a polygon"):
            save(with_broken, tmp_path / f"a{suffix}")
        assert names(tmp_path) == []


# A limit on the size of files stops every write that is too long, in Python and in C++ alike, as a full disk does.
FULL_DISK = """
import resource, sys
from pathlib import Path
import numpy as np
from exporters.formats import FORMATS, export
from linecad.errors import OutputError
from linecad.io.scene_file import read_scene
scene = read_scene(Path(sys.argv[1]))
folder = Path(sys.argv[2])
black = np.zeros((scene.camera.height, scene.camera.width, 3), np.uint8)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
for suffix, row in FORMATS.items():
    try:
        export(scene, folder / ("a" + suffix), black if row.needs_photo else None)
    except OutputError as error:
        print(suffix, error)
"""


@pytest.mark.thorough
def test_a_full_disk_keeps_the_old_file_and_leaves_no_other(scene, tmp_path):
    write_scene(scene, tmp_path / "scene.json")
    folder = tmp_path / "out"
    folder.mkdir()
    for suffix in FORMATS:
        (folder / f"a{suffix}").write_text("old")
    told = run(FULL_DISK, tmp_path / "scene.json", folder).splitlines()
    assert [line.split()[0] for line in told] == list(FORMATS)
    assert all("was not written" in line for line in told)
    assert {name: path.read_text() for name, path in files(folder).items()} == {
        f"a{suffix}": "old" for suffix in FORMATS
    }


def test_two_exports_at_once_to_one_path_leave_one_whole_file(scene, tmp_path):
    path = tmp_path / "a.dxf"
    with ThreadPoolExecutor(2) as pool:
        for _ in pool.map(lambda _: export(scene, path), range(4)):
            pass
    export(scene, tmp_path / "alone.dxf")
    assert path.read_bytes() == (tmp_path / "alone.dxf").read_bytes()
    assert names(tmp_path) == ["a.dxf", "alone.dxf"]


def test_an_unknown_suffix_is_told_the_known_ones(scene, tmp_path):
    with pytest.raises(OutputError) as caught:
        export(scene, tmp_path / "a.xyz")
    for suffix in (*FORMATS, ".json", ".xyz"):
        assert suffix in str(caught.value)
    assert names(tmp_path) == []


def test_a_name_without_suffix_is_told_so():
    for name in ("result", ".dxf"):
        with pytest.raises(OutputError, match="no suffix"):
            find_format(Path(name))


def test_the_suffix_chooses_the_format_in_any_case():
    assert find_format(Path("A.StEp")) is FORMATS[".step"]
    assert suffixes() == tuple(FORMATS)


@pytest.mark.parametrize("suffix", [suffix for suffix, row in FORMATS.items() if row.beside != NOTHING])
def test_what_lies_beside_an_export_is_what_the_row_says(scene, photo, tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    export(scene, path, photo)
    assert len(names(tmp_path)) > 1
    assert names(tmp_path) == exported(tmp_path, suffix)
    row = FORMATS[suffix].beside
    assert all(row.allows(path, file) for file in files(tmp_path).values() if file != path)
    export(scene, path, photo)
    assert names(tmp_path) == exported(tmp_path, suffix)


def test_a_new_format_with_side_files_needs_its_module_and_its_row_alone(scene, tmp_path, monkeypatch):
    def write(model, path, names, loud):
        scene = model.scene
        path.write_text(f"{names.folder}/part-{len(scene.lines)}.bin {names.library}{'!' if loud else ''}")
        return SideFiles({f"part-{len(scene.lines)}.bin": b"lines"}, "material")

    module = ModuleType("exporters.new")
    module.write = write
    monkeypatch.setitem(sys.modules, module.__name__, module)
    row = Format(
        "exporters.new", "lines", "metres", options=(Option("loud", False, "louder"),),
        beside=Beside(".parts", re.compile(r"part-\d+\.bin"), ".materials"),
    )  # fmt: skip
    monkeypatch.setitem(FORMATS, ".new", row)
    export(scene, tmp_path / "a.new", options=options_for([tmp_path / "a.new"], ["loud=on"]))
    part = f"part-{len(scene.lines)}.bin"
    assert (tmp_path / "a.new").read_text() == f"a.new.parts/{part} a.new.materials!"
    assert names(tmp_path) == ["a.new", "a.new.materials", f"a.new.parts/{part}"] == exported(tmp_path, ".new")


def test_the_table_is_fit_for_people():
    for suffix, row in FORMATS.items():
        assert suffix == suffix.lower()
        assert row.unit in {"metres", "millimetres", "inches", "pixels"}
        assert row.phrase
        assert "\n" not in row.phrase


def test_a_missing_folder_is_to_be_made_first(scene, tmp_path):
    with pytest.raises(OutputError, match="make it first"):
        export(scene, tmp_path / "no" / "a.usda")
    assert names(tmp_path) == []


def test_a_folder_is_no_output(scene, tmp_path):
    (tmp_path / "a.glb").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        export(scene, tmp_path / "a.glb")


@pytest.mark.parametrize("wrong", [np.zeros((10, 10, 3), np.uint8), np.zeros((1200, 1600), np.uint8)])
def test_a_photo_of_another_size_is_our_own_mistake(scene, tmp_path, wrong):
    with pytest.raises(ValueError, match="expected uint8 of shape"):
        export(scene, tmp_path / "a.png", wrong)


def test_a_photo_of_another_type_is_our_own_mistake(scene, photo, tmp_path):
    with pytest.raises(ValueError, match="float64"):
        export(scene, tmp_path / "a.png", photo / 255)


@pytest.mark.parametrize("suffix", [suffix for suffix, row in FORMATS.items() if row.extra is not None])
def test_an_extra_that_is_not_installed_is_named_before_any_work_is_done(scene, tmp_path, monkeypatch, suffix):
    name, library = FORMATS[suffix].extra
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert [each.split(">")[0] for each in project["optional-dependencies"][name]] == [library]
    monkeypatch.setitem(sys.modules, library, None)
    monkeypatch.setattr("importlib.util.find_spec", lambda module: None if module == library else module)
    told = rf"{suffix} files need {library}, which is not installed: pip install 'linecad\[{name}\]'"
    with pytest.raises(OutputError, match=told):
        export(scene, tmp_path / f"a{suffix}")
    with pytest.raises(OutputError, match=told):
        options_for([tmp_path / "b.dxf", tmp_path / f"a{suffix.upper()}"], [])
    assert names(tmp_path) == []


def test_the_table_loads_no_heavy_library():
    script = "import sys, exporters.formats; print(' '.join(name.split('.')[0] for name in sys.modules))"
    assert HEAVY.isdisjoint(run(script).split())


def test_only_the_module_of_the_format_is_loaded(scene, tmp_path):
    write_scene(scene, tmp_path / "scene.json")
    script = (
        "import sys; from pathlib import Path; from exporters.formats import export\n"
        "from linecad.io.scene_file import read_scene\n"
        "export(read_scene(Path(sys.argv[1])), Path(sys.argv[2]))\n"
        "print(' '.join(name.split('.')[0] for name in sys.modules))"
    )
    loaded = set(run(script, tmp_path / "scene.json", tmp_path / "a.dxf").split())
    assert loaded & HEAVY == {"ezdxf", "shapely"}


def test_a_writer_that_fails_midway_leaves_the_old_file(scene, tmp_path, monkeypatch):
    class Failing:
        @staticmethod
        def write(_, path, **_options):
            path.write_text("half")
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(formats.importlib, "import_module", lambda _: Failing)
    (tmp_path / "a.dxf").write_text("old")
    with pytest.raises(OutputError, match="no space is left"):
        export(scene, tmp_path / "a.dxf")
    assert (tmp_path / "a.dxf").read_text() == "old"
    assert names(tmp_path) == ["a.dxf"]


UNITS = {
    ".elevation.dxf": b"$INSUNITS\n 70\n6\n",
    ".plan.dxf": b"$INSUNITS\n 70\n6\n",
    ".dxf": b"$INSUNITS\n 70\n6\n",
    ".step": b"SI_UNIT(.MILLI.,.METRE.)",
    ".usda": b"metersPerUnit = 1\n",
    ".usdc": b"metersPerUnit = 1\n",
    ".usdz": b"metersPerUnit = 1\n",
    ".ifc": b"IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)",
}


@pytest.mark.parametrize("suffix", [suffix for suffix in FORMATS if suffix not in {".png", ".fspy"}])
def test_the_unit_is_told_and_the_scale_is_told_or_said_to_be_unknown(scene, free_unit, tmp_path, suffix):
    """Package and compact stage hold what the stage as text says; the binary forms are read in their own tests."""
    for each, note in ((scene, "lengths are in metres"), (free_unit, "scale of the photo is not known")):
        path = tmp_path / f"a{suffix}"
        save(each, path)
        data = path.read_bytes().replace(b"\r\n", b"\n")
        if suffix in {".usdc", ".usdz"}:
            data = Usd.Stage.Open(str(path)).ExportToString().encode()
        assert holds(data, note)
        assert UNITS.get(suffix, b"") in data


BY_ROLE = [suffix for suffix, row in FORMATS.items() if "roles" in [option.key for option in row.options]]


@pytest.mark.parametrize("suffix", BY_ROLE)
def test_groups_by_role_are_there_only_where_they_are_asked_for(scene, tmp_path, suffix):
    drawn = replace(
        scene, lines=replace(scene.lines, role=np.resize(["outline", "opening", "detail"], len(scene.lines)))
    )
    plain = written(drawn, tmp_path / f"a{suffix}")
    export(drawn, tmp_path / f"b{suffix}", options={"roles": True})
    by_role = (tmp_path / f"b{suffix}").read_bytes().lower()
    assert by_role != plain
    if suffix not in (".usdc", ".usdz"):  # these are compressed
        assert holds(by_role, "lines_x_boundary_detail")
        assert holds(by_role, "lines_x_boundary_opening")
        assert not holds(plain, "boundary_detail")
        assert not holds(plain, "boundary_opening")


def test_every_format_with_groups_has_those_of_roles():
    assert BY_ROLE == BY_BAND != []
