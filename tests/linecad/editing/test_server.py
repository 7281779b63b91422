"""What the page can ask for: state, tiles, edits, undo, solving, labels, exports."""

import io
import json
import re
import zipfile
from dataclasses import replace

import cv2
import numpy as np
import pytest

from exporters.formats import FORMATS
from linecad.cli.main import main
from linecad.confidence import with_lines
from linecad.corrections.file import corrections_from_json, corrections_to_json
from linecad.corrections.snapping import Proposal, Snap
from linecad.editing.depth_layers import DIVERGING
from linecad.editing.document import document_of
from linecad.editing.tiles import TILE
from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.references import open_case
from linecad.options import Options
from linecad.pipeline import reconstruct
from linecad.scene import REASONS


def crossings(state, **wanted):
    return [one for one in state["crossings"] if all(one[key] == value for key, value in wanted.items())]


class TestState:
    def test_it_tells_lines_and_crossings_before_anything_is_solved(self, page, made):
        state = page.state()
        assert state["photo"] == {"name": "made.jpg", "width": 1600, "height": 1200, "tile": TILE, "levels": 3}
        assert len(state["lines"]) > 20
        assert {line["origin"] for line in state["lines"]} == {"found"}
        assert {line["ends"] for line in state["lines"]} == {None}
        ids = {line["id"] for line in state["lines"]}
        assert {line for crossing in state["crossings"] for line in crossing["lines"]} <= ids
        assert len({crossing["id"] for crossing in state["crossings"]}) == len(state["crossings"])
        assert np.abs(np.array(state["R_cam_from_world"]) - made.frame.rotation).max() < 0.01
        assert (state["undo"], state["redo"], state["saved"], state["contradiction"]) == (0, 0, True, None)

    def test_it_tells_how_sure_the_camera_is(self, page):
        assert re.match(r"camera (good|doubtful|poor): .+; focal length \d", page.state()["camera"])

    def test_after_a_solve_it_tells_the_model(self, page, made_photo):
        state = page.solve()
        scene = reconstruct(made_photo, Options())
        # What faces added is in the model, also as a piece of a line, and nothing that a person can correct.
        known = {str(line["segment"]) for line in state["lines"]}
        seen = {str(line["segment"]) for line in state["lines"] if line["ends"] is not None}
        rows = np.flatnonzero(~scene.lines.by_face).tolist()
        pieces = [{str(piece.tolist()) for piece in scene.lines.segments_of(row)} for row in rows]
        assert seen == set.union(*pieces) & known
        assert all(own & seen for own in pieces)
        assert len(crossings(state, real=True)) == scene.intersections.real.sum()
        assert [plane["offset"] for plane in state["planes"]] == [plane.offset for plane in scene.planes]
        assert state["solve"]["state"] == "idle"
        assert (state["solve"]["status"], state["solve"]["gap"]) == ("optimal", 0.0)
        assert state["solve"]["seconds"] > 0

    def test_pieces_of_one_line_stand_where_it_does(self, page):
        page.solve()
        now = page.session.now()
        scene = now.model.scene
        plane = scene.planes[0]
        in_plane = np.isin(scene.lines.id, plane.lines) & (scene.lines.axis == (plane.axis + 1) % 3)
        first, second = scene.lines.id[in_plane][:2].tolist()
        joined = with_lines(scene, scene.lines.id != second)
        row = int(np.flatnonzero(joined.lines.id == first)[0])
        pieces = [np.zeros((0, 2, 2))] * len(joined.lines)
        pieces[row] = scene.lines.segment[np.isin(scene.lines.id, [first, second])]
        joined = replace(joined, lines=replace(joined.lines, pieces=tuple(pieces)))
        document = document_of(replace(now, model=replace(now.model, scene=joined)), 1, True)
        segments = pieces[row].tolist()
        ids = [line["id"] for line in document["lines"] if line["segment"] in segments]
        ends = [line["ends"] for line in document["lines"] if line["segment"] in segments]
        assert ends == [joined.lines.ends[row].tolist()] * 2
        assert set(ids) <= set(document["planes"][0]["lines"])

    def test_it_tells_how_likely_the_depth_of_each_line_is_right(self, page):
        page.solve()
        now = page.session.now()
        lines = now.model.scene.lines
        for probability, weak, shown in (
            (0.25, False, {(0.25, True)}),
            (0.5, True, {(0.5, False)}),
            (None, True, {(None, True)}),
            (None, False, {(None, False)}),
        ):
            changed = replace(
                lines,
                probability=() if probability is None else np.full(len(lines), probability),
                confidence=np.full(len(lines), "weak" if weak else "supported"),
            )
            model = replace(now.model, scene=replace(now.model.scene, lines=changed))
            document = document_of(replace(now, model=model), 1, True)
            placed = [line for line in document["lines"] if line["ends"] is not None]
            assert len(placed) == (~lines.by_face).sum()
            assert {(line["probability"], line["guess"]) for line in placed} == shown
            faces = [face for plane in document["planes"] for face in plane["faces"]]
            assert {face["guess"] for face in faces} == {guess for _, guess in shown}

    def test_the_triangles_of_a_face_cover_it(self, page):
        faces = [(plane["axis"], face) for plane in page.solve()["planes"] for face in plane["faces"]]
        assert faces
        for axis, face in faces:
            flat = [k for k in range(3) if k != "xyz".index(axis)]
            rings = [np.array(ring)[:, flat] for ring in (face["outline"], *face["holes"])]
            points = np.concatenate(rings)
            corners = points[np.array(face["triangles"])]
            openings = sum(abs(ring_area(ring)) for ring in rings[1:])
            assert np.abs(area(corners)).sum() == pytest.approx(abs(ring_area(rings[0])) - openings)

    def test_only_numbers_that_json_knows(self, page):
        page.solve()
        json.loads(page.get("state").text, parse_constant=lambda token: pytest.fail(f"{token} is no JSON"))


