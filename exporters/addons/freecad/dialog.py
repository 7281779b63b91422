"""linecad in FreeCAD: one photo to lines and faces in groups, by the installed command.

`linecad addon freecad` writes it, as one macro. The command runs in a process of its own; FreeCAD imports the STEP file
that it writes.
"""

import atexit
from pathlib import Path
from typing import Any

import FreeCAD
import FreeCADGui
from PySide import QtCore, QtGui

from exporters.addons.freecad.model import arrange, hide, import_model, look_from_camera, model_of
from exporters.addons.running import AddonError, Request, Running, find_command
from exporters.addons.told import GROUPINGS

TICK = 200  # ms between looks at the command
NAME = "linecad"
SETTINGS = "User parameter:Plugins/linecad"
STEPS = 100  # of the slider
HEIGHTS = 1000.0  # m, the highest camera that can be given
FILES = (
    ("photo", "Photo", "The photo to reconstruct"),
    ("camera", "Camera", "Its calibration or an fSpy project; empty: found in the photo"),
    ("depth", "Depth map", "From a network or a phone"),
    ("command", "Command", "The file linecad of its environment; empty: looked for on PATH"),
)


class Panel(QtGui.QDockWidget):  # type: ignore[misc]
    """What is asked for, how far it is, and the model."""

    def __init__(self, window: Any) -> None:
        super().__init__(NAME, window)
        self.setObjectName(NAME)
        self.running: Running | None = None
        self.page: Running | None = None
        self.request: Request | None = None
        self.files: dict[str, Any] = {}
        self.form = QtGui.QFormLayout()
        for name, label, tip in FILES:
            self._add_file(name, label, tip)
        self.files["command"].setText(FreeCAD.ParamGet(SETTINGS).GetString("Command"))
        self.scale = QtGui.QLineEdit()
        self.scale.setToolTip("A known length between two px of the photo, such as 840,310:840,655=2.1")
        self.form.addRow("Length", self.scale)
        self.camera_height = QtGui.QDoubleSpinBox()
        self.camera_height.setRange(0.0, HEIGHTS)
        self.camera_height.setToolTip("Of the camera above the ground, in m; 0: not known")
        self.form.addRow("Camera height", self.camera_height)
        self.is_fast = QtGui.QCheckBox("Fast")
        self.is_fast.setToolTip("A robust fit in tenths of a second, nothing proven")
        self.form.addRow("", self.is_fast)
        self._add_buttons()
        self._add_model()
        body = QtGui.QWidget()
        body.setLayout(self.form)
        self.setWidget(body)
        self.timer = QtCore.QTimer(self)
        self.timer.timeout.connect(self.look)
        escape = QtGui.QShortcut(QtGui.QKeySequence("Esc"), self, self.cancel)
        escape.setContext(QtCore.Qt.WidgetWithChildrenShortcut)
        QtCore.QCoreApplication.instance().aboutToQuit.connect(self.end_all)
        atexit.register(self.end_all)  # where FreeCAD runs without its own loop
        self.show_state()

    def _add_file(self, name: str, label: str, tip: str) -> None:
        field, choose, row = QtGui.QLineEdit(), QtGui.QToolButton(), QtGui.QHBoxLayout()
        field.setToolTip(tip)
        choose.setText("...")
        choose.clicked.connect(lambda: field.setText(QtGui.QFileDialog.getOpenFileName(self, tip)[0] or field.text()))
        row.addWidget(field)
        row.addWidget(choose)
        self.files[name] = field
        field.textChanged.connect(lambda _: self.show_state())
        self.form.addRow(label, row)

    def _add_buttons(self) -> None:
        self.buttons = {}
        for name, action in (
            ("Convert", self.convert),
            ("Correct in Browser", self.edit),
            ("Solve Again, Corrected", lambda: self.convert(is_corrected=True)),
            ("Cancel", self.cancel),
        ):
            self.buttons[name] = QtGui.QPushButton(name)
            self.buttons[name].clicked.connect(lambda _=False, action=action: action())
            self.form.addRow(self.buttons[name])
        self.state = QtGui.QLabel()
        self.state.setWordWrap(True)
        self.form.addRow(self.state)

    def _add_model(self) -> None:
        self.confidence = QtGui.QSlider(QtCore.Qt.Horizontal)
        self.confidence.setRange(0, STEPS)
        self.confidence.setToolTip("Hide lines less likely right than this, and the faces that only they show")
        self.confidence.valueChanged.connect(lambda value: self.set_confidence(value / STEPS))
        self.told = QtGui.QLabel()
        self.form.addRow("Confidence", self.confidence)
        self.form.addRow("", self.told)
        self.grouping = QtGui.QComboBox()
        for name, label, tip in GROUPINGS:
            self.grouping.addItem(label, name)
            self.grouping.setItemData(self.grouping.count() - 1, tip, QtCore.Qt.ToolTipRole)
        self.grouping.currentIndexChanged.connect(lambda _: self.set_grouping(self.grouping.currentData()))
        self.form.addRow("Group by", self.grouping)

    # --- what the user starts

    def convert(self, is_corrected: bool = False) -> None:
        """Start the command and let the window go on."""
        try:
            if self.running is not None:
                raise AddonError("linecad is at work already; wait or cancel it")
            self.request = self.asked(is_corrected)
            words = self.request.words_to_convert((".json", ".step", ".fspy"))
            self.running = Running([self.command(), *words], self.request.folder)
        except AddonError as error:
            self.complain(error)
            return
        self.timer.start(TICK)
        self.show_state()

    def edit(self) -> None:
        """Open the page on the photo in the browser, or close it."""
        if self.page is not None and not self.page.is_done:
            self.page.end()
            self.page = None
        else:
            try:
                self.page = Running([self.command(), *self.asked(is_corrected=False).words_to_edit()])
            except AddonError as error:
                self.complain(error)
                return
            self.timer.start(TICK)
        self.show_state()

    def cancel(self) -> None:
        """End the command."""
        if self.running is not None:
            self.running.end()
            self.look()

    def end_all(self) -> None:
        """Nothing goes on after FreeCAD."""
        for running in (self.running, self.page):
            if running is not None:
                running.end()

    def look(self) -> None:
        """Show how far the command is; import what it made, or say why there is nothing."""
        if self.page is not None and self.page.is_done:
            if self.page.problem:
                self.complain(self.page.problem)
            self.page = None
        if self.running is not None and self.running.is_done:
            running, self.running = self.running, None
            try:
                said = running.result()
                look_from_camera(import_model(self.asked_before()))
            except (AddonError, OSError, RuntimeError) as error:  # RuntimeError: FreeCAD's importer
                self.complain(error)
            else:
                FreeCAD.Console.PrintMessage("".join(f"linecad: {line}\n" for line in said))
                self.state.setText(said[0] if said else "imported")
        if self.running is None and self.page is None:
            self.timer.stop()
        self.show_state()

    def set_confidence(self, confidence: float) -> None:
        """Hide what is less sure in the model of the photo."""
        root = self.model()
        if root is not None and root.Confidence != confidence:
            root.Confidence = confidence
            hide(root)
            root.Document.recompute()
        self.told.setText(f"{confidence:.2f}" if root is None or root.HasProbabilities else "Fast tells no confidence")

    def set_grouping(self, grouping: str) -> None:
        """Group the lines of the model of the photo anew."""
        root = self.model()
        if root is not None and root.Grouping != grouping:
            root.Grouping = grouping
            arrange(root)
            root.Document.recompute()

    # --- what the fields say

    def asked(self, is_corrected: bool) -> Request:
        """What the fields ask for; AddonError where they do not."""
        chosen = {name: Path(field.text().strip()).expanduser() for name, field in self.files.items() if field.text()}
        if "photo" not in chosen:
            raise AddonError("no photo is chosen; choose one")
        return Request(
            photo=chosen["photo"].resolve(),
            camera=chosen.get("camera"),
            depth=chosen.get("depth"),
            scale=self.scale.text(),
            camera_height=self.camera_height.value(),
            is_fast=self.is_fast.isChecked(),
            is_corrected=is_corrected,
        )

    def asked_before(self) -> Request:
        """What the command that runs was asked."""
        assert self.request is not None
        return self.request

    def command(self) -> str:
        """The command, which is remembered."""
        chosen = str(self.files["command"].text().strip())
        FreeCAD.ParamGet(SETTINGS).SetString("Command", chosen)
        return find_command(chosen)

    def model(self) -> Any:
        """The model of the photo, if there is one."""
        text = self.files["photo"].text().strip()
        return model_of(Path(text).expanduser().resolve()) if text else None

    def complain(self, error: object) -> None:
        """Show an error, in one line."""
        text = " ".join(str(error).split())
        self.state.setText(text)
        FreeCAD.Console.PrintError(f"linecad: {text}\n")

    def show_state(self) -> None:
        """Make buttons and fields fit what goes on."""
        is_working, root = self.running is not None, self.model()
        if self.running is not None:
            self.state.setText(self.running.stage)
        for name, button in self.buttons.items():
            button.setEnabled(is_working == (name == "Cancel") or name == "Correct in Browser")
        is_open = self.page is not None
        self.buttons["Correct in Browser"].setText("Close Page" if is_open else "Correct in Browser")
        self.confidence.setEnabled(root is not None and root.HasProbabilities)
        self.grouping.setEnabled(root is not None)
        if root is not None:
            self.confidence.setValue(round(root.Confidence * STEPS))
            self.grouping.setCurrentIndex(self.grouping.findData(root.Grouping))


def show() -> Panel:
    """The panel in FreeCAD's window, where it stays until it is closed."""
    window = FreeCADGui.getMainWindow()
    panel = window.findChild(QtGui.QDockWidget, NAME)
    if panel is None:
        panel = Panel(window)
        window.addDockWidget(QtCore.Qt.RightDockWidgetArea, panel)
    panel.show()
    return panel  # type: ignore[no-any-return]


if __name__ == "__main__":  # so does FreeCAD call a macro
    show()
