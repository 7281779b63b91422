import math

import pytest

from expectation import build_expectation
from faults import IN_EXPECTATION, IN_TURNED
from shapes import dot, normal_of
from turned_houses import TURNS, build_scene


def test_lengths_are_metres_from_the_ground_up_and_pixels_count_from_the_corner(expected):
    floor = next(line for line in expected["lines"] if line["group"] == "lines_x_nonboundary" and line["id"] > 30)
    assert floor["ends"] == [[-10.0, 20.0, 0.0], [12.5, 20.0, 0.0]]
    assert expected["camera"]["eye"] == [0.0, 0.0, 4.0]
    assert {"id": 2, "axis": "z", "offset": 0.0} in expected["planes"]
    assert floor["pixels"][0] == pytest.approx([800 * -10 / 20 + 390.8, 800 * 4 / 20 + 311.3])
    assert expected["frame"] == {"width": 820, "height": 624, "left": pytest.approx(19.2), "top": pytest.approx(0.7)}


def test_a_face_is_its_corners_and_its_area_without_the_holes(expected):
    wall = expected["faces"][0]
    assert (wall["name"], wall["axis"], wall["offset"]) == ("face_0004", "y", 25.0)
    assert wall["area"] == pytest.approx((9 * 7.6 - 4 - 2) * 2.5**2)
    assert wall["rings"] == [list(range(first, first + 4)) for first in (0, 4, 8, 12)]


def test_without_a_ground_the_camera_is_the_origin(document):
    for plane in document["planes"]:
        for face in plane["faces"]:
            face["kind"] = face["kind"].replace("ground", "other")
    assert build_expectation(document)["camera"]["eye"] == [0.0, 0.0, 0.0]


def test_without_a_scale_a_unit_is_a_metre_and_the_camera_the_origin(document):
    document["metres_per_unit"] = None
    expected = build_expectation(document)
    assert expected["camera"]["eye"] == [0.0, 0.0, 0.0]
    assert {"id": 2, "axis": "z", "offset": -1.6} in expected["planes"]


def test_an_opening_has_its_faces_and_reveals_look_into_it(expected):
    first, second = expected["openings"]
    assert first["faces"] == [f"face_{number:04d}" for number in range(10, 15)]
    assert (first["label"], second["label"], first["shape"]) == ("window 1", "window 2", second["shape"])
    faces = {face["name"]: face for face in expected["faces"]}
    assert [faces[name]["label"] for name in first["faces"][:2]] == ["window 1", "reveal of window 1"]
    for opening in (first, second):
        assert [sum(faces[name]["normal"]) for name in opening["faces"]] == [-1.0, 1.0, -1.0, 1.0, -1.0]


def test_walls_of_further_frames_look_along_their_axes():
    expected = build_expectation(build_scene())
    faces = {face["name"]: face for face in expected["faces"]}
    assert [faces[f"face_{number:04d}"]["axis"] for number in (0, 1, 3, 4, 6, 7, 9)] == [
        "y", "x", "y2", "x2", "y3", "x3", "z",
    ]  # fmt: skip
    assert [faces[f"face_{number:04d}"]["frame"] for number in (1, 4, 7, 9)] == [0, 1, 2, None]
    for number, turn in ((0, 0.0), (3, TURNS[0]), (6, TURNS[1])):
        assert faces[f"face_{number:04d}"]["normal"] == pytest.approx([math.sin(turn), -math.cos(turn), 0.0])
    for face in expected["faces"]:
        normal = normal_of(*(face["corners"][number] for number in face["rings"][0][:3]))
        assert abs(dot(normal, face["normal"])) == pytest.approx(math.hypot(*normal))
    groups = expected["groups"]
    assert set(groups) == {f"lines_{axis}_boundary" for axis in ("x", "y", "z", "x2", "y2", "x3", "y3")}
    colours = [tuple(group["srgb"]) for group in groups.values()]
    assert len(set(colours)) == len(colours)


def test_lines_of_a_group_are_red_green_and_blue_or_paler(expected):
    assert expected["groups"]["lines_x_boundary"]["srgb"] == pytest.approx([0.87, 0.16, 0.16])
    assert expected["groups"]["lines_x_nonboundary"]["srgb"] == pytest.approx([0.935, 0.58, 0.58])
    assert expected["groups"]["lines_x_boundary"]["linear"][0] == pytest.approx(0.7294, abs=1e-4)


def test_groups_by_band_end_in_how_sure_they_are_where_the_scene_tells(told, document):
    expected = build_expectation(told, by_band=True)
    bands = {line["id"]: line["group"].rsplit("_")[-1] for line in expected["lines"]}
    assert [bands[line["id"]] for line in told["lines"][:5]] == ["sure", "likely", "guess", "sure", "guess"]
    assert build_expectation(told) == build_expectation(document, by_band=True) == build_expectation(document)


def test_groups_by_role_end_in_it_but_for_outlines(drawn):
    plain, by_role = build_expectation(drawn), build_expectation(drawn, by_role=True)
    assert [line["role"] for line in plain["lines"][:3]] == ["outline", "opening", "detail"]
    for before, after in zip(plain["lines"], by_role["lines"], strict=True):
        assert after["group"] == before["group"] + {"outline": ""}.get(after["role"], f"_{after['role']}")


def test_faces_are_called_by_their_kind(document):
    del document["planes"][2:]
    faces = [face for plane in document["planes"] for face in plane["faces"]]
    assert [face["label"] for face in build_expectation(document)["faces"]] == ["wall", "ground"]
    del faces[0]["kind"]
    faces[1]["kind"] = "other"
    assert [face["label"] for face in build_expectation(document)["faces"]] == ["other 1", "other 2"]


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda scene: scene.update(version=2), "not a scene file"),
        (lambda scene: scene.update(turns=[0.1]), "not a scene file"),
        (lambda scene: scene["camera"]["K"][0].__setitem__(1, 0.5), "without skew"),
        (lambda scene: scene["camera"]["R_cam_from_world"][0].__setitem__(0, 0.9), "no rotation"),
        (lambda scene: scene["lines"][0]["ends"][0].__setitem__(1, -1.0), "behind the camera"),
    ],
)
def test_what_no_program_could_show_is_refused(document, change, reason):
    change(document)
    with pytest.raises(ValueError, match=reason):
        build_expectation(document)


@pytest.mark.parametrize("fault", IN_EXPECTATION)
def test_every_fault_changes_the_expectation(expected, document, fault):
    fault(expected)
    assert expected != build_expectation(document)


@pytest.mark.parametrize("fault", IN_TURNED)
def test_every_fault_of_turned_walls_changes_the_expectation(fault):
    expected = build_expectation(build_scene())
    fault(expected)
    assert expected != build_expectation(build_scene())