def area(corners):
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2


def ring_area(ring):
    x, y = (ring - ring[0]).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2


class TestTiles:
    def test_they_make_up_the_photo(self, page, made_photo):
        image = np.zeros((1200, 1600, 3), np.uint8)
        for row in range(3):
            for column in range(4):
                data = page.get(f"tile/0/{column}/{row}").content
                part = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
                image[row * TILE : row * TILE + len(part), column * TILE : column * TILE + part.shape[1]] = part
        assert np.abs(image.astype(float) - made_photo.pixels).mean() < 2

    def test_the_last_level_is_one_tile(self, page):
        levels = page.state()["photo"]["levels"]
        data = page.get(f"tile/{levels - 1}/0/0").content
        assert cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR).shape == (300, 400, 3)
        assert page.get(f"tile/{levels - 1}/1/0").status_code == 404

    @pytest.mark.parametrize(
        "tile", ["9/0/0", "0/4/0", "0/0/3", "-1/0/0", "0/0/-1", "0/0/x", "0/0/99999999999999999999"]
    )
    def test_there_are_no_others(self, page, tile):
        assert page.get(f"tile/{tile}").status_code == 404


class TestDepthMap:
    def test_without_one_there_are_no_layers(self, page):
        page.solve()
        assert page.state()["depth_map"] is None
        assert page.get("depth/depth").status_code == 404
        assert page.get("depth/difference").status_code == 404

    def test_the_map_is_there_at_once_and_the_difference_after_a_solve(self, open_page, map_of_made):
        page = open_page(depth=map_of_made)
        assert page.state()["depth_map"] == {"text": "depth map made.depth.npz", "depth": 0, "difference": None}
        before = page.get("depth/depth")
        assert before.headers["content-type"] == "image/png"
        assert page.get("depth/difference").status_code == 404
        told = page.solve()["depth_map"]
        assert told["text"].startswith("depth map made.depth.npz: z, width of its errors")
        assert told["depth"] == told["difference"] > 0
        colours = [picture(page.get(f"depth/{layer}").content) for layer in ("depth", "difference")]
        assert [image.shape for image in colours] == [(1200, 1600, 4)] * 2
        assert (colours[0] == picture(before.content)).all()
        assert (colours[0][..., 3] == 255).all()
        known = colours[1][..., 3] > 0
        assert 0.1 < known.mean() < 0.9
        middle = [int(DIVERGING[2][at : at + 2], 16) for at in (5, 3, 1)]
        assert (np.abs(colours[1][known][:, :3].astype(int) - middle).max(axis=1) < 12).mean() > 0.8

    def test_each_solve_renews_the_numbers_of_the_layers(self, open_page, map_of_made):
        page = open_page(depth=map_of_made)
        first = page.solve()["depth_map"]
        page.edit(op="delete", line=page.state()["lines"][0]["id"])
        assert page.state()["depth_map"] == first
        second = page.solve()["depth_map"]
        assert second["depth"] > first["depth"]
        assert second["difference"] > first["difference"]

    def test_one_that_is_left_out_says_why_and_has_no_difference(self, open_page, map_of_made):
        flat = np.full_like(map_of_made.values, 3.0)
        page = open_page(depth=replace(map_of_made, values=flat))
        told = page.solve()["depth_map"]
        assert told["text"] == "depth map made.depth.npz left out: it holds one depth throughout"
        assert told["difference"] is None
        assert page.get("depth/difference").status_code == 404
        assert page.get("depth/depth").status_code == 200

    @pytest.mark.parametrize("layer", ["other", "", "..%2F..", "depth/depth"])
    def test_there_are_no_other_layers(self, open_page, map_of_made, layer):
        assert open_page(depth=map_of_made).get(f"depth/{layer}").status_code == 404

    def test_the_state_tells_which_lines_the_map_placed(self, page):
        page.solve()
        now = page.session.now()
        scene = now.model.scene
        lines = replace(scene.lines, by_depth_map=np.arange(len(scene.lines)) < 3)
        document = document_of(replace(now, model=replace(now.model, scene=replace(scene, lines=lines))), 1, True)
        segments = [line["segment"] for line in document["lines"] if line["by_depth_map"]]
        assert sorted(segments) == sorted(scene.lines.segment[:3].tolist())


