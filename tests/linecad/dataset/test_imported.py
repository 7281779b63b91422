"""Buildings that are given as polygons: what is read, and the truth against an independent ray cast."""

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from linecad.arrays import Float
from linecad.cli.main import main
from linecad.dataset.make import measure
from linecad.dataset.plans import plan_views
from linecad.dataset.polygons import read_views
from linecad.dataset.store import read_truth, write_truth
from linecad.dataset.truth import NOTHING, Truth
from linecad.errors import DatasetError
from linecad.evaluation.references import reference_of

TURN = 20.0  # degrees between the two houses
EAVES, RIDGE = 5.0, 8.0  # m
WIDE, DEEP = 8.0, 6.0  # m
SIZE = (96, 64)  # px


def turned(points: list[list[float]], degrees: float, foot: list[float]) -> list[list[float]]:
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])
    found: list[list[float]] = (np.array(points) @ turn + foot).tolist()
    return found


def house(name: str, degrees: float, foot: list[float]) -> dict[str, Any]:
    """A gabled house whose front, with a window cut into it, looks to -y before it is turned."""
    w, d, e, r = WIDE, DEEP, EAVES, RIDGE
    hole = [[3, 0, 1], [3, 0, 3], [5, 0, 3], [5, 0, 1]]
    parts: list[tuple[str, list[Any]]] = [
        ("wall", [[[0, 0, 0], [w, 0, 0], [w, 0, e], [0, 0, e]], hole]),
        ("wall", [[[0, d, 0], [w, d, 0], [w, d, e], [0, d, e]]]),
        ("wall", [[[0, 0, 0], [0, d, 0], [0, d, e], [0, d / 2, r], [0, 0, e]]]),
        ("wall", [[[w, 0, 0], [w, d, 0], [w, d, e], [w, d / 2, r], [w, 0, e]]]),
        ("roof", [[[0, 0, e], [w, 0, e], [w, d / 2, r], [0, d / 2, r]]]),
        ("roof", [[[0, d, e], [w, d, e], [w, d / 2, r], [0, d / 2, r]]]),
        ("window", [[[x, 0.1, z] for x, _, z in hole]]),
    ]
    return {
        "id": name,
        "polygons": [
            {
                "class": kind,
                "object": 1 if kind == "window" else None,
                "rings": [turned(r, degrees, foot) for r in rings],
            }
            for kind, rings in parts
        ],
    }


BUILDINGS = {"buildings": [house("left", 0.0, [-9.0, 12.0, 0.0]), house("right", TURN, [-0.5, 12.0, 0.0])]}
VIEW = {
    "id": "one",
    "position": [-1.0, 0.0, 1.6],
    "look": [0.02, 1.0, 0.1],
    "up": [0, 0, 1],
    "fov_deg": 75.0,
    "ground_z": 0.0,
}


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    buildings, cameras = tmp_path / "buildings.json.gz", tmp_path / "cameras.json"
    buildings.write_bytes(gzip.compress(json.dumps(BUILDINGS).encode()))
    cameras.write_text(json.dumps({"views": [VIEW]}))
    return buildings, cameras


@pytest.fixture
def truth(files: tuple[Path, Path]) -> Truth:
    return measure(plan_views(*files, seed=1).draw(0), *SIZE)


def triangles() -> Float:
    """The polygons as fans, which these may be cut into but for the front with its hole; that is four rectangles."""
    found = []
    for building in BUILDINGS["buildings"]:
        for polygon in building["polygons"]:
            rings = [np.array(ring) for ring in polygon["rings"]]
            if len(rings) == 1:
                outlines = rings
            else:
                (outer, inner), corner = rings, rings[0][0]
                along, up = outer[1] - corner, outer[3] - corner
                place = [((p - corner) @ along / (along @ along), (p - corner) @ up / (up @ up)) for p in inner]
                (a, c), (b, d) = np.min(place, axis=0), np.max(place, axis=0)
                strips = [(0, a, 0, 1), (b, 1, 0, 1), (a, b, 0, c), (a, b, d, 1)]
                outlines = [
                    np.array(
                        [
                            corner + u * along + v * up
                            for u, v in ((left, low), (right, low), (right, high), (left, high))
                        ]
                    )
                    for left, right, low, high in strips
                ]
            found += [np.array([o[0], o[i], o[i + 1]]) for o in outlines for i in range(1, len(o) - 1)]
    return np.array(found)


def cast(origin: Float, rays: Float) -> Float:
    """The factor (N,) of each ray (N, 3) at which it first meets a triangle or the ground; inf for none."""
    with np.errstate(divide="ignore"):
        best = np.where(rays[:, 2] < 0, -origin[2] / rays[:, 2], np.inf)
    for a, b, c in triangles():
        system = np.stack(np.broadcast_arrays(b - a, c - a, -rays), axis=-1)
        flat = np.abs(np.linalg.det(system)) < 1e-9
        system[flat] = np.eye(3)
        u, v, t = np.linalg.solve(system, np.broadcast_to((origin - a)[:, None], (len(rays), 3, 1)))[..., 0].T
        hit = ~flat & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        best = np.where(hit, np.minimum(best, t), best)
    return best


def test_depth_is_that_of_a_ray_cast_through_the_polygons(files: tuple[Path, Path], truth: Truth) -> None:
    view = read_views(files[1])[0].view
    row, column = np.mgrid[: SIZE[1], : SIZE[0]]
    pixels = np.column_stack([column.ravel(), row.ravel(), np.ones(row.size)])
    rays = pixels @ np.linalg.inv(view.matrix(*SIZE) @ view.rotation()).T
    expected, found = cast(view.eye, rays), truth.depth().ravel()
    near = np.isfinite(expected) & (expected < 150)  # the ground ends somewhere
    close = np.abs(found[near] / expected[near] - 1) < 1e-9
    # A ray along the border of two triangles may fall on either side of it.
    assert close.mean() > 0.999
    assert (np.isnan(found) | (found > 150))[~near].all()


