"""A session on the made scene's picture, and the server on it without a socket."""

import pickle
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import pytest
from starlette.testclient import TestClient

import linecad.editing.session
import linecad.ties.depth_kind
import linecad.ties.depth_parts
import linecad.ties.parting
from exporters.model import build_model
from exporters.textures.layout import view_of
from exporters.textures.nearest import nearest_of, shape_of
from linecad.camera.photo import Photo
from linecad.corrections.edits import Corrections
from linecad.depth.depth_map import DepthMap
from linecad.editing.guard import HOST
from linecad.editing.saving import Saver
from linecad.editing.server import Editor
from linecad.editing.session import Session
from linecad.finding import name_lines
from linecad.lines.segments import find_segments
from linecad.options import Options
from linecad.pipeline import reconstruct

if TYPE_CHECKING:
    from linecad.editing.solving import Answer

PORT, TOKEN = 8765, "the-token"
MIDDLE_OF_SECOND = 987  # px, column of the made scene's second box
URL = f"http://{HOST}:{PORT}"


class InPlace:
    """Solves in the same process, when it is asked to: the test decides when an answer comes.

    What was solved before, for whichever test, is not solved again: most begin with the same lines.
    """

    known: ClassVar[dict[bytes, "Answer"]] = {}

    def __init__(self, photo, options, depth):
        self.photo, self.options, self.depth = photo, options, depth
        self.waiting, self.stopped, self.take = [], 0, None

    def start(self, task):
        self.waiting.append(task)

    def stop(self):
        self.stopped += 1

    def answer(self):
        """Solve what waits longest and tell the session."""
        from linecad.editing.solving import Answer, TaskSolver

        task = self.waiting.pop(0)
        key = pickle.dumps((task.found, task.corrected, self.options, self.depth))
        if key not in self.known:
            self.known[key] = TaskSolver(self.photo, self.options, self.depth).answer(task, lambda _: None)
        answer = replace(self.known[key], number=task.number)
        assert isinstance(answer, Answer)
        self.take(answer)


class Page:
    """What a page does: requests with the token, and the version of the state that it knows."""

    def __init__(self, client, session, solving, saved):
        self.client, self.session, self.solving, self.saved = client, session, solving, saved
        self.version = self.answer = None

    def get(self, path, **more):
        return self.client.get(f"/api/{path}", **more)

    def post(self, path, **body):
        return self.client.post(f"/api/{path}", json=body)

    def state(self):
        return self._heard(self.get("state").json())

    def change(self, path, **body):
        answer = self.post(path, base_version=self.version, **body)
        assert answer.status_code == 200, answer.text
        return self._heard(answer.json())

    def _heard(self, found):
        self.answer, self.version = found.pop("answer"), found["version"]
        return found

    def edit(self, **edit):
        return self.change("edit", edit=edit)

    def refused(self, status, path, **body):
        """The one line with which a request is refused; the state is the same after it."""
        before = self.state()
        answer = self.post(path, base_version=self.version, **body)
        assert answer.status_code == status, answer.text
        assert {**self.state(), "saved": None} == {**before, "saved": None}  # that may end in the meantime
        text = answer.json()["error"]
        assert text
        assert "\n" not in text
        return text

    def solve(self):
        self.state()
        assert self.post("solve", base_version=self.version).status_code == 200
        while self.solving.waiting:  # also what was asked for behind a fact before
            self.solving.answer()
        return self.state()


@pytest.fixture(scope="session")
def made_photo(made):
    return Photo("made.jpg", np.repeat(made.image()[:, :, None], 3, axis=2), made.camera)


@pytest.fixture(scope="session")
def raw(made_photo):
    return find_segments(made_photo.grey)


@pytest.fixture(scope="session", autouse=True)
def named_once(made_photo, raw):
    """The frame of the picture is found once for all tests: it takes longer than they do."""
    found = name_lines(made_photo, raw)

    def name(photo, segments, **more):
        return name_lines(photo, segments, **more) if more["drawn"] is not None or segments is not raw else found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(linecad.editing.session, "name_lines", name)
        yield


@pytest.fixture(scope="session")
def open_page(made_photo, raw):
    """A function that opens a page on the made scene's picture, with corrections that were there before."""
    savers = []

    def open_(corrections=None, options=None, depth=None):
        saved = []
        saver = Saver(saved.append)
        savers.append(saver)
        options = options or Options()
        corrections = corrections or Corrections("made.jpg", made_photo.width, made_photo.height)
        session = Session(made_photo, raw, options, corrections, saver.save)
        solving = InPlace(made_photo, options, depth)
        solving.take = session.take
        app = Editor(session, solving, saver, depth=depth).app(TOKEN, PORT)
        client = TestClient(app, base_url=URL, headers={"X-Linecad-Token": TOKEN}, raise_server_exceptions=True)
        page = Page(client, session, solving, saved)
        page.state()
        return page

    yield open_
    for saver in savers:
        saver.close()


@pytest.fixture(scope="session")
def map_of_made(made_photo):
    """A depth map of the made scene's picture: 2.5 times the depths of the faces that are found in it, else far off."""
    scene = reconstruct(made_photo, Options())
    view = view_of(scene)
    inverse = nearest_of([shape_of(face, view) for face in build_model(scene).faces], view).inverse_depth
    # One depth throughout would be taken for a sky, an even one for a wall.
    far = np.random.default_rng(0).uniform(40, 50, inverse.shape)
    values = np.where(inverse > 0, 2.5 / np.maximum(inverse, 1e-6), far)
    return DepthMap("made.depth.npz", values, values > 0, "z")


@pytest.fixture
def map_with_a_part(map_of_made, monkeypatch):
    """The map where it has the right half of the second box farther, and is believed."""
    monkeypatch.setattr(linecad.ties.depth_kind, "MOST_UNEVEN", np.inf)  # half of a box is far off in so small a scene
    monkeypatch.setattr(linecad.ties.parting, "WIDEST", np.inf)
    monkeypatch.setattr(linecad.ties.depth_parts.Part, "is_moved", lambda part, _: abs(part.move) > np.log(1.2))
    values = map_of_made.values.copy()
    values[:, MIDDLE_OF_SECOND:] *= 1.3
    return replace(map_of_made, name="right.depth.npz", values=values)


@pytest.fixture
def page(open_page):
    return open_page()


@pytest.fixture(scope="session")
def one_page(open_page):
    return open_page()


@pytest.fixture
def shared_page(one_page):
    """A page for tests that change nothing but the client's headers."""
    client = TestClient(one_page.client.app, base_url=URL, headers={"X-Linecad-Token": TOKEN})
    return Page(client, one_page.session, one_page.solving, one_page.saved)