def picture(data):
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)


class TestEdits:
    def test_each_makes_a_new_version_and_one_step_to_undo(self, page):
        before = page.state()
        state = page.edit(op="delete", line=before["lines"][0]["id"])
        assert state["version"] == before["version"] + 1
        assert state["undo"] == 1
        assert state["lines"] == before["lines"][1:]

    def test_a_label_is_shown_and_counted(self, page):
        crossing = page.state()["crossings"][4]["id"]
        state = page.edit(op="label", crossing=crossing, value="unsure")
        assert crossings(state, label="unsure") == crossings(state, id=crossing)
        assert (state["labelling"]["done"], state["labelling"]["total"]) == (1, len(state["crossings"]))
        assert page.edit(op="label", crossing=crossing, value=None)["labelling"]["done"] == 0

    def test_a_drawn_line_gets_the_proposed_axis_and_place(self, page):
        ends = [[700.0, 200.0], [702.0, 420.0]]
        proposed = page.post("propose", ends=ends).json()
        assert page.state()["undo"] == 0
        state = page.edit(op="draw", ends=ends, axis=None)
        line = state["lines"][-1]
        assert (line["origin"], line["axis"]) == ("drawn", proposed["axis"])
        assert np.array(line["segment"]) == pytest.approx(np.array(proposed["ends"]))

    def test_an_axis_can_be_forced(self, page):
        ends = [[700.0, 200.0], [702.0, 420.0]]
        assert page.post("propose", ends=ends, axis="x").json()["axis"] == "x"
        assert page.edit(op="draw", ends=ends, axis="x")["lines"][-1]["axis"] == "x"

    def test_a_line_far_off_every_axis_is_drawn_along_none_unasked(self, page):
        ends = [[700.0, 200.0], [790.0, 420.0]]
        proposed = page.post("propose", ends=ends).json()
        assert proposed["is_bent"]
        assert proposed["off"] > 4
        assert [proposed["axis"], proposed["off"]] == proposed["axes"][0]
        assert sorted(name for name, _ in proposed["axes"]) == ["x", "y", "z"]
        text = page.refused(422, "edit", edit={"op": "draw", "ends": ends, "axis": None})
        assert f"{proposed['off']:.0f} degrees off {proposed['axis']}, the nearest axis; say which" in text
        assert page.edit(op="draw", ends=ends, axis="z")["lines"][-1]["axis"] == "z"

    def test_an_axis_of_a_further_frame_is_proposed_by_its_name(self, page, monkeypatch):
        found = Proposal(np.array([[700.0, 200.0], [702.0, 420.0]]), 4, (None, Snap(np.zeros(2), 7, True)), 0.1)
        monkeypatch.setattr("linecad.editing.edits.propose", lambda *_: found)
        proposed = page.post("propose", ends=found.ends.tolist()).json()
        assert (proposed["axis"], proposed["ends"]) == ("y2", found.ends.tolist())
        assert proposed["snapped"] == [None, {"line": 7, "is_end": True}]

    def test_a_point_snaps_as_far_as_the_page_reaches(self, page):
        line = page.state()["lines"][0]
        at = np.add(line["segment"][0], [3.0, 0.0]).tolist()
        near, far = (page.post("propose", ends=[at], reach=reach).json() for reach in (5, 1e-3))
        assert near["snapped"][0]["is_end"]
        assert near["ends"][0] != at == far["ends"][0]
        assert page.post("propose", ends=[at]).json()["snapped"] == [None]

    @pytest.mark.parametrize(
        "body",
        [
            {"ends": [[700, 200], [701, 200]]},
            {"line": 0, "end": 1, "at": None},
            {"line": 10**6, "end": 0, "at": [1, 1]},
        ],
    )
    def test_a_place_where_no_line_can_end_is_an_answer(self, page, body):
        """The browser wrote an error on its console for each place that the pointer passed there."""
        if body.get("at", 0) is None:
            body = {**body, "at": page.state()["lines"][0]["segment"][0]}
        answer = page.post("propose", **body)
        assert answer.status_code == 200
        assert list(answer.json()) == ["refused"]

    def test_an_end_that_is_dragged_moves_along_its_line(self, page):
        line = max(page.state()["lines"], key=lambda one: np.linalg.norm(np.subtract(*one["segment"])))
        start, end = np.array(line["segment"])
        at = (start + 0.7 * (end - start)).tolist()
        proposed = page.post("propose", line=line["id"], end=1, at=at).json()
        state = page.edit(op="ends", line=line["id"], end=1, at=at)
        now = next(one for one in state["lines"] if one["id"] == line["id"])
        assert now["segment"] == proposed["ends"]
        assert now["segment"] == pytest.approx(np.array([start, at]))
        assert page.change("undo")["lines"] == page.state()["lines"]
        assert next(one for one in page.state()["lines"] if one["id"] == line["id"]) == line

    def test_many_edits_are_one_step_all_or_none(self, page):
        before = page.state()
        lines = [line["id"] for line in before["lines"][:3]]
        crossings = [each["id"] for each in before["crossings"] if not set(each["lines"]) & set(lines)][:4]
        edits = [{"op": "delete", "line": line} for line in lines]
        edits += [{"op": "label", "crossing": crossing, "value": "fake"} for crossing in crossings]
        text = page.refused(422, "edit", edit={"op": "many", "edits": [*edits, {"op": "delete", "line": 10**6}]})
        assert "no line 1000000 any more" in text
        state = page.edit(op="many", edits=edits)
        assert not {line["id"] for line in state["lines"]} & set(lines)
        assert [each["id"] for each in state["crossings"] if each["label"] == "fake"] == crossings
        assert state["undo"] == 1
        assert page.change("undo")["crossings"] == before["crossings"]

    def test_all_crossings_of_a_photo_are_labelled_in_one_request(self, page):
        known = [each["id"] for each in page.state()["crossings"]]
        edits = [{"op": "label", "crossing": crossing, "value": "unsure"} for crossing in known]
        assert page.edit(op="many", edits=edits)["labelling"]["done"] == len(known)
        longest = [{"op": "label", "crossing": 2**53 - 1, "value": "unsure"}] * 5000
        assert page.post("edit", base_version=page.version, edit={"op": "many", "edits": longest}).status_code == 422

    def test_a_length_sets_the_scale_without_a_solve_and_undo_takes_it_back(self, page):
        line = next(one for one in page.solve()["lines"] if one["component"] == 0)
        state = page.edit(op="length", line=line["id"], metres=2.5)
        length = np.linalg.norm(np.subtract(*line["ends"]))
        assert state["metres_per_unit"] * length == pytest.approx(2.5)
        assert page.change("undo")["metres_per_unit"] is None

    def test_a_frame_from_drawn_lines_finds_other_lines(self, page, made):
        drawn = [
            {"ends": made.pixels[line].tolist(), "axis": "xyz"[made.axis[line]]}
            for axis in range(3)
            for line in np.flatnonzero(made.axis == axis)[:3]
        ]
        before = page.state()
        state = page.edit(op="frame", lines=drawn)
        assert np.abs(np.array(state["R_cam_from_world"]) - made.frame.rotation).max() < 1e-6
        assert not {line["id"] for line in before["lines"]} & {line["id"] for line in state["lines"]}
        assert page.change("undo")["lines"] == before["lines"]

    @pytest.mark.parametrize(
        ("edit", "message"),
        [
            ({"op": "explode"}, "edit.op is"),
            ({"op": "delete", "line": 10**6}, "no line 1000000 any more"),
            ({"op": "delete", "line": "../../etc/passwd"}, "whole number"),
            ({"op": "delete", "line": True}, "whole number"),
            ({"op": "delete"}, "edit.line is missing"),
            ({"op": "label", "crossing": 1, "value": "real"}, "no crossing 1 any more"),
            ({"op": "label", "crossing": 2**53, "value": "real"}, "whole number"),
            ({"op": "axis", "line": 0, "axis": "w"}, "one of x, y, z"),
            ({"op": "split", "line": 0, "at": [1e308, 0]}, "at most"),
            ({"op": "draw", "ends": [[0, 0], [0, 0]], "axis": None}, "two ends that differ"),
            ({"op": "draw", "ends": [[0, 0], [2, 0]], "axis": "x"}, "too short"),
            ({"op": "ends", "line": 10**6, "end": 0, "at": [5, 5]}, "no line 1000000 any more"),
            ({"op": "ends", "line": 0, "end": 2, "at": [5, 5]}, "whole number from 0 to 1"),
            ({"op": "many", "edits": []}, "list of 1 to"),
            ({"op": "many", "edits": [{"op": "draw"}]}, "one of label, axis, delete"),
            ({"op": "length", "line": 0, "metres": 0}, "length from"),
            ({"op": "join", "lines": [0]}, "list of 2"),
            ({"op": "frame", "lines": []}, "list of 1 to 100"),
            ({"op": "frame", "lines": [{"ends": [[0, 0], [9, 9]], "axis": "x"}]}, "1 lines were drawn"),
            ([], "edit is a list of 0, expected an object"),
        ],
    )
    def test_what_cannot_be_done_is_refused_and_changes_nothing(self, page, edit, message):
        assert message in page.refused(422, "edit", edit=edit)

    @pytest.mark.parametrize("body", [b"", b"{", b"[]", b"\xff", b'{"base_version": NaN}', b"[" * 30_000, b"1" * 9_000])
    @pytest.mark.parametrize("path", ["edit", "undo", "hello", "propose"])
    def test_a_body_that_is_no_request_is_refused(self, page, path, body):
        answer = page.client.post(f"/api/{path}", content=body, headers={"Content-Type": "application/json"})
        assert answer.status_code == 422
        assert len(answer.json()["error"]) < 300

    def test_an_edit_of_an_old_state_is_refused(self, page):
        page.state()
        old = page.version
        page.edit(op="delete", line=0)
        answer = page.post("edit", base_version=old, edit={"op": "delete", "line": 1})
        assert answer.status_code == 409
        assert "try again" in answer.json()["error"]
        assert len(page.state()["lines"]) == len(page.state()["lines"])
        assert page.state()["undo"] == 1


