"""The routes of the page's server, by Starlette."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from exporters.formats import FORMATS, SCENE_FILE
from linecad.depth.depth_map import DepthMap
from linecad.editing.answers import Answers
from linecad.editing.body_document import parts_of_body, places_of, places_of_part
from linecad.editing.cell_layer import picture_of_cells
from linecad.editing.depth_layers import layer_of
from linecad.editing.document import document_of, solve_of
from linecad.editing.downloads import Download, download_of
from linecad.editing.edits import proposal_to_json, read_edit
from linecad.editing.guard import Guard, TooLargeError
from linecad.editing.labelling import labels_to_json
from linecad.editing.saving import Saver
from linecad.editing.session import Session
from linecad.editing.solving import Task
from linecad.editing.state import StaleError, ToSave
from linecad.editing.tabs import Tabs
from linecad.editing.tiles import Pyramid
from linecad.editing.wanted import document_of_shown, read_wanted, values_of
from linecad.errors import EditorError, LinecadError
from linecad.io.strict_json import JsonError, Node, parse

PAGE = Path(__file__).parent / "page"
MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
}
LABELS = "labels"  # beside the formats of scenes
LONGEST_NUMBER = 16  # digits of an answer
LONGEST_TAB = 100  # characters of a tab's name


class Solver(Protocol):
    """What solves tasks and tells the session."""

    def start(self, task: Task) -> None:
        """Solve this next."""

    def stop(self) -> None:
        """End with the best answer so far."""


class Editor:
    """The routes and what they work on."""

    def __init__(
        self,
        session: Session,
        solving: Solver,
        saver: Saver[ToSave],
        camera: object = None,
        depth: DepthMap | None = None,
    ) -> None:
        """`camera` is what a labels file says about it (`linecad.editing.labelling.camera_of_labels`).

        `depth` is the map on the photo's pixels that the solver is given.
        """
        self.session, self.solving, self.saver, self.camera, self.depth = session, solving, saver, camera, depth
        self.pyramid = Pyramid(session.photo.pixels)
        self.tabs, self.answers = Tabs(time.monotonic), Answers()
        self.files = page_files()

    def app(self, token: str, port: int) -> Guard:
        """The whole application; `port` is the one that it listens on."""
        routes = [
            Route("/", self.index),
            Route("/page/{name}", self.file),
            Route("/api/state", self.state),
            Route("/api/progress", self.progress),
            Route("/api/tile/{level:int}/{column:int}/{row:int}", self.tile),
            Route("/api/depth/{layer}", self.depth_layer),
            Route("/api/cells", self.cells),
            Route("/api/edit", _post(self.edit), methods=["POST"]),
            Route("/api/undo", _post(self.undo), methods=["POST"]),
            Route("/api/redo", _post(self.redo), methods=["POST"]),
            Route("/api/preview", _post(self.preview), methods=["POST"]),
            Route("/api/places/{body:int}", self.places),
            Route("/api/parts/{body:int}", self.parts),
            Route("/api/part", _post(self.part), methods=["POST"]),
            Route("/api/propose", _post(self.propose), methods=["POST"]),
            Route("/api/shown", _post(self.shown), methods=["POST"]),
            Route("/api/solve", _post(self.solve), methods=["POST"]),
            Route("/api/stop", _post(self.stop), methods=["POST"]),
            Route("/api/hello", _post(self.hello), methods=["POST"]),
            Route("/api/next-unlabelled", self.next_unlabelled),
            Route("/api/export/{name}", self.export),
        ]
        return Guard(Starlette(routes=routes), token, port)

    async def index(self, _request: Request) -> Response:
        """The page itself: no secret in it."""
        return self._file("index.html")

    async def file(self, request: Request) -> Response:
        """A script, a style or the icon of the page; only names that were there at the start."""
        return self._file(request.path_params["name"])

    def _file(self, name: str) -> Response:
        if name not in self.files:
            return _error(404, "there is no such file")
        return Response(self.files[name], media_type=MEDIA_TYPES[Path(name).suffix])

    def state(self, request: Request) -> Response:
        """GET /api/state?has=ANSWER."""
        has = request.query_params.get("has", "")
        return self._state(int(has) if has.isdecimal() and len(has) < LONGEST_NUMBER else None)

    def _state(self, known: int | None, then: BackgroundTask | None = None) -> Response:
        """The state, or how it differs from the `known` answer; `then` is done when it has been sent."""
        state = document_of(self.session.now(), self.pyramid.levels, self.saver.is_saved, self.depth)
        return JSONResponse(self.answers.answer(state, known), background=then)

    def progress(self, _request: Request) -> Response:
        """GET /api/progress: small, asked for several times a second."""
        now = self.session.now()
        return JSONResponse({"solve": solve_of(now), "version": now.version, "saved": self.saver.is_saved})

    def tile(self, request: Request) -> Response:
        """GET /api/tile/LEVEL/COL/ROW."""
        at = request.path_params
        data = self.pyramid.tile(at["level"], at["column"], at["row"])
        return _error(404, "there is no such tile") if data is None else Response(data, media_type="image/jpeg")

    def depth_layer(self, request: Request) -> Response:
        """GET /api/depth/LAYER: a picture over the photo, as the state that is shown has it."""
        data = None
        if self.depth is not None:
            data = layer_of(request.path_params["layer"], self.depth, self.session.now())
        return _error(404, "there is no such layer") if data is None else Response(data, media_type="image/png")

    def cells(self, _request: Request) -> Response:
        """GET /api/cells: a picture over the photo of what each part of it was taken for."""
        data = picture_of_cells(self.session.now())
        return _error(404, "there is no such layer") if data is None else Response(data, media_type="image/png")

    def edit(self, body: Node) -> Response:
        """POST /api/edit."""
        self.session.edit(_base(body), lambda session: read_edit(body["edit"], session))
        return self._changed(body)

    def undo(self, body: Node) -> Response:
        """POST /api/undo."""
        self.session.undo(_base(body))
        return self._changed(body)

    def redo(self, body: Node) -> Response:
        """POST /api/redo."""
        self.session.redo(_base(body))
        return self._changed(body)

    def _changed(self, body: Node) -> Response:
        """The state after a change; where that was about bodies, the scene is built anew behind it."""
        task, has = None, body.get("has")
        if self.session.wants_solve:
            task = self.session.task(self.session.now().version)
        # What is behind the answer is not to take the processor from who draws it.
        then = None if task is None else BackgroundTask(self.solving.start, task)
        return self._state(None if has is None else has.integer(), then)

    def preview(self, body: Node) -> Response:
        """POST /api/preview: by which log factors a fact would move bodies, and the ground, and what it contradicts."""
        try:
            moves, against, refused = self.session.preview(
                _base(body), lambda session: read_edit(body["edit"], session)
            )
        except StaleError as error:  # the page has gone on meanwhile, and wants to know no more
            moves, against, refused = {}, None, str(error)
        conflict = None if against is None else {"text": against.text, "lines": list(against.lines)}
        return JSONResponse(
            {"moves": {str(number): by for number, by in moves.items()}, "conflict": conflict, "refused": refused}
        )

    def places(self, request: Request) -> Response:
        """GET /api/places/BODY: where else a body could stand, the most likely first."""
        return JSONResponse(places_of(self.session.now(), request.path_params["body"]))

    def parts(self, request: Request) -> Response:
        """GET /api/parts/BODY: the parts of a body that may stand by themselves, the most doubtful first."""
        return JSONResponse(parts_of_body(self.session.now(), request.path_params["body"]))

    def part(self, body: Node) -> Response:
        """POST /api/part: where else the part of a body with these lines could stand."""
        lines = [line.integer() for line in body["lines"].items()]
        return JSONResponse(places_of_part(self.session.now(), lines))

    def propose(self, body: Node) -> Response:
        """POST /api/propose: what a drawn line would be, or one whose end is dragged."""
        return JSONResponse(proposal_to_json(body, self.session.editing))

    def shown(self, body: Node) -> Response:
        """POST /api/shown: which lines and faces `linecad export` would keep."""
        return JSONResponse(document_of_shown(self.session.now(), read_wanted(body)))

    def solve(self, body: Node) -> Response:
        """POST /api/solve."""
        task = self.session.task(_base(body))
        self.solving.start(task)
        return JSONResponse({"solving": task.number})

    def stop(self, _body: Node) -> Response:
        """POST /api/stop: the search ends with the best that it has."""
        self.solving.stop()
        return JSONResponse({})

    def hello(self, body: Node) -> Response:
        """POST /api/hello: whether a tab is the one that edits."""
        tab, takes_over = body["tab"].text(), body.get("take_over")
        if not 0 < len(tab) <= LONGEST_TAB:
            raise body["tab"].wrong(f"a name of 1 to {LONGEST_TAB} characters")
        leaving = body.get("leaving")
        if leaving is not None and leaving.boolean():
            self.tabs.leave(tab)
            return JSONResponse({"owner": False})
        owner = self.tabs.hello(tab, takes_over is not None and takes_over.boolean())
        return JSONResponse({"owner": owner, "version": self.session.now().version})

    def next_unlabelled(self, request: Request) -> Response:
        """GET /api/next-unlabelled?after=CROSSING."""
        after = request.query_params.get("after", "")
        if len(after) > len(str(2**53)) or not (after.isdecimal() or after == ""):
            return _error(422, "after is no crossing")
        return JSONResponse({"crossing": self.session.next_unlabelled(int(after) if after else None)})

    def export(self, request: Request) -> Response:
        """GET /api/export/FORMAT?wanted=JSON: the bytes that `linecad export` writes of what is wanted."""
        if request.path_params["name"] == LABELS:
            return self._labels()
        suffix = "." + request.path_params["name"]
        if suffix != SCENE_FILE and suffix not in FORMATS:
            return _error(404, "there is no such format")
        try:
            text = request.query_params.get("wanted")
            return _attached(self._exported(suffix, None if text is None else parse(text)))
        except (JsonError, LinecadError) as error:
            return _error(422, str(error))

    def _labels(self) -> Response:
        """GET /api/export/labels: what `linecad evaluate` reads."""
        lines, photo = self.session.lines, self.session.photo
        labels = labels_to_json(photo, self.camera, lines.graph, lines.annotations)
        return _attached(Download(f"{self._stem}.labels.json", labels.encode()))

    @property
    def _stem(self) -> str:
        """The photo's name in letters that every system takes."""
        stem = Path(self.session.photo.name).stem
        return "".join(c if c.isascii() and (c.isalnum() or c in "-_.") else "_" for c in stem) or "scene"

    def _exported(self, suffix: str, wanted: Node | None) -> Download:
        scene = self.session.scene()
        if wanted is not None:
            scene = read_wanted(wanted).of(scene)
        values = values_of(scene, suffix, wanted)
        return download_of(scene, self.session.photo.pixels, f"{self._stem}{suffix}", values)


def page_files() -> dict[str, bytes]:
    """The files of the page by name: read once, so that no request ever names a path."""
    files = {path.name: path.read_bytes() for path in PAGE.iterdir() if path.suffix in MEDIA_TYPES}
    if "index.html" not in files:
        raise EditorError("the files of the page are missing; install linecad again")
    return files


def _post(answer: Callable[[Node], Response]) -> Callable[[Request], Any]:
    """A route that reads its JSON strictly and turns what a user can act on into a status and one line."""

    async def route(request: Request) -> Response:
        try:
            body = parse((await request.body()).decode())
            return await run_in_threadpool(answer, body)
        except TooLargeError:
            return _error(413, "the request is too large")
        except UnicodeDecodeError:
            return _error(422, "the request is not UTF-8")
        except StaleError as error:
            return _error(409, str(error))
        except (JsonError, LinecadError) as error:
            return _error(422, str(error))

    return route


def _attached(file: Download) -> Response:
    headers = {"content-disposition": f'attachment; filename="{file.name}"'}
    return Response(file.data, media_type="application/octet-stream", headers=headers)


def _base(body: Node) -> int:
    return body["base_version"].integer()


def _error(status: int, text: str) -> Response:
    return JSONResponse({"error": text}, status_code=status)
