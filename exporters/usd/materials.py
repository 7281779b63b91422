"""Preview surfaces of a USD stage: one colour, or the photo.

What emits has its colour in any light, as lines should, and as the photo should: the light of the day is in it.
"""

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, Vt

from exporters.colours import RGB, linear
from linecad.arrays import Float

_COORDINATES = "st"  # the name by which every reader finds texture coordinates


def add_material(stage: Usd.Stage, path: Sdf.Path, colour: RGB, emits: bool) -> None:
    """A surface of one colour, lit or emitting."""
    shader = _add_surface(stage, path)
    black, light = Gf.Vec3f(0.0), Gf.Vec3f(*linear(colour))
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(black if emits else light)
    shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).Set(light if emits else black)


def add_photo_material(stage: Usd.Stage, path: Sdf.Path, picture: str) -> None:
    """A surface that emits the colours of a picture, which is named as seen from the stage."""
    shader = _add_surface(stage, path)
    reader = UsdShade.Shader.Define(stage, path.AppendChild("Coordinates"))
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set(_COORDINATES)
    reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
    texture = UsdShade.Shader.Define(stage, path.AppendChild("Picture"))
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(f"./{picture}"))
    texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
    for direction in ("wrapS", "wrapT"):
        texture.CreateInput(direction, Sdf.ValueTypeNames.Token).Set("clamp")
    coordinates = texture.CreateInput("st", Sdf.ValueTypeNames.Float2)
    coordinates.ConnectToSource(reader.ConnectableAPI(), "result")
    texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3)
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.0))
    light = shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f)
    light.ConnectToSource(texture.ConnectableAPI(), "rgb")


def _add_surface(stage: Usd.Stage, path: Sdf.Path) -> UsdShade.Shader:
    material = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, path.AppendChild("Surface"))
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(1.0)
    shader.CreateInput("metallic", Sdf.ValueTypeNames.Float).Set(0.0)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return shader


def set_coordinates(mesh: UsdGeom.Mesh, coordinates: Float) -> None:
    """Give a mesh its texture coordinates (V, 2), one a point."""
    variables = UsdGeom.PrimvarsAPI(mesh)
    variable = variables.CreatePrimvar(_COORDINATES, Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex)
    variable.Set(Vt.Vec2fArray.FromNumpy(coordinates.astype(np.float32)))


def bind(stage: Usd.Stage, prim: Usd.Prim, material: Sdf.Path) -> None:
    """Give a prim its material."""
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(UsdShade.Material.Get(stage, material))