class TestUndo:
    def several(self, page, count):
        """States after each of many edits of all kinds."""
        states = [page.state()]
        drawn = 0
        for number in range(count):
            lines = states[-1]["lines"]
            line = lines[(7 * number) % len(lines)]
            middle = np.mean(line["segment"], axis=0).tolist()
            match number % 7:
                case 0:
                    edit = {"op": "label", "crossing": states[-1]["crossings"][number]["id"], "value": "fake"}
                case 1:
                    edit = {"op": "axis", "line": line["id"], "axis": "xyz"["yzx".index(line["axis"])]}
                case 2:
                    edit = {"op": "split", "line": line["id"], "at": middle}
                case 3:
                    drawn += 1
                    edit = {"op": "draw", "ends": [[100 + 9 * number, 100], [300 + 9 * number, 140]], "axis": "x"}
                case 4:
                    edit = {
                        "op": "ends",
                        "line": line["id"],
                        "end": 0,
                        "at": np.mean([middle, line["segment"][0]], 0).tolist(),
                    }
                case 5:
                    edit = {"op": "many", "edits": [{"op": "delete", "line": each["id"]} for each in lines[3:5]]}
                case _:
                    edit = {"op": "delete", "line": line["id"]}
            states.append(page.edit(**edit))
        return states

    def plain(self, state):
        """What undo must bring back: everything but counters."""
        gone = ("version", "undo", "redo", "saved")
        return {key: value for key, value in state.items() if key not in gone}

    def test_thirty_back_and_thirty_forth_are_exact(self, page):
        states = self.several(page, 30)
        for count, wanted in enumerate(reversed(states[:-1]), start=1):
            back = page.change("undo")
            assert self.plain(back) == self.plain(wanted)
            assert (back["undo"], back["redo"]) == (30 - count, count)
        for wanted in states[1:]:
            assert self.plain(page.change("redo")) == self.plain(wanted)

    def test_a_new_edit_ends_what_could_come_back(self, page):
        self.several(page, 3)
        page.change("undo")
        state = page.edit(op="delete", line=2)
        assert (state["undo"], state["redo"]) == (3, 0)

    def test_there_is_an_end_on_both_sides(self, page):
        assert "nothing to undo" in page.refused(422, "undo")
        assert "nothing to do again" in page.refused(422, "redo")

    def test_across_a_solve_the_model_comes_back_too(self, page):
        first = page.solve()
        page.edit(op="label", crossing=crossings(first, real=True)[0]["id"], value="fake")
        page.solve()
        back = page.change("undo")
        assert crossings(back, real=True) == [{**one, "changed": False} for one in crossings(first, real=True)]
        assert back["planes"] == first["planes"]

    def test_a_reload_brings_everything_back_with_all_steps(self, page, open_page):
        states = self.several(page, 12)
        page.change("undo")
        page.change("undo")
        page.session._on_change.__self__.close()
        text = corrections_to_json(page.saved[-1].corrections)
        again = open_page(corrections_from_json(text))
        assert self.plain(again.state()) == self.plain(states[-3])
        assert (again.state()["undo"], again.state()["redo"]) == (10, 2)
        again.change("redo")
        assert self.plain(again.change("redo")) == self.plain(states[-1])


