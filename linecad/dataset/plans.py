"""The scenes of a dataset of buildings and views that are given in files."""

import hashlib
from dataclasses import replace
from pathlib import Path

import numpy as np

from linecad.dataset.imported import Surface, build_imported, surfaces_of
from linecad.dataset.light import Light, draw_light
from linecad.dataset.make import Draft, Plan
from linecad.dataset.polygons import Building, NamedView, read_buildings, read_views
from linecad.errors import DatasetError
from linecad.geometry import rotation_about

FAR = 250.0  # m from the camera, from which buildings are left out


def plan_views(buildings: Path, cameras: Path, seed: int, names: tuple[str, ...] = ()) -> Plan:
    """Views of buildings, all or those of these names; the seed gives materials and light. Raises DatasetError."""
    given = read_buildings(buildings)
    views = {view.name: view for view in read_views(cameras)}
    unknown = next((name for name in names if name not in views), None)
    if unknown is not None:
        raise DatasetError(f"{cameras} has no view {unknown}; it has {', '.join(list(views)[:4])} ...")
    chosen = [views[name] for name in names] or list(views.values())
    digest = hashlib.sha256(buildings.read_bytes() + cameras.read_bytes()).hexdigest()
    known: dict[str, list[Surface]] = {}  # cut into triangles once for all views
    return Plan(
        names=tuple(view.name for view in chosen),
        draw=lambda index: _draft(given, known, chosen[index], seed),
        source=f"buildings {digest[:16]}",
    )


def _draft(buildings: tuple[Building, ...], known: dict[str, list[Surface]], view: NamedView, seed: int) -> Draft:
    near = [building for building in buildings if _distance(building, view) < FAR]
    for building in near:
        if building.name not in known:
            known[building.name] = surfaces_of(building)
    model = build_imported({building.name: known[building.name] for building in near}, view.view.eye, view.ground, seed)
    # Views of one name have one light, whichever else are made.
    number = int.from_bytes(hashlib.sha256(view.name.encode()).digest()[:4])
    return Draft(view.name, model, view.view, _light(view, [seed, number, 1]), 0)


def _distance(building: Building, view: NamedView) -> float:
    """m, in plan, from the camera to the nearest corner."""
    corners = np.concatenate([polygon.rings[0][:, :2] for polygon in building.polygons] or [np.full((1, 2), np.inf)])
    return float(np.linalg.norm(corners - view.view.eye[:2], axis=1).min())


def _light(view: NamedView, seed: list[int]) -> Light:
    """A light that is drawn for a camera that looks along y, turned with this one."""
    light = draw_light(np.random.default_rng(seed), is_room=False)
    return replace(light, towards=rotation_about(np.array([0.0, 0.0, -view.view.yaw])) @ light.towards)
