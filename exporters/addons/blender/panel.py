"""linecad in Blender: one photo to lines, faces and the photo's camera, by the installed command.

`linecad addon blender` writes it, as one file, for an extension for Blender 4.2 and newer that older ones
install as an add-on. The command runs in a process of its own; Blender imports the GLB and the photo that it writes.
"""

import atexit
from pathlib import Path
from typing import Any

import bpy

from exporters.addons.blender.model import arrange, hide, import_model, models_of
from exporters.addons.running import AddonError, Request, Running, find_command
from exporters.addons.told import GROUPINGS

bl_info = {
    "name": "linecad",
    "author": "The linecad authors",
    "version": (0, 0, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > linecad",
    "description": "One photo to lines, faces and its camera",
    "category": "Import-Export",
}

TICK = 0.2  # s between looks at the command
NAME = __package__ or __name__  # of the add-on: in an extension, in a folder, or in a file alone

_at_work: dict[str, Running] = {}  # at most one "convert" and one "edit"


class LinecadModel(bpy.types.PropertyGroup):  # type: ignore[misc]
    """What a collection tells that holds the model of a photo."""

    photo: bpy.props.StringProperty()
    has_probabilities: bpy.props.BoolProperty()
    confidence: bpy.props.FloatProperty(
        name="Confidence", description="Hide lines less likely right than this, and the faces that only they show",
        min=0.0, max=1.0, subtype="FACTOR", update=lambda self, _: hide(self.id_data),
    )  # fmt: skip
    grouping: bpy.props.EnumProperty(
        name="Group by", description="What a collection of lines holds", items=GROUPINGS,
        update=lambda self, _: arrange(self.id_data),
    )  # fmt: skip


class LinecadSettings(bpy.types.PropertyGroup):  # type: ignore[misc]
    """What a scene asks of the command."""

    photo: bpy.props.StringProperty(name="Photo", subtype="FILE_PATH", description="The photo to reconstruct")
    camera: bpy.props.StringProperty(
        name="Camera", subtype="FILE_PATH", description="Its calibration or an fSpy project; empty: found in the photo"
    )
    depth: bpy.props.StringProperty(name="Depth map", subtype="FILE_PATH", description="From a network or a phone")
    scale: bpy.props.StringProperty(
        name="Length", description="A known length between two px of the photo, such as 840,310:840,655=2.1"
    )
    camera_height: bpy.props.FloatProperty(
        name="Camera height", description="Of the camera above the ground; 0: not known", min=0.0, unit="LENGTH"
    )
    is_fast: bpy.props.BoolProperty(name="Fast", description="A robust fit in tenths of a second, nothing proven")
    has_tubes: bpy.props.BoolProperty(name="Tubes", description="Lines as thin tubes, which renders show")


class LinecadPreferences(bpy.types.AddonPreferences):  # type: ignore[misc]
    """Where the command is."""

    bl_idname = NAME
    command: bpy.props.StringProperty(
        name="Command",
        subtype="FILE_PATH",
        description="The file linecad of its environment; empty: looked for on PATH",
    )

    def draw(self, _: Any) -> None:
        """Show the path."""
        self.layout.prop(self, "command")


def request_of(scene: Any, is_corrected: bool) -> Request:
    """What the settings of a scene ask for."""
    chosen = scene.linecad
    if not chosen.photo:
        raise AddonError("no photo is chosen; choose one")
    return Request(
        photo=_path(chosen.photo),
        camera=_path(chosen.camera) if chosen.camera else None,
        depth=_path(chosen.depth) if chosen.depth else None,
        scale=chosen.scale,
        camera_height=chosen.camera_height,
        is_fast=chosen.is_fast,
        is_corrected=is_corrected,
        options=("tubes=on",) if chosen.has_tubes else (),
    )


def _path(text: str) -> Path:
    return Path(bpy.path.abspath(text)).resolve()


def _command(context: Any) -> str:
    return find_command(context.preferences.addons[NAME].preferences.command)


class LINECAD_OT_convert(bpy.types.Operator):  # type: ignore[misc]  # noqa: N801, Blender asks for such names
    """Run linecad on the photo and import the model, its camera and the photo"""

    bl_idname = "linecad.convert"
    bl_label = "Convert"
    bl_options = {"UNDO"}  # noqa: RUF012, as Blender has it
    corrected: bpy.props.BoolProperty(
        name="Corrected", description="With what was corrected on the page", options={"SKIP_SAVE"}
    )

    def invoke(self, context: Any, _: Any) -> set[str]:
        """Start the command and let the window go on."""
        if not self._start(context):
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: Any) -> set[str]:
        """The same for scripts, which wait for it."""
        if not self._start(context):
            return {"CANCELLED"}
        self.running.wait()
        return self._finish(context)

    def modal(self, context: Any, event: Any) -> set[str]:
        """Look at the command now and then, and end it with Esc."""
        if event.type == "ESC":
            self.running.end()
        if event.type not in ("ESC", "TIMER"):
            return {"PASS_THROUGH"}
        context.workspace.status_text_set(f"linecad: {self.running.stage}   Esc: cancel")
        _redraw(context)
        if not self.running.is_done:
            return {"PASS_THROUGH"}
        self.cancel(context)
        return self._finish(context)

    def cancel(self, context: Any) -> None:
        """Blender itself ends the operator, such as to load another file."""
        _at_work.pop("convert", None)
        self.running.end()
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)

    def _start(self, context: Any) -> bool:
        try:
            if "convert" in _at_work:
                raise AddonError("linecad is at work already; wait, or press Esc")
            self.request = request_of(context.scene, self.corrected)
            words = self.request.words_to_convert((".json", ".glb", ".fspy"))
            self.running = Running([_command(context), *words], self.request.folder)
        except AddonError as error:
            self.report({"ERROR"}, str(error))
            return False
        _at_work["convert"] = self.running
        return True

    def _finish(self, context: Any) -> set[str]:
        """Import what was made, or say why there is nothing."""
        _at_work.pop("convert", None)
        try:
            said = self.running.result()
            root = import_model(context, self.request)
        except (AddonError, OSError, RuntimeError) as error:  # RuntimeError: Blender's importer
            self.report({"WARNING" if self.running.was_ended else "ERROR"}, " ".join(str(error).split()))
            return {"CANCELLED"}
        finally:
            _redraw(context)
        root["linecad_notes"] = said
        _look_through(context)
        self.report({"INFO"}, said[0] if said else "imported")
        return {"FINISHED"}