class TestSolving:
    def test_what_was_called_fake_is_fake_and_marked_as_changed(self, page):
        real = crossings(page.solve(), real=True)[0]["id"]
        page.edit(op="label", crossing=real, value="fake")
        state = page.solve()
        (crossing,) = crossings(state, id=real)
        assert (crossing["real"], crossing["changed"]) == (False, True)
        assert all(
            one["id"] == real or not one["real"] or one["label"] is None for one in crossings(state, changed=True)
        )

    def test_every_crossing_of_the_model_says_why(self, page):
        assert {one["reason"] for one in page.state()["crossings"]} == {None}
        solved = page.solve()
        page.edit(op="label", crossing=crossings(solved, real=True)[0]["id"], value="fake")
        state = page.solve()
        assert {one["reason"] for one in state["crossings"]} <= set(REASONS)
        assert {one["reason"] for one in crossings(state, real=True)} <= {"chosen", "annotated"}
        (named,) = crossings(state, label="fake")
        assert (named["real"], named["reason"]) == (False, "annotated")

    def test_the_second_solve_of_the_same_changes_nothing(self, page):
        page.solve()
        assert crossings(page.solve(), changed=True) == []

    def test_an_answer_to_lines_that_have_changed_is_ignored(self, page):
        first = page.solve()
        page.post("solve", base_version=page.version)
        page.edit(op="delete", line=first["lines"][0]["id"])
        page.solving.answer()
        state = page.state()
        assert state["solve"]["state"] == "idle"
        assert state["solve"]["solved_version"] == first["solve"]["solved_version"]

    def test_an_answer_is_taken_when_the_change_was_undone(self, page):
        page.post("solve", base_version=page.version)
        page.edit(op="delete", line=0)
        page.change("undo")
        page.solving.answer()
        assert page.state()["solve"]["solved_version"] is not None

    def test_only_the_last_solve_asked_for_counts(self, page):
        page.post("solve", base_version=page.version)
        page.edit(op="delete", line=0)
        page.post("solve", base_version=page.version)
        page.solving.answer()
        assert page.get("progress").json()["solve"]["state"] == "running"
        page.solving.answer()
        assert page.get("progress").json()["solve"]["state"] == "idle"
        assert page.state()["solve"]["solved_version"] is not None

    def test_a_contradiction_names_its_lines_and_crossings(self, open_page):
        page = open_page(options=Options(extension=500))  # so far that many crossings are false
        for crossing in page.state()["crossings"]:
            page.edit(op="label", crossing=crossing["id"], value="real")
        state = page.solve()
        told = state["contradiction"]
        pairs = {crossing["id"]: crossing["lines"] for crossing in state["crossings"]}
        assert {line for crossing in told["crossings"] for line in pairs[crossing]} == set(told["lines"])
        assert "cannot all be real" in told["text"]
        assert state["solve"]["error"] == told["text"]
        assert page.edit(op="label", crossing=told["crossings"][0], value=None)["contradiction"] is None

    def test_stop_reaches_the_solver(self, page):
        assert page.post("stop").status_code == 200
        assert page.solving.stopped == 1


