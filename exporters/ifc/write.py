"""IFC 4 (ISO 16739-1:2018), in metres: https://standards.buildingsmart.org/IFC/RELEASE/IFC4/ADD2_TC1/HTML/

A project with a site, on it the ground, and a building: storeys as far as rows of windows tell them, walls with a
thickness that is assumed, openings in them with windows and doors, roofs, ceilings, other faces as proxies, and the
lines as annotations, a group a layer. Property sets `linecad_...` tell ids, what was assumed, and how sure the lines of
a face are. Nothing says where on earth it is. Needs the extra `ifc`.

There are no textures: IFC lays pictures on tessellated faces alone, not on walls that openings are cut out of, and the
programs that architects use do not show them (docs/decisions/0104).
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from exporters.camera import principal_point
from exporters.faces import FlatFace
from exporters.ifc.document import Document, Entity, Metres, Value
from exporters.ifc.rest import add_lines, add_loose_fitting, add_surface
from exporters.ifc.storeys import Storey, build_storeys, storey_of
from exporters.ifc.voids import Side, Void, build_voids, host_of
from exporters.ifc.walls import add_opening, add_wall, describe_filling, wall_thickness
from exporters.model import Model
from exporters.triangulation import checked_polygon

_TIMESTAMP = "1970-01-01T00:00:00"  # the real one would make each file another
_LEVEL = 1e-6  # the most that the normal of an upright wall has along z
_UNITS = {"LENGTHUNIT": "METRE", "AREAUNIT": "SQUARE_METRE", "VOLUMEUNIT": "CUBIC_METRE", "PLANEANGLEUNIT": "RADIAN"}


def write(model: Model, path: Path, wall_thickness: float = 0.3) -> None:
    """Write the model as IFC to `path`, its walls `wall_thickness` m thick; OSError where that fails."""
    path.write_text(_Building(model, wall_thickness).text(), encoding="ascii", newline="\n")


class _Building:
    """The file of a model as it is made."""

    def __init__(self, model: Model, assumed: float) -> None:
        self.model, self.assumed = model, assumed
        self.note = f"{model.unit_note}; walls are assumed to be {assumed:g} m thick, the photo shows their faces alone"
        self.document = Document(model.scene)
        self.voids = build_voids(model)
        self.storeys = build_storeys(self.voids)
        self.told = _evidence(model)

    def text(self) -> str:
        """The whole file."""
        self._add_structure()
        walls = [(face, Side.of(face)) for face in self.model.loose_faces if _is_wall(face)]
        hosted: dict[int | None, list[Void]] = {}
        for void in self.voids:
            hosted.setdefault(host_of(void, walls), []).append(void)
        for face, side in walls:
            self._add_wall(face, side, hosted.get(face.id, []))
        for void in hosted.get(None, []):
            for face in void.fitting.faces:
                checked_polygon(face)
            self._put(add_loose_fitting(self.document, self.inside, void.fitting), void)
        self._add_surfaces()
        for group in self.model.groups:
            self.document.contain(self.building, add_lines(self.document, self.inside, group))
        self._set_header()
        return self.document.finish()

    def _set_header(self) -> None:
        header = self.document.file.header
        header.file_description.description = ("ViewDefinition [DesignTransferView_V1.0]", f"Comment [{self.note}]")
        name = header.file_name
        name.name, name.time_stamp = "linecad", _TIMESTAMP
        name.preprocessor_version = name.originating_system = "linecad"

    def _add_structure(self) -> None:
        add = self.document
        units = [add.add("IfcSIUnit", None, kind, None, name) for kind, name in _UNITS.items()]
        project = add.add_rooted(
            "IfcProject", "project", self.model.photo or "photo", Description=self.note,
            RepresentationContexts=[add.world], UnitsInContext=add.add("IfcUnitAssignment", units),
        )  # fmt: skip
        add.describe(project, "linecad_Photo", self._photo())
        place = add.place(None)
        self.site = add.add_rooted(
            "IfcSite", "site", "site", ObjectPlacement=place, CompositionType="ELEMENT",
            Description="where on earth it is, is not known",
        )  # fmt: skip
        self.inside = add.place(place)
        self.building = add.add_rooted(
            "IfcBuilding", "building", "building", ObjectPlacement=self.inside, CompositionType="ELEMENT"
        )
        add.compose(project, self.site)
        add.compose(self.site, self.building)
        self.levels = [self._add_storey(number, storey) for number, storey in enumerate(self.storeys, 1)]
        self.roof: Entity | None = None

    def _add_storey(self, number: int, storey: Storey) -> Entity:
        add = self.document
        made = add.add_rooted(
            "IfcBuildingStorey", f"storey {number}", f"storey {number}", CompositionType="ELEMENT",
            Description="its level is that of the sills of its windows; the photo shows no floor",
            ObjectPlacement=add.place(self.inside, np.array([0.0, 0.0, storey.sill])), Elevation=storey.sill,
        )  # fmt: skip
        add.describe(made, "linecad_Storey", {"WindowsInRows": storey.windows, "HeadOfLowestRow": Metres(storey.head)})
        add.compose(self.building, made)
        return made

    def _photo(self) -> dict[str, Value]:
        scene = self.model.scene
        return {
            "Unit": self.model.unit_note,
            "ScaleIsKnown": scene.metres_per_unit is not None,
            "WallThicknessAssumed": Metres(self.assumed),
            "Photo": self.model.photo,
            "PhotoSize": f"{scene.camera.width} x {scene.camera.height} px",
            "FocalLength": f"{scene.camera.focal!r} px",
            "PrincipalPoint": "{!r} {!r} px from the top left corner".format(*principal_point(scene.camera)),
            "CameraPosition": " ".join(map(repr, self.model.eye.tolist())),
            "CameraFromWorld": " ".join(map(repr, scene.rotation.ravel().tolist())),
            "Notes": scene.remarks or ("none",),
        }

    def _add_wall(self, face: FlatFace, side: Side, voids: Sequence[Void]) -> None:
        thickness = wall_thickness(self.assumed, voids)
        wall = add_wall(self.document, self.inside, face, side, voids, thickness)
        self.document.contain(self.building, wall)
        why = "assumed" if thickness == self.assumed else "assumed, so that its deepest window is in it"
        self._describe_face(wall, face, {"Thickness": Metres(thickness), "ThicknessIs": why})
        reached = set()
        for void in voids:
            self._put(add_opening(self.document, wall, side, void, thickness), void)
            reached.add(storey_of(self.storeys, void))
        for number in sorted(number for number in reached if number is not None):
            self.document.reach(self.levels[number], wall)

    def _put(self, filling: Entity, void: Void) -> None:
        """A window or a door into its storey."""
        number = storey_of(self.storeys, void)
        self.document.contain(self.building if number is None else self.levels[number], filling)
        told = {**describe_filling(void), **self.told.get(void.plane, {})}
        self.document.describe(filling, "linecad_Opening", told)

    def _add_surfaces(self) -> None:
        for face in self.model.loose_faces:
            if not _is_wall(face):
                checked_polygon(face)
                made = add_surface(self.document, self.inside, face)
                self._describe_face(made, face, {})
                if face.kind == "roof":
                    self.document.compose(self._whole_roof(), made)
                else:
                    self.document.contain(self.site if face.kind == "ground" else self.building, made)

    def _whole_roof(self) -> Entity:
        """The roof that all faces of roofs are parts of."""
        if self.roof is None:
            place = self.document.place(self.inside)
            self.roof = self.document.add_rooted(
                "IfcRoof", "roof", "roof", ObjectPlacement=place, PredefinedType="NOTDEFINED"
            )
            self.document.contain(self.building, self.roof)
        return self.roof

    def _describe_face(self, made: Entity, face: FlatFace, more: Mapping[str, Value]) -> None:
        told = {"FaceId": str(face.id), "Kind": face.kind, "PlaneId": str(face.plane), **more}
        self.document.describe(made, "linecad_Face", {**told, **self.told.get(face.plane, {})})


def _is_wall(face: FlatFace) -> bool:
    return face.kind == "wall" and abs(face.normal[2]) <= _LEVEL


def _evidence(model: Model) -> dict[int, dict[str, Value]]:
    """By the id of a plane, what its lines tell: their components, how many, and how sure their depth is."""
    lines = model.scene.lines
    row = {number: place for place, number in enumerate(lines.id.tolist())}
    told: dict[int, dict[str, Value]] = {}
    for plane in model.scene.planes:
        rows = [row[number] for number in plane.lines]
        if rows:
            components = sorted(set(np.asarray(lines.component)[rows].tolist()))
            told[plane.id] = {"Lines": len(rows), "Components": ", ".join(map(str, components))}
            if len(lines.probability):
                told[plane.id]["Probability"] = float(np.median(np.asarray(lines.probability)[rows]))
    return told
