"""Bodies as the page is told of them: facts move them at once, and the scene that is built behind agrees."""

from dataclasses import replace

import numpy as np
import pytest

import linecad.editing.bodies
from linecad.corrections.file import corrections_from_json, corrections_to_json
from linecad.editing.bodies import NODES, at_once
from linecad.options import Options
from linecad.ties.depth_ties import MapPlaces
from linecad.ties.placing import place_bodies
from linecad.ties.sides import Part
from solver.options import SolveOptions


@pytest.fixture
def solved(page):
    page.solve()
    return page


def lines_of(state, body):
    return [line for line in state["lines"] if line["body"] == body]


def depths(state, body):
    """How far the ends of a body's lines are, by line."""
    return {line["id"]: np.array(line["ends"]) for line in lines_of(state, body) if line["ends"] is not None}


def in_photo(state, points):
    seen = points @ np.array(state["R_cam_from_world"]).T @ np.array(state["K"]).T
    return seen[..., :2] / seen[..., 2:]


def place(state, log_ratio):
    """The word that the second body stands so far from the first."""
    first, second = (lines_of(state, body)[0]["id"] for body in (0, 1))
    return {"op": "place", "line": second, "to": first, "log_ratio": log_ratio}


def camera_depth(state, line):
    ends = np.array(next(each["ends"] for each in state["lines"] if each["id"] == line))
    return (ends @ np.array(state["R_cam_from_world"]).T)[:, 2].mean()


class TestDocument:
    def test_every_line_and_face_has_its_body(self, solved):
        state = solved.state()
        bodies = {body["id"]: body for body in state["bodies"]}
        assert sorted(bodies) == [0, 1]
        for number, body in bodies.items():
            assert body["lines"] == [line["id"] for line in lines_of(state, number)]
        assert sum(body["share"] for body in bodies.values()) == pytest.approx(1.0)
        assert [body["reference"] for body in state["bodies"]] == [True, False]
        assert [body["id"] for body in state["bodies"]] == [0, 1], "the largest share comes first"
        assert {plane["body"] for plane in state["planes"]} == {0, 1, 2}, "the ground is one more"
        for plane in state["planes"]:
            assert {face["body"] for face in plane["faces"]} <= {plane["body"]}

    def test_what_ties_a_body_is_told_in_words(self, solved):
        body = solved.state()["bodies"][1]
        assert body["guess"] == (body["probability"] < 0.5)
        assert [tie["words"] for tie in body["ties"] if tie["counted"]] == ["a foot on the ground"]
        assert [tie["other"] for tie in body["ties"]] == [None]

    def test_where_a_map_moved_the_ground_it_moves_with_its_bodies(self, solved):
        bodies = solved.session.now().model.bodies
        now, count = bodies.now, bodies.count
        assert now.mapped is None
        silent = np.full(count, np.nan)
        mapped = MapPlaces(
            now.log_scale[:count] + 0.2, now.placement.log_scale[count] + 0.2, 0.0, silent > 0, silent, 0.02, 3.0
        )
        moved = replace(bodies, now=replace(now, mapped=mapped)).moved_from(bodies.solved)
        assert moved == pytest.approx(np.full(count + 1, 0.2))

    def test_before_the_first_solve_there_are_none(self, page):
        state = page.state()
        assert (state["bodies"], state["facts"], state["moved"]) == ([], [], [])
        assert "wait until the model" in page.refused(422, "edit", edit={"op": "cut", "lines": [0, 1]})

    def test_programs_over_crossings_have_none(self, open_page):
        page = open_page(options=Options(over_bodies=False))
        assert page.solve()["bodies"] == []
        assert "places no bodies" in page.refused(422, "edit", edit={"op": "cut", "lines": [0, 1]})


