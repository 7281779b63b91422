"""An IFC file that is filled entity by entity, with everything that the entities of a building share.

The same scene gives the same file: the global ids follow from what the scene holds and from the key of each thing, such
as `wall 12`, and do not change when its scale becomes known or other options are chosen.
"""

import uuid
from collections.abc import Iterable, Mapping

import ifcopenshell
import ifcopenshell.guid
import numpy as np
import shapely

from exporters.colours import RGB
from exporters.faces import FlatFace
from exporters.identity import identity_of
from exporters.model import metres_per_unit
from linecad.arrays import Float
from linecad.scene import Scene

_PRECISION = 1e-7  # m; what is nearer is one point to a reader
ORIGIN = np.zeros(3)
X, Y, Z = np.eye(3)

Entity = ifcopenshell.entity_instance
Value = str | bool | int | float | tuple[str, ...]


class Metres(float):
    """A length in m, which readers show with its unit."""


_KINDS = {  # of a property by its value, the first that fits
    str: "IfcText",
    bool: "IfcBoolean",
    int: "IfcInteger",
    Metres: "IfcLengthMeasure",
    float: "IfcReal",
}


class Document:
    """Entities, the placements and styles that they share, and the relations between them."""

    def __init__(self, scene: Scene) -> None:
        self.file = ifcopenshell.file(schema="IFC4")
        self.unit = metres_per_unit(scene)  # m
        self._ids = identity_of(scene)
        self._key: dict[int, str] = {}  # of each rooted entity, by its number in the file
        self._members: dict[tuple[str, int], list[Entity]] = {}  # of relations by kind and number of what relates them
        self._layers: dict[str, list[Entity]] = {}
        self._materials: dict[str, tuple[Entity, list[Entity]]] = {}
        self._types: dict[str, tuple[Entity, list[Entity]]] = {}
        self._styles: dict[tuple[str, str], Entity] = {}
        self.world = self.add("IfcGeometricRepresentationContext", None, "Model", 3, _PRECISION, self.axes())
        self.body = self._sub_context("Body")
        self.annotation = self._sub_context("Annotation")

    def _sub_context(self, name: str) -> Entity:
        return self.add(
            "IfcGeometricRepresentationSubContext",
            ContextIdentifier=name,
            ContextType="Model",
            ParentContext=self.world,
            TargetView="MODEL_VIEW",
        )

    def add(self, kind: str, *values: object, **named: object) -> Entity:
        """A new entity with these attributes, in the order of the schema or by name."""
        return self.file.create_entity(kind, *values, **named)

    def add_rooted(self, kind: str, key: str, name: str | None, **named: object) -> Entity:
        """A new entity with a global id; `key` says what it is, and no other entity of the file has the same."""
        identity = ifcopenshell.guid.compress(uuid.uuid5(self._ids, key).hex)
        made = self.add(kind, GlobalId=identity, Name=name, **named)
        self._key[made.id()] = key
        return made

    # --- places -------------------------------------------------------------------------------------------------------

    def point(self, place: Float) -> Entity:
        """A point in m, of two or three coordinates."""
        return self.add("IfcCartesianPoint", tuple((place + 0.0).tolist()))  # a sum turns -0.0 around

    def direction(self, vector: Float) -> Entity:
        """A unit vector."""
        return self.add("IfcDirection", tuple((vector + 0.0).tolist()))

    def axes(self, origin: Float = ORIGIN, z: Float = Z, x: Float = X) -> Entity:
        """Axes about an origin, (3,) m, in the axes that they are placed in."""
        return self.add("IfcAxis2Placement3D", self.point(origin), self.direction(z), self.direction(x))

    def place(self, parent: Entity | None, origin: Float = ORIGIN, x: Float = X) -> Entity:
        """The place of a thing, (3,) m in the axes of its parent, where z is up and x a level unit vector."""
        return self.add("IfcLocalPlacement", parent, self.axes(origin, Z, x))

    # --- shapes -------------------------------------------------------------------------------------------------------

    def solid(self, profile: Entity, start: float, depth: float) -> Entity:
        """A profile in x and z, pushed along y from `start` by `depth`, m."""
        # From the far side on, so that the way of extrusion is that of the profile's own z, as all readers know it.
        axes = self.axes(np.array([0.0, start + depth, 0.0]), -Y, X)
        return self.add("IfcExtrudedAreaSolid", profile, axes, self.direction(Z), depth)

    def rectangle(self, width: float, height: float) -> Entity:
        """A profile from (0, 0) to (width, height), m."""
        middle = self.add("IfcAxis2Placement2D", self.point(np.array([width / 2, height / 2])), self.direction(X[:2]))
        return self.add("IfcRectangleProfileDef", "AREA", None, middle, width, height)

    def polygon(self, polygon: shapely.Polygon) -> Entity:
        """A profile with holes, m."""
        outline, *holes = (self.ring(ring) for ring in (polygon.exterior, *polygon.interiors))
        if holes:
            return self.add("IfcArbitraryProfileDefWithVoids", "AREA", None, outline, holes)
        return self.add("IfcArbitraryClosedProfileDef", "AREA", None, outline)

    def ring(self, ring: shapely.LinearRing) -> Entity:
        """A closed line, whose last point is the first again."""
        points = [self.point(place) for place in shapely.get_coordinates(ring)[:-1]]
        return self.add("IfcPolyline", [*points, points[0]])

    def surface(self, faces: Iterable[FlatFace]) -> Entity:
        """Flat faces with their holes, without thickness, where they are in the world."""
        shells = [self.add("IfcOpenShell", [self._face(face) for face in faces])]
        return self.add("IfcShellBasedSurfaceModel", shells)

    def _face(self, face: FlatFace) -> Entity:
        loops = [self.add("IfcPolyLoop", [self.point(place) for place in ring]) for ring in face.rings]
        kinds = ["IfcFaceOuterBound", *["IfcFaceBound"] * (len(loops) - 1)]
        return self.add("IfcFace", [self.add(kind, loop, True) for kind, loop in zip(kinds, loops, strict=True)])

    def shape(self, kind: str, item: Entity, context: Entity | None = None, layer: str = "") -> Entity:
        """What an element looks like: one item of a kind of representation, in the body's context unless told."""
        context = context or self.body
        shown = self.add("IfcShapeRepresentation", context, context.ContextIdentifier, kind, [item])
        if layer:
            self._layers.setdefault(layer, []).append(shown)
        return self.add("IfcProductDefinitionShape", Representations=[shown])

    # --- looks --------------------------------------------------------------------------------------------------------

    def paint(self, item: Entity, name: str, colour: RGB) -> None:
        """Show a surface or a solid in a colour, sRGB; every name has one."""
        if ("surface", name) not in self._styles:
            shading = self.add("IfcSurfaceStyleRendering", self._colour(colour), 0.0, ReflectanceMethod="NOTDEFINED")
            self._styles["surface", name] = self.add("IfcSurfaceStyle", name, "BOTH", [shading])
        self.add("IfcStyledItem", item, [self._styles["surface", name]])

    def draw(self, item: Entity, name: str, colour: RGB) -> None:
        """Show curves in a colour, sRGB; every name has one."""
        if ("curve", name) not in self._styles:
            self._styles["curve", name] = self.add("IfcCurveStyle", name, CurveColour=self._colour(colour))
        self.add("IfcStyledItem", item, [self._styles["curve", name]])

    def _colour(self, colour: RGB) -> Entity:
        return self.add("IfcColourRgb", None, *colour)

    # --- relations ----------------------------------------------------------------------------------------------------

    def compose(self, whole: Entity, part: Entity) -> None:
        """Make something a part of a whole."""
        self._members.setdefault(("IfcRelAggregates", whole.id()), []).append(part)

    def contain(self, structure: Entity, element: Entity) -> None:
        """Put an element into the site, the building or a storey."""
        self._members.setdefault(("IfcRelContainedInSpatialStructure", structure.id()), []).append(element)

    def reach(self, structure: Entity, element: Entity) -> None:
        """Say that an element reaches through a storey without being contained in it."""
        self._members.setdefault(("IfcRelReferencedInSpatialStructure", structure.id()), []).append(element)

    def void(self, element: Entity, opening: Entity) -> None:
        """Cut an opening out of an element."""
        self.add_rooted(
            "IfcRelVoidsElement", f"void {self._key[opening.id()]}", None,
            RelatingBuildingElement=element, RelatedOpeningElement=opening,
        )  # fmt: skip

    def fill(self, opening: Entity, element: Entity) -> None:
        """Put a window or a door into an opening."""
        self.add_rooted(
            "IfcRelFillsElement", f"fill {self._key[opening.id()]}", None,
            RelatingOpeningElement=opening, RelatedBuildingElement=element,
        )  # fmt: skip

    def make_of(self, element: Entity, material: str) -> None:
        """Say what an element is made of."""
        if material not in self._materials:
            self._materials[material] = self.add("IfcMaterial", material), []
        self._materials[material][1].append(element)

    def classify(self, element: Entity, kind: str, what: str, name: str, words: Mapping[str, str]) -> None:
        """Make an element one of the type `what`, which is of a kind and made with the first element of it.

        The name may tell sizes in metres; `what` must not, since ids do not follow the scale.
        """
        if what not in self._types:
            self._types[what] = self.add_rooted(kind, f"type {what}", name, **words), []
        self._types[what][1].append(element)

    def describe(self, thing: Entity, name: str, values: Mapping[str, Value]) -> None:
        """Give a thing a set of properties; tuples are lists of words."""
        key = f"{name} of {self._key[thing.id()]}"
        properties = [self._property(each, value) for each, value in values.items()]
        properties_set = self.add_rooted("IfcPropertySet", key, name, HasProperties=properties)
        self.add_rooted(
            "IfcRelDefinesByProperties", f"relation to {key}", None,
            RelatedObjects=[thing], RelatingPropertyDefinition=properties_set,
        )  # fmt: skip

    def _property(self, name: str, value: Value) -> Entity:
        if isinstance(value, tuple):
            return self.add("IfcPropertyListValue", Name=name, ListValues=[self.add("IfcText", word) for word in value])
        kind = next(kind for told, kind in _KINDS.items() if isinstance(value, told))
        return self.add("IfcPropertySingleValue", Name=name, NominalValue=self.add(kind, value))

    def finish(self) -> str:
        """The text of the file, with all relations, layers and materials that were told."""
        relating = {
            "IfcRelAggregates": ("RelatingObject", "RelatedObjects"),
            "IfcRelContainedInSpatialStructure": ("RelatingStructure", "RelatedElements"),
            "IfcRelReferencedInSpatialStructure": ("RelatingStructure", "RelatedElements"),
        }
        for (kind, number), members in self._members.items():
            one, many = relating[kind]
            whole = self.file.by_id(number)
            self.add_rooted(kind, f"{kind} {self._key[number]}", None, **{one: whole, many: members})
        for layer, shown in self._layers.items():
            self.add("IfcPresentationLayerAssignment", layer, None, shown)
        for name, (material, elements) in self._materials.items():
            self.add_rooted(
                "IfcRelAssociatesMaterial", f"made of {name}", None, RelatedObjects=elements, RelatingMaterial=material
            )
        for made, elements in self._types.values():
            self.add_rooted(
                "IfcRelDefinesByType", f"of {self._key[made.id()]}", None,
                RelatedObjects=elements, RelatingType=made,
            )  # fmt: skip
        text: str = self.file.to_string()
        return text
