"""Names by which FreeCAD 0.20 calls ifcopenshell and which 0.9 has no more: it imports nothing without them.

Runs in the Python of FreeCAD.
"""

from ifcopenshell import geom, ifcopenshell_wrapper

# By the old name: the new one, and what on and off are. The rest of what FreeCAD calls is as it was.
NAMES = {
    "USE_BREP_DATA": ("iterator-output", {True: ifcopenshell_wrapper.SERIALIZED}),
    "SEW_SHELLS": ("reorient-shells", {True: True}),
    "USE_WORLD_COORDS": ("use-world-coords", {True: True}),
    "DISABLE_OPENING_SUBTRACTIONS": ("disable-opening-subtractions", {True: True}),
    "APPLY_LAYERSETS": ("enable-layerset-slicing", {True: True}),
    "INCLUDE_CURVES": (
        "dimensionality",
        {True: ifcopenshell_wrapper.CURVES_SURFACES_AND_SOLIDS, False: ifcopenshell_wrapper.SURFACES_AND_SOLIDS},
    ),
}


class OldSettings(geom.settings):
    """Settings of the geometry that know their old names."""

    def __getattr__(self, name):
        return name if name in NAMES else super().__getattr__(name)

    def set(self, name, value):
        """Set what has an old or a new name."""
        if name in NAMES:
            name, values = NAMES[name]
            value = values[value]
        super().set(name, value)


def install():
    """Let whoever asks for settings have these."""
    geom.settings = OldSettings