class TestFacts:
    def test_a_body_moves_at_once_along_its_rays(self, solved):
        before = solved.state()
        there = solved.edit(**place(before, 0.5))
        fact = there["facts"][0]
        first, second = fact["lines"][1], fact["lines"][0]
        assert np.log(camera_depth(there, second) / camera_depth(there, first)) == pytest.approx(0.5, abs=0.05)
        was, now = depths(before, 1), depths(there, 1)
        factors = {round(float(np.median(now[line] / was[line])), 6) for line in was}
        assert len(factors) == 1, "all of it by one factor"
        assert factors != {1.0}
        for line in was:
            assert in_photo(there, now[line]) == pytest.approx(in_photo(before, was[line]), abs=1e-6)
        assert depths(there, 0).keys() == depths(before, 0).keys()
        for line, ends in depths(before, 0).items():
            assert depths(there, 0)[line] == pytest.approx(ends)
        assert (fact["words"], fact["holds"], fact["bodies"]) == ("stands here", True, [1, 0])

    def test_its_faces_move_along(self, solved):
        before = solved.state()
        there = solved.edit(**place(before, 0.5))
        [factor] = {round(float(np.median(now / depths(before, 1)[line])), 6) for line, now in depths(there, 1).items()}
        for was, now in zip(before["planes"], there["planes"], strict=True):
            expected = factor if was["body"] == 1 else 1.0
            if was["body"] < 2:
                assert now["offset"] == pytest.approx(expected * was["offset"], rel=1e-5)
                for one, other in zip(was["faces"], now["faces"], strict=True):
                    assert np.array(other["outline"]) == pytest.approx(expected * np.array(one["outline"]), rel=1e-5)

    def test_the_scene_is_built_anew_behind_it_and_agrees(self, solved):
        there = solved.edit(**place(solved.state(), 0.5))
        assert there["solve"]["state"] == "running"
        assert not there["solve"]["fresh"]
        solved.solving.answer()
        built = solved.state()
        assert built["solve"]["fresh"]
        assert [fact["holds"] for fact in built["facts"]] == [True]
        scale = np.median([
            np.linalg.norm(ends[1] - ends[0]) / np.linalg.norm(np.subtract(*depths(there, 0)[line]))
            for line, ends in depths(built, 0).items() if line in depths(there, 0)
        ])  # fmt: skip
        fact = there["facts"][0]
        for line in fact["lines"]:
            assert camera_depth(built, line) == pytest.approx(scale * camera_depth(there, line), rel=0.02)

    def test_undo_and_redo_move_it_too(self, solved):
        before = solved.state()
        there = solved.edit(**place(before, 0.5))
        back = solved.change("undo")
        assert back["solve"]["fresh"], "that model is known"
        assert back["lines"] == before["lines"]
        again = solved.change("redo")
        assert again["lines"] == there["lines"]
        assert again["facts"] == there["facts"]

    def test_what_was_said_can_be_taken_back_later(self, solved):
        before = solved.state()
        said = solved.edit(**place(before, 0.5))
        solved.edit(op="delete", line=lines_of(before, 0)[-1]["id"])
        state = solved.edit(op="withdraw", edit=said["facts"][0]["edit"])
        assert state["facts"] == []
        assert "something of bodies" in solved.refused(422, "edit", edit={"op": "withdraw", "edit": 1})
        assert "something of bodies" in solved.refused(422, "edit", edit={"op": "withdraw", "edit": 99})

    def test_it_is_kept_in_the_corrections(self, solved):
        solved.edit(**place(solved.state(), 0.5))
        corrections = solved.session.now().corrections
        assert corrections_from_json(corrections_to_json(corrections)) == corrections
        assert corrections.edits[0].log_ratio == 0.5

    def test_the_last_fact_tells_what_it_moved(self, solved):
        state = solved.edit(**place(solved.state(), 0.5))
        assert [moved["body"] for moved in state["moved"]] == [1]
        assert state["moved"][0]["asked"]
        assert abs(state["moved"][0]["log_factor"]) > 0.01

    def test_a_cut_within_a_body_waits_for_the_solve(self, solved):
        before = solved.state()
        first, second = (lines_of(before, 0)[number]["id"] for number in (0, -1))
        there = solved.edit(op="cut", lines=[first, second])
        assert there["lines"] == before["lines"]
        assert there["solve"]["state"] == "running"
        solved.solving.answer()
        built = {line["id"]: line["body"] for line in solved.state()["lines"]}
        assert built[first] != built[second]

    def test_other_edits_wait_to_be_solved(self, solved):
        there = solved.edit(op="delete", line=lines_of(solved.state(), 0)[0]["id"])
        assert there["solve"]["state"] == "idle"

    def test_what_says_nothing_is_refused(self, solved):
        first, second = (lines_of(solved.state(), 0)[number]["id"] for number in (0, 1))
        edit = {"op": "place", "line": first, "to": second, "log_ratio": 1.0}
        assert "of one body" in solved.refused(422, "edit", edit=edit)

    def test_a_contradiction_names_facts_and_leaves_the_model(self, solved):
        before = solved.state()
        first, second = lines_of(before, 0), lines_of(before, 1)
        there = solved.edit(**place(before, 0.5))
        against = {"op": "place", "line": second[1]["id"], "to": first[1]["id"], "log_ratio": 2.0}
        state = solved.edit(**against)
        assert state["contradiction"]["facts"] == [0, 1]
        assert '"stands here at (' in state["contradiction"]["text"]
        assert [fact["contradicted"] for fact in state["facts"]] == [True, True]
        assert len(solved.solving.waiting) == 1, "what cannot hold is not solved for"
        freed = solved.edit(op="withdraw", edit=1)
        assert freed["contradiction"] is None
        assert freed["lines"] == there["lines"]


