"""The process that solves for the page, by itself."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest

import linecad.pipeline
from linecad.corrections.edits import Corrections, Cut, Delete, PlaceAt
from linecad.depth.depth_map import DepthMap
from linecad.editing.document import solve_of
from linecad.editing.run import EditOptions, edit
from linecad.editing.session import Session
from linecad.editing.solving import SolvingProcess, Step, TaskSolver
from linecad.errors import DepthMapError, ReconstructionError
from linecad.lines.segments import find_segments
from linecad.options import Options
from linecad.pipeline import reconstruct
from linecad.ties.evidence import find_evidence
from linecad.ties.parting import decide_parts
from solver.options import Progress


def test_the_pipe_is_closed_by_the_thread_that_listens_to_it(made_photo):
    """Closed by another one, it once broke in the middle of a read: TypeError in place of an end."""
    solver = SolvingProcess(made_photo, Options(), lambda _: None, lambda _: None)
    pipe, closing = solver._pipe, solver._pipe.close
    closed_by = []

    def close():
        closed_by.append(threading.current_thread().name)
        closing()

    pipe.close = close
    solver.close()
    end = time.monotonic() + 60
    while not pipe.closed:
        assert time.monotonic() < end, "nobody closes the pipe"
        time.sleep(0.01)
    assert closed_by == ["answers of the solver"]


def test_a_task_that_comes_late_is_over(made_photo, task):
    """Each is started behind the answer to its edit, and the next edit's may have been faster."""
    heard = []
    solver = SolvingProcess(made_photo, Options(), lambda _: None, heard.append)
    solver.start(replace(task, number=8))
    solver.start(replace(task, number=7))
    end = time.monotonic() + 60
    while not heard:
        assert time.monotonic() < end, "no answer"
        time.sleep(0.01)
    solver.close()
    assert [answer.number for answer in heard] == [8]


@pytest.fixture
def task(made_photo):
    corrections = Corrections(made_photo.name, made_photo.width, made_photo.height)
    session = Session(made_photo, find_segments(made_photo.grey), Options(), corrections, lambda _: None)
    return session.task(session.now().version)


def test_a_solve_looks_at_the_depth_map(made_photo, task, monkeypatch):
    def look(_graph, sight, *_):
        raise ReconstructionError(f"seen {sight.depth.name}")

    monkeypatch.setattr(linecad.pipeline, "find_evidence", look)
    ones = np.ones((made_photo.height, made_photo.width))
    depth = DepthMap("map.npz", ones, ones > 0, "z")
    assert TaskSolver(made_photo, Options(), depth).answer(task, lambda _: None).error == "seen map.npz"


def test_the_page_reads_the_map_and_hands_it_to_the_process_that_solves(made_photo, tmp_path, monkeypatch):
    def begin(_photo, _options, _hear, _take, depth):
        raise ReconstructionError(f"{depth.kind} of {depth.width} x {depth.height} px")

    monkeypatch.setattr("linecad.editing.run.SolvingProcess", begin)
    np.savez(tmp_path / "map.npz", depth=np.ones((60, 80)))
    options = EditOptions(tmp_path / "said.json", reconstruct=Options(depth_kind="z"), depth=tmp_path / "map.npz")
    with pytest.raises(ReconstructionError, match="z of 1600 x 1200 px"):
        edit(made_photo, options, lambda _: None, lambda _: None)
    (tmp_path / "map.npz").write_bytes(b"")
    with pytest.raises(DepthMapError, match="is empty"):
        edit(made_photo, options, lambda _: None, lambda _: None)
    assert not (tmp_path / "said.json").exists()


def test_a_solve_tells_its_stages_to_the_end(made_photo, task):
    """The gap was closed after a tenth of a second, and the page waited for the faces without a word."""
    stages = []
    answer = TaskSolver(made_photo, Options()).answer(task, lambda _: None, stages.append)
    assert answer.made is not None
    assert any(stage.startswith("placing") for stage in stages)
    assert stages[-1] == "building planes and faces"
    assert answer.seconds > answer.made.solution.seconds


