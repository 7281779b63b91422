"""The whole scene: what was found in one photo."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from linecad.arrays import Float, check_unique, freeze
from linecad.directions import Turns, components, count_of
from linecad.scene.camera import Camera, Certainty
from linecad.scene.cells import Cells
from linecad.scene.lines import Intersections, Lines
from linecad.scene.reports import DepthMapReport, SolveReport
from linecad.scene.surfaces import Face, Opening, Plane

SAME_HEIGHT = 1e-6  # of the scene's size, within which corners lie on one eave and in one wall


@dataclass(frozen=True, eq=False)
class Scene:
    """The reconstruction of one photo: what the scene file says."""

    photo: str  # file name, as given
    camera: Camera
    rotation: Float  # (3, 3) world to camera
    lines: Lines
    intersections: Intersections
    planes: tuple[Plane, ...]
    solve: SolveReport
    metres_per_unit: float | None = None
    scale_source: str = ""  # what told metres_per_unit: one clause, without a full stop; "" where that is not known
    notes: tuple[str, ...] = field(default=())
    certainty: Certainty | None = None  # of camera and rotation; None in scenes that do not tell
    depth_map: DepthMapReport | None = None  # None where none was given
    openings: tuple[Opening, ...] = ()
    turns: Turns = ()  # of the frames that lines and planes have beside the world's axes
    cells: Cells | None = None  # what each part of the photo shows; in no file, so None in scenes that come from one

    def __post_init__(self) -> None:
        freeze(self, "rotation", np.float64, (3, 3))
        known = set(self.lines.id.tolist())
        for name, ids in [("Intersections.lines", set(self.intersections.lines.ravel().tolist()))] + [
            (f"Plane {plane.id}", set(plane.lines)) for plane in self.planes
        ]:
            if not ids <= known:
                raise ValueError(f"{name} names line {min(ids - known)}, which the scene does not have")
        highest = max([*self.lines.axis.tolist(), *(plane.axis for plane in self.planes)], default=0)
        if highest >= count_of(self.turns):
            raise ValueError(f"Scene has a line or plane of axis {highest}, but {count_of(self.turns)} directions")
        check_unique("Scene.planes", [plane.id for plane in self.planes])
        check_unique("Scene.openings", [opening.id for opening in self.openings])
        walls, openings = {plane.id for plane in self.planes if plane.axis != 2}, {each.id for each in self.openings}
        for opening in self.openings:
            if opening.plane not in walls:
                raise ValueError(f"Opening {opening.id} is in plane {opening.plane}, which is no wall of the scene")
        for _, face in self.faces:
            if face.opening is not None and face.opening not in openings:
                raise ValueError(f"Face {face.id} is of opening {face.opening}, which the scene does not have")
        check_unique("Scene.faces", [face.id for _, face in self.faces])
        if self.metres_per_unit is not None and not 0 < self.metres_per_unit < np.inf:
            raise ValueError(f"Scene.metres_per_unit is {self.metres_per_unit}, expected a positive number")

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader of the scene should know: the notes, and where the scale came from."""
        return (*self.notes, *([f"scale: {self.scale_source}"] if self.scale_source else []))

    @property
    def walls_of_roofs(self) -> dict[int, int]:
        """The plane of the wall that carries each sloped plane, by ids; none for one whose eave lies in no wall."""
        size = float(np.abs(self.lines.ends).max(initial=1.0))
        found = {}
        for roof in self.planes:
            corners = np.concatenate([face.outline for face in roof.faces if roof.tilt] or [np.zeros((0, 3))])
            if len(corners):
                eave = corners[corners[:, 2] <= corners[:, 2].min() + SAME_HEIGHT * size]
                along = components(eave, self.turns)[:, roof.axis]
                walls = [plane for plane in self.planes if plane.axis == roof.axis and not plane.tilt and plane.lines]
                off = [float(np.abs(along - wall.offset).max()) for wall in walls]
                if off and min(off) <= SAME_HEIGHT * size:
                    found[roof.id] = walls[int(np.argmin(off))].id
        return found

    @property
    def components_of_planes(self) -> dict[int, int]:
        """The component that most lines of a plane are of, by the id of the plane; 0 where it has none.

        What shows the ground is of component 0, since all stand on it; a roof is of that of the wall that carries it.
        """
        component = dict(zip(self.lines.id.tolist(), self.lines.component.tolist(), strict=True))
        walls, lines = self.walls_of_roofs, {plane.id: plane.lines for plane in self.planes}
        counts = {
            plane.id: Counter(
                () if plane.shows_ground else (component[line] for line in lines[walls.get(plane.id, plane.id)])
            )
            for plane in self.planes
        }
        return {plane: min(count, key=lambda c: (-count[c], c), default=0) for plane, count in counts.items()}

    @property
    def components_of_faces(self) -> dict[int, int]:
        """The component of each face by its id: that of its plane, but of the parts of an opening that of its wall."""
        of_plane, wall = self.components_of_planes, {each.id: each.plane for each in self.openings}
        return {
            face.id: of_plane[plane.id if face.opening is None else wall[face.opening]] for plane, face in self.faces
        }

    @property
    def faces(self) -> list[tuple[Plane, Face]]:
        """Every face with its plane, in ascending order of face id."""
        pairs = [(plane, face) for plane in self.planes for face in plane.faces]
        return sorted(pairs, key=lambda pair: pair[1].id)
