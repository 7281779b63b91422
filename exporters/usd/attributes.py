"""What prims of all kinds are given: colours, extents and attributes of our own."""

from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from exporters.colours import RGB


def set_extent(shape: UsdGeom.Boundable) -> None:
    """Tell the box about a shape."""
    extent = UsdGeom.Boundable.ComputeExtentFromPlugins(shape, Usd.TimeCode.Default())
    shape.CreateExtentAttr(extent)


def set_display_colour(shape: UsdGeom.Gprim, colour: RGB) -> None:
    """Give a shape its colour, in linear light, for programs that know no materials."""
    shape.CreateDisplayColorPrimvar(UsdGeom.Tokens.constant).Set(Vt.Vec3fArray([Gf.Vec3f(*colour)]))


def set_own(prim: Usd.Prim, name: str, kind: Sdf.ValueTypeName, value: object) -> None:
    """Set an attribute that no schema knows."""
    prim.CreateAttribute(name, kind, True).Set(value)