class TestLabelling:
    def test_the_next_one_without_a_label_goes_round(self, page):
        ids = page.state()["labelling"]["order"]
        assert page.get("next-unlabelled").json() == {"crossing": ids[0]}
        page.edit(op="label", crossing=ids[1], value="real")
        assert page.get(f"next-unlabelled?after={ids[0]}").json() == {"crossing": ids[2]}
        assert page.get(f"next-unlabelled?after={ids[-1]}").json() == {"crossing": ids[0]}
        for crossing in ids:
            page.edit(op="label", crossing=crossing, value="fake")
        assert page.get("next-unlabelled").json() == {"crossing": None}

    @pytest.mark.parametrize("after", ["x", "-1", "1e3", "9" * 40])
    def test_what_is_no_crossing_is_refused(self, page, after):
        assert page.get(f"next-unlabelled?after={after}").status_code == 422

    def test_the_file_holds_a_persons_labels_alone_and_evaluate_reads_it(self, page, made_photo, tmp_path):
        state = page.solve()
        said = {}
        for number, word in enumerate(["real", "fake", "unsure", "fake"]):
            said[state["crossings"][3 * number]["id"]] = word
            page.edit(op="label", crossing=state["crossings"][3 * number]["id"], value=word)
        (tmp_path / "made.labels.json").write_bytes(page.get("export/labels").content)
        cv2.imwrite(str(tmp_path / "made.jpg"), made_photo.pixels)
        (case,) = find_dataset(tmp_path).cases
        _, reference = open_case(case)
        graph = page.session.lines.graph
        label = reference.label(graph, made_photo.camera, page.session.now().found.frame.rotation)
        words = {1: "real", 0: "fake", -1: None}
        found = {one: words[int(label[page.session.lines.edge[one]])] for one in said}
        assert found == {one: None if word == "unsure" else word for one, word in said.items()}
        assert len(json.loads(page.get("export/labels").text)["crossings"]) == len(said)


