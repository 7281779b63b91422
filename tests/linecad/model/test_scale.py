"""The scale from a known length: right in a scene of known size, refused where the scene cannot be measured."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.errors import ScaleError
from linecad.geometry import project
from linecad.io.scene_file import scene_from_json, scene_to_json
from linecad.model.scale import CameraHeight, LineLength, PointDistance, find_ground, is_measurable, set_scale
from linecad.scene import Camera, Face, Intersections, Lines, Opening, Plane, Scene, SolveReport

UNIT = 0.25  # m a unit; the scene below is a wall 2.5 m before a camera that stands 0.4 m above the ground
K = np.array([[1000.0, 0, 640], [0, 1000, 480], [0, 0, 1]])
TURN = np.radians(20)
R = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ np.array(
    [[np.cos(TURN), -np.sin(TURN), 0], [np.sin(TURN), np.cos(TURN), 0], [0, 0, 1]]
)
ENDS = np.array([
    [[-3, 10, -1.6], [4, 10, -1.6]],  # 0: the foot of the wall
    [[-3, 10, -1.6], [-3, 10, 4]],  # 1: its left edge
    [[4, 10, -1.6], [4, 10, 4]],  # 2: its right edge
    [[-3, 10, 4], [4, 10, 4]],  # 3: its top
    [[-3, 10, -1.6], [-3, 6, -1.6]],  # 4: on the ground
    [[0, 10, 1], [2, 10, 1]],  # 5: a sill
    [[-1, 9, 1], [-1, 9, 3]],  # 6: of another component
])  # fmt: skip
WALL = [[-3, 10, -1.6], [4, 10, -1.6], [4, 10, 4], [-3, 10, 4]]
WINDOW = [[0, 10, 1], [0, 10, 3], [2, 10, 3], [2, 10, 1]]
GROUND = [[-3, 10, -1.6], [-3, 6, -1.6], [4, 6, -1.6], [4, 10, -1.6]]


def made_scene():
    axis = np.abs(ENDS[:, 1] - ENDS[:, 0]).argmax(axis=1)
    lines = Lines(
        id=10 + np.arange(7),
        axis=axis,
        segment=project(ENDS, K, R),
        ends=ENDS,
        is_boundary=[False] * 7,
        component=[0, 0, 0, 0, 0, 0, 1],
        confidence=["proven"] * 6 + ["weak"],
    )
    planes = (
        Plane(3, 1, 10.0, (10, 11, 12, 13, 15), (Face(0, WALL, (WINDOW,)),)),
        Plane(4, 2, -1.6, (10, 14), (Face(1, GROUND),)),
        Plane(5, 2, 1.0, (15,)),
    )
    none = Intersections(lines=[], kind=[], pixel=[], real=[], in_tree=[], weight=[])
    report = SolveReport("x", "gain", "optimal", 0, 0, 0)
    return Scene("a.jpg", Camera(1280, 960, K, "file"), R, lines, none, planes, report, notes=("a warning",))


@pytest.fixture
def scene():
    return made_scene()


def pixel(*point):
    u, v = project(np.array(point, float), K, R).tolist()
    return u, v


def with_planes(scene, *planes):
    return replace(scene, planes=planes)


def test_a_line_by_its_id(scene):
    measured = set_scale(scene, LineLength(13, 7 * UNIT))
    assert measured.metres_per_unit == pytest.approx(UNIT)


def test_nothing_but_the_unit_and_its_source_changes(scene):
    measured = set_scale(scene, LineLength(13, 7 * UNIT))
    assert measured.lines is scene.lines
    assert measured.planes is scene.planes
    assert measured.notes == ("a warning",)
    assert measured.scale_source == "line 13 is 1.75 m long, so a unit is 0.25 m"
    assert measured.remarks == ("a warning", f"scale: {measured.scale_source}")
    again = scene_from_json(scene_to_json(measured))
    assert (again.metres_per_unit, again.scale_source) == (measured.metres_per_unit, measured.scale_source)


def test_a_second_length_replaces_the_first(scene):
    twice = set_scale(set_scale(scene, LineLength(13, 999)), LineLength(13, 7 * UNIT))
    assert twice.metres_per_unit == pytest.approx(UNIT)
    assert len(twice.remarks) == 2


@pytest.mark.parametrize(
    ("first", "second", "units", "where"),
    [
        ((-2, 10, -1.6), (3, 10, -1.6), 5, "line 10"),
        ((4, 10, 0), (4, 10, 2), 2, "line 12"),
        ((-2, 10, 0), (3, 10, 3.5), np.hypot(5, 3.5), "plane 3 (y)"),
        ((-2, 7, -1.6), (3, 8, -1.6), np.hypot(5, 1), "plane 4 (z)"),
        ((-2, 10, 3), (2, 7, -1.6), np.sqrt(16 + 9 + 4.6**2), "plane 3 (y) and plane 4 (z)"),
    ],
)
def test_two_points_on_lines_and_faces(scene, first, second, units, where):
    measured = set_scale(scene, PointDistance((pixel(*first), pixel(*second)), units * UNIT))
    assert measured.metres_per_unit == pytest.approx(UNIT, rel=1e-9)
    assert where in measured.scale_source


def test_points_beside_a_line_count_as_on_it(scene):
    (u, v), second = pixel(-2, 10, 4), pixel(3, 10, 4)
    measured = set_scale(scene, PointDistance(((u, v - 4), second), 5 * UNIT))
    assert measured.metres_per_unit == pytest.approx(UNIT, rel=0.01)
    assert "line 13" in measured.scale_source


def test_a_point_beside_a_face_is_on_the_line_there(scene):
    (u, v), second = pixel(4, 10, 2), pixel(2, 7, -1.6)
    measured = set_scale(scene, PointDistance(((u + 3, v), second), np.sqrt(4 + 9 + 3.6**2) * UNIT))
    assert measured.metres_per_unit == pytest.approx(UNIT, rel=0.01)
    assert "line 12 and plane 4 (z)" in measured.scale_source


@given(st.floats(-2.9, 3.9), st.floats(-1.5, 3.9), st.floats(1e-3, 1e3))
def test_any_distance_on_the_wall(u, v, metres):
    scene = with_planes(made_scene(), Plane(3, 1, 10.0, (10,), (Face(0, WALL),)))
    start = (-1.7, 10.0, 0.4)
    units = np.hypot(u - start[0], v - start[2])
    if units < 0.5:
        return
    measured = set_scale(scene, PointDistance((pixel(*start), pixel(u, 10, v)), metres))
    assert measured.metres_per_unit == pytest.approx(metres / units, rel=0.03)  # a line near both may be taken


@pytest.mark.parametrize(
    ("first", "second", "words"),
    [
        ((1, 10, 2), (-2, 10, 3), "the first point lies on no face"),
        ((-2, 10, 3), (1, 10, 2), "the second point lies on no face"),
        ((-2, 10, 3), (-2, 10, 3), "measures nothing"),
    ],
)
def test_points_that_cannot_be_measured_are_refused(scene, first, second, words):
    with pytest.raises(ScaleError) as caught:
        set_scale(scene, PointDistance((pixel(*first), pixel(*second)), 1.0))
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("line", "words"),
    [(99, "no line 99, it has ids up to 16"), (16, "line 16 belongs to component 1")],
)
def test_a_line_that_cannot_be_measured_is_refused(scene, line, words):
    with pytest.raises(ScaleError, match=words):
        set_scale(scene, LineLength(line, 1.0))


def test_the_lines_of_another_component_are_not_measured_by_points(scene):
    with pytest.raises(ScaleError, match="the first point lies on no face"):
        set_scale(with_planes(scene), PointDistance((pixel(-1, 9, 1.2), pixel(-1, 9, 2.8)), 1.0))


def with_probability(scene, *probability):
    return replace(scene, lines=replace(scene.lines, probability=list(probability)))


def test_where_probabilities_are_told_lines_of_every_component_are_measured(scene):
    told = with_probability(scene, *[0.9] * 6, 0.6)
    assert set_scale(told, LineLength(16, 2 * UNIT)).metres_per_unit == pytest.approx(UNIT)
    by_points = set_scale(told, PointDistance((pixel(-1, 9, 1.2), pixel(-1, 9, 2.8)), 1.6 * UNIT))
    assert by_points.metres_per_unit == pytest.approx(UNIT)


def test_a_scale_from_a_guess_says_so(scene):
    told = with_probability(scene, *[0.4] * 6, 0.6)
    by_line = set_scale(told, LineLength(13, 7 * UNIT))
    assert by_line.scale_source == "line 13, at a depth that is a guess, is 1.75 m long, so a unit is 0.25 m"
    by_points = set_scale(told, PointDistance((pixel(-2, 10, 0), pixel(3, 10, 3.5)), np.hypot(5, 3.5) * UNIT))
    assert by_points.metres_per_unit == pytest.approx(UNIT)
    assert "px, on plane 3 (y), at a depth that is a guess, are" in by_points.scale_source
    on_both = set_scale(told, PointDistance((pixel(-2, 10, 3), pixel(2, 7, -1.6)), 1.0))
    assert "on plane 3 (y), at a depth that is a guess, and plane 4 (z), at a depth" in on_both.scale_source
    on_a_line = set_scale(with_planes(told), PointDistance((pixel(-2, 10, 4), pixel(3, 10, 4)), 5 * UNIT))
    assert on_a_line.metres_per_unit == pytest.approx(UNIT)
    assert "on line 13, at a depth that is a guess, are" in on_a_line.scale_source


def test_a_guessed_pole_before_wall_and_ground_is_measured_itself(scene):
    ends = ENDS.copy()
    ends[6] = [[-1, 8, -1.6], [-1, 8, 3]]
    lines = replace(scene.lines, ends=ends, segment=project(ends, K, R), probability=[0.9] * 6 + [0.4])
    told = replace(scene, lines=lines)
    pole = set_scale(told, PointDistance((pixel(-1, 8, -1.5), pixel(-1, 8, 2)), 3.5 * UNIT))
    assert pole.metres_per_unit == pytest.approx(UNIT)
    assert "on line 16, at a depth that is a guess, are" in pole.scale_source
    on_wall = set_scale(told, PointDistance((pixel(-1, 8, 0), pixel(-1, 8, 2)), 2.5 * UNIT))
    assert on_wall.metres_per_unit == pytest.approx(UNIT)
    assert "on plane 3 (y), are" in on_wall.scale_source


def test_a_point_on_a_guessed_face_is_on_the_sure_line_there(scene):
    told = with_probability(scene, 0.4, 0.9, 0.4, 0.4, 0.4, 0.4, 0.4)  # line 11 is the wall's left edge
    (u, v), second = pixel(-3, 10, 2), pixel(2, 7, -1.6)
    ground = replace(scene.planes[1], faces=(Face(1, GROUND, kind="ground"),))
    told = with_planes(told, scene.planes[0], ground)
    measured = set_scale(told, PointDistance(((u + 3, v), second), np.sqrt(25 + 9 + 3.6**2) * UNIT))
    assert measured.metres_per_unit == pytest.approx(UNIT, rel=0.01)
    assert "line 11 and plane 4 (z)" in measured.scale_source


@pytest.mark.parametrize(("sure", "is_taken"), [(2, False), (3, True)])
def test_a_plane_is_measured_where_half_of_its_lines_are(scene, sure, is_taken):
    told = with_probability(scene, *[0.9] * sure, *[0.4] * (7 - sure))
    wall = replace(scene.planes[0], lines=(10, 11, 12, 13, 15, 16))
    assert is_measurable(with_planes(told, wall), wall) == is_taken


def test_the_ground_is_always_measured_and_a_wall_without_lines_never(scene):
    told = with_probability(scene, *[0.4] * 7)
    ground = replace(scene.planes[1], faces=(Face(1, GROUND, kind="ground"),))
    points = PointDistance((pixel(-2, 7, -1.6), pixel(3, 8, -1.6)), np.hypot(5, 1) * UNIT)
    measured = set_scale(with_planes(told, ground), points)
    assert measured.metres_per_unit == pytest.approx(UNIT)
    assert "on plane 4 (z), are" in measured.scale_source
    bare = replace(scene.planes[0], lines=())
    with pytest.raises(ScaleError, match="on plane 3, which stands at a depth that is a guess or that no line tells"):
        set_scale(with_planes(scene, bare), PointDistance((pixel(-2, 10, 0), pixel(3, 10, 3.5)), 1.0))


def test_a_face_of_another_component_is_not_measured_where_no_probability_is_told(scene):
    wall = replace(scene.planes[0], lines=(16,))
    with pytest.raises(ScaleError, match="on plane 3, which stands"):
        set_scale(with_planes(scene, wall), PointDistance((pixel(-2, 10, 0), pixel(3, 10, 3.5)), 1.0))


def check_as_sure_as_the_wall(scene, points, plane):
    told = set_scale(with_probability(scene, *[0.9] * 7), points)
    assert told.metres_per_unit == pytest.approx(UNIT)
    assert f"on {plane}, are" in told.scale_source
    assert f"{plane}, at a depth" in set_scale(with_probability(scene, *[0.4] * 6, 0.9), points).scale_source


def test_a_pane_is_as_sure_as_the_wall_around_it(scene):
    pane = Plane(7, 1, 10.2, (), (Face(5, [[0, 10.2, 1.02], [2, 10.2, 1.02], [2, 10.2, 3], [0, 10.2, 3]], opening=0),))
    window = Opening(0, 3, 0.0, 2.0, 1.0, 3.0, "window", 0.2, 10.2)
    glazed = replace(scene, planes=(*scene.planes, pane), openings=(window,))
    points = PointDistance((pixel(0.5, 10.2, 1.5), pixel(1.5, 10.2, 2.5)), np.sqrt(2) * UNIT)
    check_as_sure_as_the_wall(glazed, points, "plane 7 (y)")


def test_a_roof_is_as_sure_as_its_wall(scene):
    face = Face(2, [[0, 10, 4], [2, 10, 4], [2, 12, 6], [0, 12, 6]], kind="roof")
    roofed = with_planes(scene, *scene.planes, Plane(8, 1, -6 / np.sqrt(2), (), (face,), tilt=np.radians(135)))
    points = PointDistance((pixel(0.5, 10.5, 4.5), pixel(1.5, 11.5, 5.5)), np.sqrt(3) * UNIT)
    check_as_sure_as_the_wall(roofed, points, "plane 8 (y)")


def test_the_height_of_the_camera_above_the_ground(scene):
    assert find_ground(scene).id == 4
    measured = set_scale(scene, CameraHeight(0.4))
    assert measured.metres_per_unit == pytest.approx(UNIT)
    assert "plane 4 (z = -1.6)" in measured.scale_source


SHOWN = Plane(12, 2, -2.0, (), (Face(2, [[x, y, -2.0] for x, y, _ in GROUND], kind="ground"),))


def test_the_face_of_the_ground_is_measured_from_though_no_line_lies_in_its_plane(scene):
    assert find_ground(with_planes(scene, *scene.planes, SHOWN)).id == 12
    measured = set_scale(with_planes(scene, *scene.planes, SHOWN), CameraHeight(0.5))
    assert measured.metres_per_unit == pytest.approx(UNIT)
    assert measured.scale_source == "the camera is 0.5 m above the ground, plane 12 (z = -2), so a unit is 0.25 m"


def test_the_face_of_the_ground_is_believed_where_lines_stray_below_it_or_lower_planes_lie(scene):
    high = replace(SHOWN, offset=-1.0, faces=(Face(2, [[x, y, -1.0] for x, y, _ in GROUND], kind="ground"),))
    assert find_ground(with_planes(scene, *scene.planes, high)).id == 12


def test_the_lowest_of_several_grounds_is_measured_from(scene):
    kerb = replace(SHOWN, id=13, offset=-1.9, faces=(Face(3, [[x, y, -1.9] for x, y, _ in GROUND], kind="ground"),))
    assert find_ground(with_planes(scene, *scene.planes, SHOWN, kerb)).id == 12


@pytest.mark.parametrize(("axis", "sign"), [(1, -1), (2, 1)])
def test_a_ground_that_is_upright_or_above_the_camera_is_none(scene, axis, sign):
    points = np.insert(np.array(GROUND)[:, :2], axis, 2.0 * sign, axis=1)
    false = Plane(12, axis, 2.0 * sign, (), (Face(2, points, kind="ground"),))
    assert find_ground(with_planes(scene, *scene.planes, false)).id == 4


def test_without_a_horizontal_plane_below_the_camera_there_is_no_ground(scene):
    with pytest.raises(ScaleError, match="give a known length"):
        set_scale(with_planes(scene, scene.planes[0], scene.planes[2]), CameraHeight(1.6))


def test_a_plane_of_another_component_is_not_the_ground(scene):
    other = Plane(9, 2, -5.0, (16,))
    assert find_ground(with_planes(scene, *scene.planes, other)).id == 4


def test_a_row_of_sills_above_the_feet_of_walls_is_not_the_ground(scene):
    sills = Plane(9, 2, -0.5, (15,))
    with pytest.raises(ScaleError, match=r"4 lines reach below it, down to z = -1\.6"):
        find_ground(with_planes(scene, sills))


def test_a_line_or_two_may_stray_below_the_ground(scene):
    ends = ENDS.copy()
    ends[1, 0, 2] = ends[2, 0, 2] = -1.9
    assert find_ground(replace(scene, lines=replace(scene.lines, ends=ends))).id == 4
