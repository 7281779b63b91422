"""A dataset on disk, scene after scene: drawn, measured, rendered, written; a run that was killed goes on.

Scene `index` of a dataset depends on its seed and index alone, so a longer dataset begins with a shorter one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.random import Generator

from linecad.dataset.choice import MOST_TRIES, judge
from linecad.dataset.depth_maps import NARROWEST, WIDEST, MapKind, draw_depth_map
from linecad.dataset.frames import with_frames
from linecad.dataset.light import Light, draw_light
from linecad.dataset.modelling import Model, parallelograms
from linecad.dataset.rasteriser import IN_PLANE, rasterise, visible_pieces
from linecad.dataset.scenes import SceneKind, draw_scene, scene_kind
from linecad.dataset.store import (
    DEPTH_MAP,
    LARGEST_SEED,
    LIST,
    OF_ALL_KINDS,
    TRUTH,
    DatasetList,
    read_list,
    read_truth,
    write_depth_map,
    write_list,
    write_scene_folder,
)
from linecad.dataset.textures import Image
from linecad.dataset.truth import TrueOpenings, Truth
from linecad.dataset.view import View
from linecad.errors import DatasetError, LinecadError, OutputError
from linecad.io.locks import alone

JUDGED_SIZE = (1920, 1080)  # px; scenes are judged at it whatever their size, so that the size does not change them
SMALLEST_SIDE, LARGEST_SIDE = 64, 8192  # px
MOST_SCENES = 10_000
MOST_SAMPLES = 4096
DEFAULT_SAMPLES = 32  # a pixel
LOCK = ".linecad-lock"  # in the folder while a run works in it

OnStage = Callable[[str], None]


@dataclass(frozen=True)
class DatasetOptions:
    """What a user can choose about a dataset."""

    scenes: int
    seed: int
    width: int = 3840  # px
    height: int = 2160  # px
    samples: int = DEFAULT_SAMPLES  # a pixel
    depth_maps: float | None = None  # width of the errors of simulated depth maps, in log depth; None: no maps
    depth_kind: MapKind = "z"  # of these maps

    def __post_init__(self) -> None:
        for value, low, high, what in (
            (self.scenes, 1, MOST_SCENES, "scenes"),
            (self.seed, 0, LARGEST_SEED, "the seed"),
            (self.width, SMALLEST_SIDE, LARGEST_SIDE, "the width in px"),
            (self.height, SMALLEST_SIDE, LARGEST_SIDE, "the height in px"),
            (self.samples, 1, MOST_SAMPLES, "samples a pixel"),
        ):
            if not low <= value <= high:
                raise LinecadError(f"{what}: {value} was asked for, {low} to {high} are possible")
        if self.depth_maps is not None and not NARROWEST <= self.depth_maps <= WIDEST:
            asked, least, most = (f"{100 * width:.4g}" for width in (self.depth_maps, NARROWEST, WIDEST))
            raise LinecadError(f"the errors of depth maps: {asked} % was asked for, {least} to {most} % are possible")


@dataclass(frozen=True, eq=False)
class Draft:
    """A scene before it is rendered."""

    name: str
    model: Model
    view: View
    light: Light
    attempt: int  # how many scenes of this index were drawn and not taken before


@dataclass(frozen=True, eq=False)
class Plan:
    """The scenes of a dataset before they are drawn."""

    names: tuple[str, ...]
    draw: Callable[[int], Draft]  # by the place among the names
    source: str = OF_ALL_KINDS  # what the scenes are drawn from, as dataset.json tells


@dataclass(frozen=True)
class Made:
    """What a run did."""

    new: int
    kept: int  # scenes that were there already


def plan_scenes(options: DatasetOptions, kind: SceneKind | None = None) -> Plan:
    """The scenes of a seed, of all kinds or of one."""
    names = tuple(scene_name(index, kind) for index in range(options.scenes))
    return Plan(names, lambda index: draw_draft(options.seed, index, kind), kind or OF_ALL_KINDS)


def draw_draft(seed: int, index: int, kind: SceneKind | None = None) -> Draft:
    """Scene `index` of the datasets of a seed: the first one drawn that `judge` takes, else the last one."""
    kind = kind or scene_kind(index)
    for attempt in range(MOST_TRIES):
        model, view = draw_scene(kind, np.random.default_rng([seed, index, attempt]))
        light = draw_light(np.random.default_rng([seed, index, attempt, 1]), kind == "room")
        draft = Draft(scene_name(index, kind), model, view, light, attempt)
        if judge(measure(draft, *JUDGED_SIZE), model).accepts(kind):
            break
    return draft


def measure(draft: Draft, width: int, height: int) -> Truth:
    """The ground truth of a scene at a size, px."""
    matrix, rotation = draft.view.matrix(width, height), draft.view.rotation()
    model = draft.model
    quads = model.quads(draft.view.eye)
    edges, edge_body = model.edges()
    edges = edges - draft.view.eye
    ids, _ = rasterise(quads, matrix, rotation, width, height)
    pieces, piece_edge = visible_pieces(edges, quads, matrix, rotation, ids, max(IN_PLANE, model.rounding / 10))
    truth = Truth(
        name=draft.name,
        width=width,
        height=height,
        matrix=matrix,
        rotation=rotation,
        quads=quads,
        body=np.array(model.body, np.int64),
        edges=edges,
        edge_body=edge_body,
        pieces=pieces,
        piece_edge=piece_edge,
        ids=ids,
        openings=TrueOpenings(
            parallelograms(np.array(model.openings).reshape(-1, 3, 3) - draft.view.eye),
            np.array(model.opening_is_door, bool),
            np.array(model.opening_body, np.int64),
        ),
    )
    if not model.has_frames:
        return truth
    return with_frames(truth, np.array(model.kinds)[truth.body] == "building", model.rounding)


def make_dataset(folder: Path, options: DatasetOptions, on_stage: OnStage, plan: Plan | None = None) -> Made:
    """Make what is missing of a dataset in `folder`: by a plan of `options.scenes` scenes, or of scenes of all kinds.

    Raises LinecadError.
    """
    plan = plan or plan_scenes(options)
    render = _renderer()
    _make_folder(folder)
    with alone(folder / LOCK, f"another linecad dataset works in {folder}", "wait for it, or give another folder"):
        return _make_missing(folder, options, plan, render, on_stage)


def _make_missing(folder: Path, options: DatasetOptions, plan: Plan, render: ModuleType, on_stage: OnStage) -> Made:
    made = _begin(folder, options, plan.source)
    names = plan.names
    missing = [index for index, name in enumerate(names) if name not in made]
    on_stage(f"{len(missing)} of {options.scenes} scenes to make; Mitsuba computes with {render.choose_variant()}")
    for index, name in enumerate(names):
        if name in made and options.depth_maps is not None:
            on_stage(f"{name}: depth map")
            _write_depth_map(folder, index, read_truth(folder / name), options)
    for index in missing:
        begun = f"{names[index]}, {index + 1} of {options.scenes}"
        on_stage(f"{begun}: drawing and measuring")
        draft = plan.draw(index)
        truth = measure(draft, options.width, options.height)
        seed = np.random.SeedSequence([options.seed, index, draft.attempt, 2])
        scene = render.load(draft.model, draft.view, draft.light, options.width, options.height)
        radiance = render.render(
            scene,
            options.samples,
            int(seed.generate_state(1)[0]),
            lambda done, begun=begun: on_stage(f"{begun}: rendered {done} of {options.samples} samples a pixel"),
        )
        write_scene_folder(folder, truth, _photo_writer(radiance, options.samples, np.random.default_rng(seed)))
        _write_depth_map(folder, index, truth, options)
        made = made | {names[index]}
        _write_list(folder, options, plan.source, made)
    return Made(len(missing), options.scenes - len(missing))


def _write_depth_map(folder: Path, index: int, truth: Truth, options: DatasetOptions) -> None:
    """Write the depth map of scene `index`, which is there, where maps are asked for. Raises OutputError."""
    if options.depth_maps is not None:
        rng = np.random.default_rng([options.seed, index, 0, 3])  # no other seed of a scene ends in 3
        arrays = draw_depth_map(truth, options.depth_maps, options.depth_kind, rng)
        write_depth_map(arrays, folder / truth.name / DEPTH_MAP)


def _renderer() -> ModuleType:
    """The module that needs Mitsuba. Raises LinecadError where that is not installed."""
    try:
        from linecad.dataset import render
    except ModuleNotFoundError as error:
        if error.name not in ("mitsuba", "drjit"):
            raise
        raise LinecadError("Mitsuba, which renders the scenes, is missing; pip install 'linecad[dataset]'") from None
    return render


def _photo_writer(radiance: Image, samples: int, rng: Generator) -> Callable[[Path], None]:
    from linecad.dataset.finishing import develop, write_photo

    photo = develop(radiance, samples, rng)
    return lambda path: write_photo(photo, path, rng)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder} cannot be used: {error.strerror}; choose another folder") from error


def _begin(folder: Path, options: DatasetOptions, source: str) -> frozenset[str]:
    """The scenes that are there already; makes the list where there is none. Raises LinecadError."""
    try:
        others = [path.name for path in folder.iterdir() if not path.name.startswith(".linecad-")]
    except OSError as error:
        raise OutputError(f"{folder} cannot be used: {error.strerror}; choose another folder") from error
    if LIST not in others:
        if others:
            raise OutputError(f"{folder} holds {sorted(others)[0]} and is no dataset; give a new or empty folder")
        _write_list(folder, options, source, frozenset())
        return frozenset()
    found = read_list(folder)
    asked = (options.seed, options.width, options.height, options.samples)
    if (found.seed, found.width, found.height, found.samples) != asked:
        raise DatasetError(
            f"{folder} was begun with seed {found.seed}, {found.width}x{found.height} px and {found.samples} samples; "
            "go on with these, or give another folder"
        )
    if found.source != source:
        raise DatasetError(f"{folder} was begun with scenes of another kind; give another folder")
    # A run can be killed between a scene and its entry in the list; its folder is whole all the same.
    whole = {path.parent.name for path in folder.glob(f"*/{TRUTH}") if not path.parent.name.startswith(".")}
    if whole != set(found.scenes):
        _write_list(folder, options, source, frozenset(whole))
    return frozenset(whole)


def _write_list(folder: Path, options: DatasetOptions, source: str, names: frozenset[str]) -> None:
    in_order = tuple(sorted(names, key=lambda name: (name.rpartition("-")[2], name)))
    write_list(DatasetList(options.seed, options.width, options.height, options.samples, in_order, source), folder)


def scene_name(index: int, kind: SceneKind | None = None) -> str:
    """The name of a scene, which is that of its folder."""
    return f"{kind or scene_kind(index)}-{index:04d}"