class TestExport:
    def test_without_a_model_there_is_nothing_to_export(self, page):
        answer = page.get("export/step")
        assert answer.status_code == 422
        assert "solve first" in answer.json()["error"]

    @pytest.mark.parametrize("name", ["exe", "", "JSON", ".json", "json/step"])
    def test_there_are_no_other_formats(self, page, name):
        assert page.get(f"export/{name}").status_code == 404

    def test_the_bytes_are_those_of_linecad_export(self, page, tmp_path, made_photo):
        page.solve()
        (tmp_path / "made.json").write_bytes(page.get("export/json").content)
        cv2.imwrite(str(tmp_path / "made.png"), made_photo.pixels[..., ::-1])
        photo = ["--photo", str(tmp_path / "made.png")]
        cheap = [suffix for suffix in FORMATS if suffix not in (".png", ".step", ".usdz", ".fspy")]
        outputs = {suffix: tmp_path / suffix[1:] / f"made{suffix}" for suffix in cheap}
        for path in outputs.values():
            path.parent.mkdir()
        named = [argument for path in outputs.values() for argument in ("-o", str(path))]
        assert main(["export", str(tmp_path / "made.json"), *photo, *named, "--quiet"]) == 0
        with_more = set()
        for suffix, path in outputs.items():
            answer = page.get(f"export/{suffix[1:]}")
            written = {each.relative_to(path.parent).as_posix(): each for each in path.parent.rglob("*.*")}
            files = {name: each.read_bytes() for name, each in written.items() if each.is_file()}
            ending = suffix + (".zip" if len(files) > 1 else "")
            assert answer.headers["content-disposition"] == f'attachment; filename="made{ending}"'
            if len(files) == 1:
                assert answer.content == files[f"made{suffix}"], suffix
                continue
            with_more.add(suffix)
            with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
                assert {name: archive.read(name) for name in archive.namelist()} == files, suffix
            assert page.get(f"export/{suffix[1:]}").content == answer.content
        assert {".obj", ".usda", ".elevation.dxf"} <= with_more

    @pytest.mark.thorough
    def test_convert_with_the_corrections_file_makes_the_same_scene(self, page, tmp_path, made_photo):
        first = page.solve()
        page.edit(op="label", crossing=crossings(first, real=True)[2]["id"], value="fake")
        page.edit(op="delete", line=first["lines"][7]["id"])
        page.edit(op="draw", ends=[[300, 300], [305, 520]], axis="z")
        line = next(one for one in page.solve()["lines"] if one["component"] == 0)
        page.edit(op="length", line=line["id"], metres=2.0)
        points = [{"pixel": end, "line": line["id"]} for end in line["segment"]]
        page.edit(op="distance", points=points, metres=4.0)
        photo, camera, said, scene = (
            tmp_path / name for name in ("made.png", "camera.json", "said.json", "scene.json")
        )
        cv2.imwrite(str(photo), made_photo.pixels[..., ::-1])
        matrix = made_photo.camera.matrix.tolist()
        camera.write_text(json.dumps({"width": 1600, "height": 1200, "K": matrix, "distortion": []}))
        said.write_text(corrections_to_json(page.session.now().corrections))
        options = ["--camera", str(camera), "--corrections", str(said), "-o", str(scene), "--quiet"]
        assert main(["convert", str(photo), *options]) == 0
        converted, exported = json.loads(scene.read_text()), page.get("export/json").json()
        for one in (converted, exported):
            del one["photo"]
        assert converted == exported
        assert converted["metres_per_unit"] is not None

    def test_a_picture_shows_the_photo(self, page):
        page.solve()
        data = np.frombuffer(page.get("export/png").content, np.uint8)
        assert cv2.imdecode(data, cv2.IMREAD_COLOR).shape[1] >= 1600

    def test_every_format_is_named_in_the_state(self, page):
        assert [one["name"] for one in page.state()["formats"]] == ["json", *(suffix[1:] for suffix in FORMATS)]