class LINECAD_OT_edit(bpy.types.Operator):  # type: ignore[misc]  # noqa: N801
    """Open the page on the photo in the browser, to correct what linecad found; again: close it"""

    bl_idname = "linecad.edit"
    bl_label = "Correct in Browser"

    def execute(self, context: Any) -> set[str]:
        """Start the page, or end it."""
        page = _at_work.pop("edit", None)
        if page is not None and not page.is_done:
            page.end()
            return {"FINISHED"}
        try:
            request = request_of(context.scene, is_corrected=False)
            _at_work["edit"] = Running([_command(context), *request.words_to_edit()])
        except AddonError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        bpy.app.timers.register(_watch_page, first_interval=TICK)
        return {"FINISHED"}


class LINECAD_PT_panel(bpy.types.Panel):  # type: ignore[misc]  # noqa: N801
    """The panel in the sidebar of the 3D view."""

    bl_idname = "LINECAD_PT_panel"
    bl_label = "linecad"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "linecad"

    def draw(self, context: Any) -> None:
        """What is asked for, how far it is, and the model."""
        chosen, layout = context.scene.linecad, self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        for name in ("photo", "camera", "depth", "scale", "camera_height", "is_fast", "has_tubes"):
            layout.prop(chosen, name)
        running, page = _at_work.get("convert"), _at_work.get("edit")
        if running is not None:
            layout.label(text=f"{running.stage}, Esc cancels", icon="SORTTIME")
        layout.operator("linecad.convert", icon="IMPORT").corrected = False
        opened = page is not None and not page.is_done
        layout.operator("linecad.edit", text="Close Page" if opened else "Correct in Browser", icon="URL")
        if page is not None and page.is_done and page.problem:
            layout.label(text=page.problem, icon="ERROR")
        layout.operator("linecad.convert", text="Solve Again, Corrected", icon="FILE_REFRESH").corrected = True
        for root in models_of(_path(chosen.photo)) if chosen.photo else []:
            if root.linecad.has_probabilities:
                layout.prop(root.linecad, "confidence", slider=True)
            else:
                layout.label(text="Fast tells no confidence")
            layout.prop(root.linecad, "grouping")


def _watch_page() -> float | None:
    """Show in the panel when the page has ended; None: no need to look again."""
    page = _at_work.get("edit")
    if page is not None and not page.is_done:
        return 1.0
    _redraw(bpy.context)
    return None


def _redraw(context: Any) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _look_through(context: Any) -> None:
    """Show the model over the photo in the 3D views of the window."""
    for area in context.screen.areas if context.screen else ():
        if area.type == "VIEW_3D":
            area.spaces.active.region_3d.view_perspective = "CAMERA"


def _end_all() -> None:
    """Nothing goes on after Blender or the add-on."""
    for running in list(_at_work.values()):
        running.end()
    _at_work.clear()


CLASSES = (
    LinecadModel, LinecadSettings, LinecadPreferences, LINECAD_OT_convert, LINECAD_OT_edit, LINECAD_PT_panel
)  # fmt: skip


def register() -> None:
    """Called by Blender where the add-on is enabled."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.linecad = bpy.props.PointerProperty(type=LinecadSettings)
    bpy.types.Collection.linecad = bpy.props.PointerProperty(type=LinecadModel)
    atexit.register(_end_all)


def unregister() -> None:
    """Called by Blender where the add-on is disabled."""
    _end_all()
    atexit.unregister(_end_all)
    del bpy.types.Scene.linecad, bpy.types.Collection.linecad
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