def test_what_is_said_of_bodies_needs_no_second_look_at_lines(made_photo, monkeypatch):
    """A part that is placed by itself parts bodies anew, on the line graph that is known."""
    corrections = Corrections(made_photo.name, made_photo.width, made_photo.height)
    session = Session(made_photo, find_segments(made_photo.grey), Options(), corrections, lambda _: None)
    solver = TaskSolver(made_photo, Options())
    session.take(solver.answer(session.task(session.now().version), lambda _: None))
    bodies = session.now().model.bodies
    own = [bodies.ids[line] for line in np.flatnonzero(bodies.body == 0)]
    part = tuple(session.editing.anchor(line) for line in own[:6])
    fact = PlaceAt(part[0], session.editing.anchor(own[-1]), 0.4, part)
    session.edit(session.now().version, lambda _: fact)
    monkeypatch.setattr("linecad.editing.solving.prepare", None)
    session.take(solver.answer(session.task(session.now().version), lambda _: None))
    assert not session.now().error
    there = session.now().model.bodies
    assert len({there.body_of(line) for line in own[:6]}) == 1
    assert there.body_of(own[0]) != there.body_of(own[-1])
    anew = TaskSolver(made_photo, Options())
    monkeypatch.undo()
    answer = anew.answer(session.task(session.now().version), lambda _: None)
    assert answer.made.scene.lines.ends.tolist() == session.now().model.scene.lines.ends.tolist()


def test_parts_of_a_map_are_decided_once_and_the_command_decides_the_same(
    made_photo, raw, map_with_a_part, monkeypatch
):
    decided = []

    def decide(*given):
        decided.append(decide_parts(*given))
        return decided[-1]

    monkeypatch.setattr(linecad.pipeline, "decide_parts", decide)
    session = Session(made_photo, raw, Options(), Corrections("made.jpg", 1600, 1200), lambda _: None)
    solver = TaskSolver(made_photo, Options(), map_with_a_part)

    def solve(*words):
        for word in words:
            session.edit(session.now().version, lambda _, word=word: word)
        session.take(solver.answer(session.task(session.now().version), lambda _: None))
        assert not session.now().error
        return session.now().model.bodies

    bodies = solve()
    alone = session.now().model.scene.lines.ends.tolist()
    part = {line for line in bodies.ids if bodies.body_of(line) == 2}
    assert part
    first, second, third = ([line for line in bodies.ids if bodies.body_of(line) == body] for body in range(3))
    look = session.editing.anchor
    solve(Cut((look(second[0]), look(third[0]))), Cut((look(first[0]), look(first[-1]))))
    bodies = solve(Delete(look(second[-1])), Delete(look(first[1])))
    assert len(decided) == 1
    assert {line for line in bodies.ids if bodies.body[bodies.node[line]] == bodies.body_of(third[0])} == part
    by_command = reconstruct(made_photo, Options(), corrections=session.now().corrections, depth=map_with_a_part)
    assert len(decided) == 2
    assert by_command.lines.ends.tolist() == session.now().model.scene.lines.ends.tolist()
    assert by_command.lines.by_depth_map.tolist() == session.now().model.scene.lines.by_depth_map.tolist()
    while session.now().corrections.edits:
        session.undo(session.now().version)
    known = solver.answer(replace(session.task(session.now().version), number=99), lambda _: None)
    assert known.made.scene.lines.ends.tolist() == alone
    assert len(decided) == 2


def test_a_map_that_needs_corrections_to_be_read_has_no_parts(made_photo, raw, map_with_a_part, monkeypatch):
    looked = []

    def look(*given):
        looked.append(given)
        if len(looked) == 1:
            raise DepthMapError("of the photo by itself")
        return find_evidence(*given)

    monkeypatch.setattr(linecad.pipeline, "find_evidence", look)
    session = Session(made_photo, raw, Options(), Corrections("made.jpg", 1600, 1200), lambda _: None)
    session.edit(session.now().version, lambda _: Delete(session.editing.anchor(0)))
    answer = TaskSolver(made_photo, Options(), map_with_a_part).answer(
        session.task(session.now().version), lambda _: None
    )
    assert not answer.error
    assert len(looked) == 2
    assert not answer.made.places.evidence.heard.parts


def test_a_stage_is_told_until_the_search_begins(made_photo):
    corrections = Corrections(made_photo.name, made_photo.width, made_photo.height)
    session = Session(made_photo, find_segments(made_photo.grey), Options(), corrections, lambda _: None)
    number = session.task(session.now().version).number
    session.hear(Step(number, stage="finding what ties 3 bodies"))
    assert solve_of(session.now())["stage"] == "finding what ties 3 bodies"
    session.hear(Step(number, Progress(0.1, 5.0, 6.0, 0.2, 1)))
    assert (solve_of(session.now())["stage"], solve_of(session.now())["bound"]) == ("", 6.0)
    session.hear(Step(number, stage="building planes and faces"))
    told = solve_of(session.now())
    assert (told["stage"], told["bound"]) == ("building planes and faces", 6.0)