def test_the_two_frames_differ_by_the_angle_of_the_houses(truth: Truth) -> None:
    assert truth.frames is not None
    assert sorted(np.round(np.abs(np.degrees(truth.frames.turn)), 6)) == [0.0, TURN]
    of = [set(truth.frames.quad[truth.body == body].tolist()) for body in (1, 2)]
    assert of in ([{0}, {1}], [{1}, {0}])


def test_roofs_slope_and_their_verges_lie_in_the_frame(truth: Truth) -> None:
    assert truth.frames is not None
    slope = np.arctan2(RIDGE - EAVES, DEEP / 2)
    sloped = (truth.frames.quad_slope > 0.01) & (truth.frames.quad_slope < 1.5)
    np.testing.assert_allclose(truth.frames.quad_slope[sloped], slope, rtol=1e-9)
    verge = (truth.frames.edge_slope > 0.01) & (truth.frames.edge_slope < 1.5)
    assert verge.sum() == 8
    assert (truth.frames.edge[verge] != NOTHING).all()


def test_the_world_is_that_of_the_first_frame(truth: Truth) -> None:
    assert truth.frames is not None
    normal, _ = truth.planes()
    first = normal[(truth.frames.quad == 0) & (truth.frames.quad_slope == np.pi / 2)]
    np.testing.assert_allclose(np.abs(first).max(axis=1), 1, rtol=1e-12)
    np.testing.assert_allclose(truth.rotation @ truth.rotation.T, np.eye(3), atol=1e-12)


def test_sides_between_triangles_are_no_edges(truth: Truth) -> None:
    # Of each house 4 upright corners, 4 feet, 2 eaves, a ridge, 4 verges, and 4 sides of the hole and of the pane.
    assert len(truth.edges) == 2 * (4 + 4 + 2 + 1 + 4 + 4 + 4)


def test_a_window_is_told_in_the_plane_of_its_wall(truth: Truth) -> None:
    assert truth.openings is not None
    corners = truth.openings.corners
    sides = np.linalg.norm(corners[:, [1, 3]] - corners[:, [0]], axis=2)
    np.testing.assert_allclose(sides, 2.0, rtol=1e-9)
    front = np.array(turned([[3, 0, 1]], 0.0, [-9.0, 12.0, 0.0])[0]) - [-1.0, 0.0, 1.6]
    assert np.isclose(np.linalg.norm(corners, axis=2), np.linalg.norm(front)).any()


def test_a_truth_with_frames_and_triangles_is_read_as_it_was_written(truth: Truth, tmp_path: Path) -> None:
    write_truth(truth, tmp_path)
    again = read_truth(tmp_path)
    assert truth.frames is not None
    assert again.frames is not None
    np.testing.assert_array_equal(again.quads, truth.quads)
    for name in ("turn", "quad", "quad_slope", "edge", "edge_slope"):
        np.testing.assert_array_equal(getattr(again.frames, name), getattr(truth.frames, name))


def test_depths_of_lines_of_all_frames_are_scored(files: tuple[Path, Path]) -> None:
    truth = measure(plan_views(*files, seed=1).draw(0), 960, 640)
    points = reference_of(truth).edges
    assert points is not None
    shown = truth.body[truth.quad_at(points.pixels)]
    assert (shown == 1).any()
    assert (shown == 2).any()


def test_a_foot_above_the_ground_gets_a_plinth(files: tuple[Path, Path]) -> None:
    files[1].write_text(json.dumps({"views": [VIEW | {"ground_z": -0.5}]}))
    truth = measure(plan_views(*files, seed=1).draw(0), *SIZE)
    low = truth.quads[truth.body > 0][..., 2].min()
    assert low == pytest.approx(-0.5 - 1.6)


@pytest.mark.parametrize(
    ("which", "text", "word"),
    [
        (0, "{", "not JSON"),
        (0, '{"buildings": []}', "holds no buildings"),
        (
            0,
            '{"buildings": [{"id": "a", "polygons": [{"class": "tower", "rings": [[[0,0,0], [1,0,0], [0,1,0]]]}]}]}',
            "class",
        ),
        (0, '{"buildings": [{"id": "a", "polygons": [{"class": "wall", "rings": [[[0, 0, 0]]]}]}]}', "3 points"),
        (1, json.dumps({"views": [VIEW, VIEW]}), "two views"),
        (1, json.dumps({"views": [VIEW | {"id": "../x"}]}), "a name of"),
        (1, json.dumps({"views": [VIEW | {"look": [0, 0, 1]}]}), "look"),
        (1, json.dumps({"views": [VIEW | {"fov_deg": 0}]}), "fov_deg"),
    ],
)
def test_a_bad_file_is_said_in_one_line(files: tuple[Path, Path], which: int, text: str, word: str) -> None:
    files[which].write_bytes(text.encode())
    with pytest.raises(DatasetError) as found:
        plan_views(*files, seed=1)
    assert "\n" not in str(found.value)
    assert word in str(found.value)


@pytest.mark.parametrize(
    "options",
    [["--buildings", "b.json"], ["--scenes", "1"], ["--scenes", "1", "--seed", "1", "--views", "one"]],
)
def test_options_that_need_others_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str]
) -> None:
    assert main(["dataset", str(tmp_path / "set"), *options]) == 1
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "set").exists()