def depth_at_middle(state, number):
    """The camera depth at which a line passes nearest to the ray of the middle of its segment."""
    line = next(each for each in state["lines"] if each["id"] == number)
    middle = np.mean(line["segment"], axis=0)
    ray = np.linalg.inv(np.array(state["K"])) @ [*middle, 1.0] @ np.array(state["R_cam_from_world"])
    start, end = np.array(line["ends"])
    along = (end - start) / np.linalg.norm(end - start)
    across = ray - (ray @ along) * along
    return across @ (start - (start @ along) * along) / (across @ across)


def by_body(state):
    """The ids of the lines of each body."""
    return {body["id"]: {line["id"] for line in lines_of(state, body["id"])} for body in state["bodies"]}


def half_of(state, body):
    """The ids of the lines of a body in the model that are in the lower half of it, and those of the others."""
    own = [line for line in lines_of(state, body) if line["ends"] is not None]
    height = {line["id"]: -np.mean(line["ends"], axis=0)[2] for line in own}
    ordered = sorted(height, key=lambda number: height[number])
    return ordered[: len(own) // 2], ordered[len(own) // 2 :]


def place_part(state, factor=1.0):
    """The word that half of the largest body stands so many times as far as it does."""
    half, rest = half_of(state, 0)
    now = np.log(depth_at_middle(state, half[0]) / depth_at_middle(state, rest[0]))
    return {"op": "place", "line": half[0], "to": rest[0], "part": half, "log_ratio": float(now + np.log(factor))}


class TestPartsOfAMap:
    """A depth map has the right half of the second body farther, and is believed."""

    @pytest.fixture
    def parted(self, open_page, map_with_a_part):
        page = open_page(depth=map_with_a_part)
        page.solve()
        return page

    def test_each_is_a_body_of_the_list_that_the_map_places(self, parted, open_page):
        page = open_page()
        page.solve()
        plain, state = page.state(), parted.state()
        assert {body["id"]: body["by_depth_map"] for body in state["bodies"]} == {0: False, 1: False, 2: True}
        for body in (1, 2):
            shown = [line for line in lines_of(state, body) if line["ends"] is not None]
            assert shown
            assert {line["by_depth_map"] for line in shown} == {body == 2}
        half, rest = (next(iter(depths(state, body))) for body in (2, 1))
        as_one, as_two = (depth_at_middle(each, half) / depth_at_middle(each, rest) for each in (plain, state))
        assert abs(np.log(as_two / as_one)) == pytest.approx(np.log(1.3), abs=0.02)

    def test_a_word_moves_it_at_once_and_the_scene_behind_agrees(self, parted):
        before = parted.state()
        own, other = (next(iter(depths(before, body))) for body in (2, 0))
        ratio = float(np.log(depth_at_middle(before, own) / depth_at_middle(before, other)) + 0.5)
        there = parted.edit(op="place", line=own, to=other, log_ratio=ratio)
        parted.solving.answer()
        built = parted.state()
        assert built["solve"]["fresh"]
        for state in (there, built):
            assert [fact["holds"] for fact in state["facts"]] == [True]
            assert {line["id"] for line in lines_of(state, 2)} == {line["id"] for line in lines_of(before, 2)}
            now = np.log(depth_at_middle(state, own) / depth_at_middle(state, other))
            assert now == pytest.approx(ratio, abs=0.05)
        assert not any(line["by_depth_map"] for line in lines_of(built, 2))

    def test_a_crossing_called_real_makes_it_stand_with_its_body_again(self, parted):
        before = parted.state()
        body = {line["id"]: line["body"] for line in before["lines"]}
        crossing = next(each for each in before["crossings"] if {body[line] for line in each["lines"]} == {1, 2})
        first, second = crossing["lines"]
        was = depth_at_middle(before, first) / depth_at_middle(before, second)
        parted.edit(op="label", crossing=crossing["id"], value="real")
        parted.solve()
        state = parted.state()
        now = depth_at_middle(state, first) / depth_at_middle(state, second)
        assert abs(np.log(now / was)) == pytest.approx(np.log(1.3), abs=0.05)

    def test_not_connected_to_its_former_body_parts_the_two_as_they_are(self, parted):
        """The cut once went through the body that the two are without the map, and took one line from it."""
        before = parted.state()
        own, other = (lines_of(before, body)[0]["id"] for body in (2, 1))
        parted.edit(op="cut", lines=[other, own])
        parted.solve()
        assert by_body(parted.state()) == by_body(before)

    def test_a_crossing_called_fake_between_the_two_leaves_both_where_they_are(self, parted):
        before = parted.state()
        body = {line["id"]: line["body"] for line in before["lines"]}
        crossing = next(each for each in before["crossings"] if {body[line] for line in each["lines"]} == {1, 2})
        parted.edit(op="label", crossing=crossing["id"], value="fake")
        parted.solve()
        state = parted.state()
        assert by_body(state) == by_body(before)
        for number in range(3):
            for line, ends in depths(state, number).items():
                assert ends == pytest.approx(depths(before, number)[line])

    def test_not_connected_inside_a_part_leaves_both_sides_where_the_map_has_them(self, parted):
        before = parted.state()
        lines = lines_of(before, 2)
        parted.edit(op="cut", lines=[lines[0]["id"], lines[-1]["id"]])
        parted.solve()
        state = parted.state()
        one, other = (next(line for line in state["lines"] if line["id"] == lines[at]["id"]) for at in (0, -1))
        assert one["body"] != other["body"]
        assert by_body(state)[one["body"]] | by_body(state)[other["body"]] == by_body(before)[2]
        assert {number: by_body(state)[number] for number in (0, 1)} == {k: by_body(before)[k] for k in (0, 1)}
        for number in {one["body"], other["body"]}:
            for line, ends in depths(state, number).items():
                there = depths(before, 2)[line]
                assert ends[:, :2] == pytest.approx(there[:, :2], rel=0.001)
                # Uprights end at a level that fewer lines of one body share.
                assert ends[:, 2] == pytest.approx(there[:, 2], rel=0.015)

    def test_a_line_that_is_drawn_on_a_part_is_of_it(self, parted):
        before = parted.state()
        beside = [line for line in lines_of(before, 2) if line["axis"] == "z"][-1]
        parted.edit(op="draw", ends=[[x + 40, y] for x, y in beside["segment"]], axis="z")
        parted.solve()
        known = {line["id"] for line in before["lines"]}
        [drawn] = [line for line in parted.state()["lines"] if line["id"] not in known]
        assert drawn["body"] == 2
        assert by_body(parted.state())[2] - {drawn["id"]} == by_body(before)[2]

    def test_a_line_taken_away_leaves_the_parts_of_others(self, parted):
        before = parted.state()
        gone = lines_of(before, 2)[0]["id"]
        parted.edit(op="delete", line=gone)
        parted.solve()
        assert by_body(parted.state()) == {number: lines - {gone} for number, lines in by_body(before).items()}


class TestParts:
    def test_a_part_moves_at_once_and_the_rest_of_its_body_stays(self, solved):
        before = solved.state()
        half, rest = half_of(before, 0)
        there = solved.edit(**place_part(before, 1.5))
        body = {line["id"]: line["body"] for line in there["lines"]}
        assert {body[line] for line in half} == {2}
        assert {body[line] for line in rest} == {0}
        for line in half:
            assert depths(there, 2)[line] == pytest.approx(1.5 * depths(before, 0)[line], rel=0.02)
        for line in rest:
            assert depths(there, 0)[line] == pytest.approx(depths(before, 0)[line])
        assert [each["id"] for each in there["bodies"] if each["reference"]] == [0]
        assert {plane["body"] for plane in there["planes"]} <= {0, 1, 2, 3}, "the ground comes last"
        fact = there["facts"][0]
        assert (fact["words"], fact["holds"], fact["bodies"]) == ("a part of it stands here", True, [2, 0])
        assert "part" not in fact
        assert [each["body"] for each in there["moved"] if each["asked"]] == [2]

    def test_the_scene_behind_it_parts_the_same_lines(self, solved):
        before = solved.state()
        half, rest = half_of(before, 0)
        there = solved.edit(**place_part(before, 1.5))
        solved.solving.answer()
        built = solved.state()
        assert built["solve"]["fresh"]
        body = {line["id"]: line["body"] for line in built["lines"]}
        assert {body[line] for line in half} == {2}
        assert {body[line] for line in rest} == {0}
        assert [fact["holds"] for fact in built["facts"]] == [True]
        ratios = []
        for lines, number in ((half, 2), (rest, 0)):
            was, now = depths(there, number), depths(built, number)
            common = [line for line in lines if line in was and line in now]
            ratios.append(np.median([np.linalg.norm(now[line][0]) / np.linalg.norm(was[line][0]) for line in common]))
        assert ratios[0] == pytest.approx(ratios[1], rel=0.02), "both by the scale of the model, if that changed"

    def test_undo_makes_one_body_of_it_again(self, solved):
        before = solved.state()
        there = solved.edit(**place_part(before, 1.5))
        solved.edit(**place(there, 0.5))  # there is a later word
        solved.change("undo")
        back = solved.change("undo")
        assert back["lines"] == before["lines"]

    def test_what_would_move_has_the_number_behind_the_ground(self, solved):
        state = solved.state()
        told = solved.post("preview", base_version=solved.version, edit=place_part(state, 1.5)).json()
        assert list(told["moves"]) == ["3"]
        assert told["moves"]["3"] == pytest.approx(np.log(1.5), abs=0.02)

    def test_a_part_that_is_all_of_its_body_is_the_body(self, solved):
        state = solved.state()
        edit = {**place(state, 0.5), "part": [line["id"] for line in lines_of(state, 1)]}
        there = solved.edit(**edit)
        assert len(there["bodies"]) == 2
        assert [moved["body"] for moved in there["moved"]] == [1]

    def test_what_the_part_is_placed_against_is_none_of_it(self, solved):
        edit = place_part(solved.state())
        text = solved.refused(422, "edit", edit={**edit, "to": edit["part"][1], "log_ratio": 1.0})
        assert "of one body" in text
        assert "expected a list of 1" in solved.refused(422, "edit", edit={**edit, "part": []})

    def test_parts_are_told_by_lines_the_most_doubtful_first(self, solved, monkeypatch):
        assert solved.get("parts/0").json() == [], "nothing is weak here"
        assert solved.get("parts/77").json() == []
        sides = [Part(np.array([0, 1]), 0.2), Part(np.array([2]), 0.7)]
        monkeypatch.setattr("linecad.editing.body_document.parts_of", lambda *_: sides)
        ids = solved.session.now().model.bodies.ids
        expected = [{"lines": list(ids[:2]), "probability": 0.2}, {"lines": [ids[2]], "probability": 0.7}]
        assert solved.get("parts/0").json() == expected

    def test_places_of_a_part_are_asked_for_by_its_lines(self, solved):
        state = solved.state()
        half, _ = half_of(state, 1)
        places = solved.post("part", lines=half).json()
        for place in places:
            assert 3 in place["bodies"], "the number behind the ground"
            assert 1 not in place["bodies"] or len(place["bodies"]) > 1
        assert solved.post("part", lines=[]).json() == []
        assert solved.post("part", lines=[9999]).json() == []
        assert solved.post("part", lines=[line["id"] for line in lines_of(state, 1)]).json() == [], "that is the body"


class TestPreview:
    def test_it_moves_nothing_and_tells_what_would_move(self, solved):
        state = solved.state()
        edit = place(state, 0.5)
        told = solved.post("preview", base_version=solved.version, edit=edit).json()
        assert list(told["moves"]) == ["1"]
        assert told["conflict"] is None
        assert solved.state() == state
        there = solved.edit(**edit)
        assert told["moves"]["1"] == pytest.approx(there["moved"][0]["log_factor"])

    def test_what_was_tried_out_is_taken_without_a_second_search(self, solved, monkeypatch):
        searches = []

        def counted(*given, **more):
            searches.append(given)
            return place_bodies(*given, **more)

        monkeypatch.setattr(linecad.editing.bodies, "place_bodies", counted)
        edit = place(solved.state(), 0.5)
        solved.post("preview", base_version=solved.version, edit=edit)
        there = solved.edit(**edit)
        assert len(searches) == 1
        solved.change("undo")
        solved.post("preview", base_version=solved.version, edit=place(solved.state(), 0.3))
        assert solved.edit(**edit)["bodies"] == there["bodies"]  # after something else it is searched for again
        assert len(searches) == 3

    def test_it_tells_what_would_be_contradicted(self, solved):
        state = solved.edit(**place(solved.state(), 0.5))
        first, second = lines_of(state, 0), lines_of(state, 1)
        against = {"op": "place", "line": second[1]["id"], "to": first[1]["id"], "log_ratio": 2.0}
        told = solved.post("preview", base_version=solved.version, edit=against).json()
        assert told["moves"] == {}
        assert "cannot all hold" in told["conflict"]["text"]
        assert solved.state()["contradiction"] is None

    def test_it_tells_why_a_fact_would_say_nothing(self, solved):
        first, second = (line["id"] for line in lines_of(solved.state(), 0)[:2])
        edit = {"op": "place", "line": first, "to": second, "log_ratio": 2.0}
        told = solved.post("preview", base_version=solved.version, edit=edit).json()
        assert (told["moves"], told["conflict"]) == ({}, None)
        assert "cut it between them first" in told["refused"]

    def test_a_page_that_has_not_heard_of_a_model_speaks_of_the_same_lines(self, solved):
        state = solved.edit(**place(solved.state(), 0.5))
        solved.solving.answer()
        edit = {"op": "withdraw", "edit": state["facts"][0]["edit"]}
        answer = solved.post("edit", base_version=state["version"], edit=edit)
        assert answer.status_code == 200
        assert answer.json()["facts"] == []
        assert solved.post("edit", base_version=state["version"], edit=edit).status_code == 409

    def test_only_facts_are_tried_out(self, solved):
        text = solved.refused(422, "preview", edit={"op": "delete", "line": 0})
        assert "only what is said of bodies" in text


class TestPlaces:
    def test_other_places_come_best_first(self, solved):
        found = solved.get("places/1").json()
        assert found
        assert [each["worth"] for each in found] == sorted((each["worth"] for each in found), reverse=True)
        for each in found:
            assert abs(each["move"]) > 0.005
            assert 1 in each["bodies"]
            assert 0 not in each["bodies"]
            assert each["words"]

    def test_a_proposed_place_can_be_taken(self, solved):
        state = solved.state()
        best = solved.get("places/1").json()[0]
        second, first = lines_of(state, 1)[0]["id"], lines_of(state, 0)[0]["id"]
        now = np.log(camera_depth(state, second) / camera_depth(state, first))
        there = solved.edit(op="place", line=second, to=first, log_ratio=now + best["move"])
        moved = np.log(camera_depth(there, second) / camera_depth(state, second))
        assert moved == pytest.approx(best["move"], abs=0.05)

    def test_the_reference_and_what_is_no_body_have_none(self, solved):
        assert solved.get("places/0").json() == []
        assert solved.get("places/77").json() == []


def test_the_answer_at_once_ends_soon_whatever_the_limit():
    assert at_once(SolveOptions()).node_limit == NODES
    assert at_once(SolveOptions(node_limit=5)).node_limit == 5
    assert at_once(SolveOptions(node_limit=10 * NODES)).node_limit == NODES