class TestTabs:
    def test_the_second_tab_is_told_so_and_may_take_over(self, page):
        def owns(tab, **more):
            return page.post("hello", tab=tab, **more).json()["owner"]

        assert (owns("a"), owns("b")) == (True, False)
        assert (owns("b", take_over=True), owns("a")) == (True, False)

    def test_the_tab_that_looks_is_told_when_the_state_is_another(self, page):
        page.post("hello", tab="a")
        before = page.post("hello", tab="b").json()["version"]
        page.edit(op="label", crossing=page.state()["crossings"][0]["id"], value="real")
        assert page.post("hello", tab="b").json()["version"] == page.version > before

    @pytest.mark.parametrize("tab", ["", "x" * 101, 7, None])
    def test_a_tab_has_a_short_name(self, page, tab):
        assert page.post("hello", tab=tab).status_code == 422


def test_a_solve_tells_what_changed_far_from_the_edits(page):
    """A deleted line takes its crossings along; whatever else changes is told as near it or far from it."""
    state = page.solve()
    line = max(state["lines"], key=lambda one: sum(one["id"] in each["lines"] for each in state["crossings"]))
    page.edit(op="delete", line=line["id"])
    solved = page.solve()
    ends = np.array(line["segment"])
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    for crossing in solved["crossings"]:
        assert not crossing["far"] or crossing["changed"]
        apart = np.array(crossing["pixel"]) - ends[0]
        place = ends[0] + along * np.clip(apart @ along, 0, np.linalg.norm(ends[1] - ends[0]))
        is_far = np.linalg.norm(np.array(crossing["pixel"]) - place) > 200 * state["photo"]["width"] / 3840
        assert crossing["far"] == (crossing["changed"] and is_far)
