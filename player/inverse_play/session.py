# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a person does: changes of the project that can be undone, recording, snapshots, files. Knows no window."""
import dataclasses
import os

from gi.repository import GLib, Gst, GstVideo
from inverse_common import files

from . import autosave, elements, lamps, launch_line, layers, project, scene, selection, source, trust
from .autosave import Autosave
from .history import History
from .messages import Trouble
from .playback import CLOSED, FAILED, PLAYING, Playback
from .recorder import Recorder, RecorderError


class Session:
    """`observer` is called without arguments in the main thread whenever something that a window shows changed,
    `report` with each Trouble, `finished` after the last frame of a source, `touched`(x, y) when a hand begins to draw
    at a pixel of the frame."""

    def __init__(self, make_sink, make_second_sink, first):
        self._make_second_sink = make_second_sink
        self.playback = Playback(make_sink, self)
        self.history = History(first)
        self.observer, self.report, self.finished = lambda: None, print, lambda: None
        self.touched = lambda x, y: None
        self.troubles = []  # all that were fatal
        self.recorder = None
        self._mouse, self._tap = ("off", "decomposer"), None
        self._lamp = {}  # the place of the lamp that the mouse touched last, by the name of its editor
        self.record_at_start, self.overwrite = None, False
        self._project_path = None  # of the file that it was loaded from or saved to
        self.saved, self.autosave = first, Autosave()  # the project as it was saved last, and what is not saved
        self.ask = lambda name, demands: False  # whether the user allows what a project demands

    @property
    def project(self):
        """The project now."""
        return self.history.state

    # What Playback calls.
    def on_state(self):
        """Playing, pausing and so on have changed."""
        self.observer()

    def on_trouble(self, trouble):
        """Something went wrong."""
        if trouble.fatal:
            self.troubles.append(trouble)
        self.report(trouble)

    def on_stopping(self):
        """No frame comes any more: a recording is complete."""
        self.stop_recording()

    def on_finished(self):
        """The last frame was shown."""
        self.finished()

    def on_property(self, element, name, value):
        """An element changed its own property, by the mouse."""
        described = self.project.element(element)
        stage = self.playback.stage
        if not described or not stage or not stage.keeps(element, name, value) or described.get(name) == value:
            return
        placed = scene.placed(described.get(name), value) if (element, name) == ("decomposer", scene.STROKES) else None
        if placed:
            self.history.amend(placed)
            described = self.project.element(element)
        before, key = described.get(name), (element, name, self.playback.presses)
        label = f"{name} of {elements.title(described.factory)}"
        if before != value:
            self._add(label, self.project.with_element(described.with_property(name, value)), key)
        stage.accept(self.project)
        self.playback.refresh()
        if name == lamps.LAMPS and before != value:
            self._select_lamp(element, lamps.touched(before, value), label, key)

    def _select_lamp(self, element, place, label, key):
        """The lamp at that place is what the settings of the next one set as well."""
        self._lamp[element] = place
        if place is not None:
            changed = described = self.project.element(element)
            for name, value in lamps.settings(described, place).items():
                changed = changed.with_property(name, value)
            self.change(label, self.project.with_element(changed), key)

    def on_event(self, structure):
        """An element reports something."""
        if structure.has_name("inverse-touch-began"):
            self.touched(structure.get_value("x"), structure.get_value("y"))
        elif structure.has_name("inverse-plane-lost"):
            self.report(Trouble("The plane of the picture is not found in this frame, so the picture is not shown.",
                                "It is shown again once it is found; or set corners anew, on a plane with more texture.", False))
        elif structure.has_name("scene-saved"):
            self.report(Trouble(f"Saved {structure.get_string('location')}.", fatal=False))

    # The source.
    @property
    def edited(self):
        """Whether there are edits of a video that was opened."""
        return bool(self.project.source) and dataclasses.replace(self.project, source="") != project.Project()

    def open(self, text, keep_edits=True):
        """Opens a source by its name. What does not open is reported."""
        try:
            opened = source.parse(text)
            if opened.text != self.project.source:
                self._add("Open", dataclasses.replace(self.project if keep_edits else project.Project(), source=opened.text))
            self._play(opened)
        except (source.SourceError, elements.ElementError) as error:
            self.on_trouble(Trouble(str(error)))

    def _play(self, opened):
        self.playback.open(opened, self.project)
        self._use_tool()
        if self.project.split is not None:
            self.playback.show_original(self._make_second_sink)
        path, self.record_at_start = self.record_at_start, None
        if path:
            self.start_recording(path)

    def toggle_playing(self):
        """Play or pause; opens the source again where it has to be."""
        if self.playback.state == PLAYING:
            self.playback.pause()
        elif not self.playback.play() and self.project.source:
            self.open(self.project.source)

    def close(self):
        """Ends everything; a recording is complete then."""
        self.playback.close()

    # The project.
    def _add(self, label, changed, key=None):
        self.history.add(label, changed, key)
        self._keep()
        self.observer()

    def _keep(self):
        """Keeps what is not saved for another run of the program."""
        edits = dataclasses.replace(self.project, source=self.saved.source)
        try:
            if edits == self.saved:
                self.autosave.saved()
            else:
                self.autosave.keep(self._kept())
        except OSError as error:
            self._not_written("The copy of the unsaved edits", error)

    def change(self, label, changed, key=None):
        """Does what makes the project `changed`."""
        changed = layers.corrected(changed)
        if changed == self.project:
            return
        self._add(label, changed, key)
        self._show()

    def _show(self):
        opened = self.playback.source
        moved = opened and self.playback.state != CLOSED and self.project.source != opened.text
        edits_failed = self.playback.state == FAILED and any(t.of_edits for t in self.troubles)
        if moved or edits_failed:
            self.troubles = [t for t in self.troubles if not t.of_edits]
            self.open(self.project.source)
            return
        self.playback.apply(self.project)
        if self.project.split is None:
            self.playback.hide_original()
        elif self.playback.state != CLOSED:
            self.playback.show_original(self._make_second_sink)
        self.observer()

    def show_layer(self, layer):
        """Shows a layer: a value of show of intrinsiccompose. Reports why if it is not there."""
        missing = layers.missing(layer, self.project)
        if missing:
            self.report(Trouble(*missing, fatal=False))
        else:
            self.set_property("compose", "show", layer)

    def use_tool(self, mouse="off", place="decomposer", tap=None):
        """What the mouse does by the element `place`, and before which editor colors are read ("": behind the last;
        None: nowhere)."""
        self._mouse, self._tap = (mouse, place), tap
        self._use_tool()

    def _use_tool(self):
        stage = self.playback.stage
        if stage:
            stage.mouse(*self._mouse)
            if stage.tap(self._tap):
                self.playback.refresh()

    def set_property(self, element, name, value):
        """Sets a property of an element of the project."""
        self.set_properties(element, {name: value}, name)

    def set_properties(self, element, values, what):
        """Sets properties of an element of the project, in one step. `what` they are, for undo."""
        changed = described = self.project.element(element)
        if set(values) & set(lamps.OF_NEXT):
            lit = lamps.changed(described.get(lamps.LAMPS), self._lamp.get(element), values)
            values = {**values, lamps.LAMPS: lit} if lit else values
        for name, value in values.items():
            changed = changed.with_property(name, value)
        label = f"{what} of {elements.title(described.factory)}"
        self.change(label, self.project.with_element(changed), (element, *values))

    def add_editor(self, factory, properties=None, behind=None):
        """Adds an editor behind the one of that name, or behind all; returns its name."""
        name = self.project.new_name(factory)
        editor = project.Element(name, factory)
        for key, value in (properties or {}).items():
            editor = editor.with_property(key, value)
        self.change(f"Add {elements.title(factory)}", self.project.with_editor_behind(editor, behind))
        return name

    def remove_editor(self, name):
        """Removes an editor."""
        title = elements.title(self.project.element(name).factory)
        self.change(f"Remove {title}", self.project.with_editors(e for e in self.project.editors if e.name != name))

    def move_editor(self, name, by):
        """Moves an editor towards the end of the chain (1) or its beginning (-1)."""
        editors = list(self.project.editors)
        at = self.project.index(name)
        to = min(max(at + by, 0), len(editors) - 1)
        editors.insert(to, editors.pop(at))
        self.change(f"Move {elements.title(editors[to].factory)}", self.project.with_editors(editors))

    def switch_editor(self, name):
        """Switches an editor off or on."""
        editor = self.project.element(name)
        switched = dataclasses.replace(editor, on=not editor.on)
        self.change(f"Switch {elements.title(editor.factory)} {'on' if switched.on else 'off'}",
                    self.project.with_element(switched))

    def set_decomposer(self, factory):
        """Decomposes by another element."""
        self.change(f"Decompose by {factory}",
                    dataclasses.replace(self.project, decomposer=project.Element("decomposer", factory)))

    def set_split(self, split):
        """Places the divider of the split view; None ends it."""
        self.change("Split view", dataclasses.replace(self.project, split=split), "split" if split else None)

    def draw(self, stroke, selected, paints):
        """Selects what is under a stroke, and recolors it if it `paints`; see selection.drawn. Returns the name of
        the element to set next."""
        frame = self.playback.width, self.playback.height
        changed, name = selection.drawn(self.project, selected, stroke, frame, paints)
        self.change("Paint an object" if paints else "Select an object", changed)
        return name

    def color_at(self, x, y):
        """The reflectance at a pixel of the frame as 0xffRRGGBB, where `use_tool` reads colors; None without."""
        color = self.playback.stage.color_at(x, y) if self.playback.stage else None
        return None if color is None else f"0x{color:08x}"

    def recolor_everywhere(self, x, y):
        """Recolors the color at a pixel of the frame wherever it is, by a new editor; returns its name."""
        key = self.color_at(x, y)
        return key and self.add_editor(selection.RECOLOR, {"key": key, "use-mask": False})

    # The scene that the decomposer remembers.
    @property
    def touches(self):
        """Whether a hand in the scene draws."""
        decomposer = self.project.decomposer
        return scene.is_offered(decomposer.factory) and decomposer.get(scene.TOUCH)

    def set_touch(self, on):
        """Lets a hand in the scene draw what the tool draws, or no longer."""
        self.set_properties("decomposer", scene.touched(on), "touch")

    def forget_scene(self):
        """Remembers the scene anew."""
        if self.project.decomposer.get(scene.LOAD):
            self.set_property("decomposer", scene.LOAD, "")  # else that one would be there again
        elif self.playback.stage:
            self.playback.stage.act("decomposer", scene.FORGET_ACTION)
            self.playback.refresh()

    def save_scene(self, path):
        """Writes the scene with the next frame."""
        if self.playback.stage and self.playback.stage.act("decomposer", scene.SAVE_ACTION, path):
            self.playback.refresh()

    def load_scene(self, path):
        """Begins with a scene that was saved."""
        if path != self.project.decomposer.get(scene.LOAD):
            self.set_property("decomposer", scene.LOAD, path)
        elif self.playback.stage:
            self.playback.stage.act("decomposer", scene.FORGET_ACTION)  # then it is read again
            self.playback.refresh()

    def undo(self):
        """Takes the last action back; returns its label."""
        label = self.history.undo()
        if label:
            self._keep()
            self._show()
        return label

    def redo(self):
        """Does it again; returns its label."""
        label = self.history.redo()
        if label:
            self._keep()
            self._show()
        return label

    # Files.
    def load(self, path):
        """Loads a project file; opens its source if it names another one."""
        try:
            loaded = project.load(path)
        except (OSError, elements.ElementError) as error:
            reason = f"{path} cannot be read: {error.strerror}" if isinstance(error, OSError) else str(error)
            self.on_trouble(Trouble(f"{reason}.", fatal=False))
            return
        if self.may_open(path, project.demands(loaded)):
            self._project_path = os.path.abspath(path)
            self._take(loaded, "Load project", loaded)

    def load_unsaved(self, path):
        """Goes on with edits that an earlier run of the program left (autosave.left)."""
        try:
            loaded = project.load(path)
        except (OSError, elements.ElementError) as error:
            self.on_trouble(Trouble(f"{path} cannot be read: {error}.", fatal=False))
            return
        self._take(loaded, "Go on with unsaved edits", self.saved)
        autosave.discard(path)

    def _take(self, loaded, label, saved):
        before = self.project.source
        loaded = dataclasses.replace(loaded, source=loaded.source or before)
        self.saved = saved
        self.change(label, loaded)
        self._keep()
        if loaded.source != before or self.playback.state in (CLOSED, FAILED):
            self.open(loaded.source)

    def may_open(self, name, demands):
        """Whether a project may do what it demands: if that was allowed before, or is now."""
        if trust.is_allowed(demands):
            return True
        if not self.ask(os.path.basename(name), demands):
            self.report(Trouble(f"{name} was not opened: it {'; it '.join(demands)}.", fatal=False))
            return False
        self._allow(demands)
        return True

    @staticmethod
    def _allow(demands):
        try:
            if demands:
                trust.allow(demands)
        except OSError:
            pass  # then it is asked again

    def save(self, path):
        """Saves a project file. Whether that worked."""
        try:
            project.save(self._kept(), path)
        except OSError as error:
            return self._not_written(path, error)
        self._allow(project.demands(self._kept()))  # it is the user's own
        self.saved, self._project_path = self.project, os.path.abspath(path)
        self._keep()
        return True

    def project_place(self):
        """Where the project would be saved: (name, folder), those of its file or of the video; the folder None: anywhere."""
        if self._project_path:
            folder, name = os.path.split(self._project_path)
            return name, folder
        source = self.project.source
        if os.path.exists(source):
            return f"{os.path.splitext(os.path.basename(source))[0]}.json", os.path.dirname(os.path.abspath(source))
        return "project.json", None

    def launch_line(self):
        """What is shown, as a command for a shell."""
        return launch_line.shell_text(self._kept(), self.playback.width)

    def _kept(self):
        """The project as it is saved: with what a hand draws, if one does."""
        mode, place = self._mouse
        if mode == "off" or place != "decomposer" or not self.touches:
            return self.project
        return self.project.with_element(self.project.decomposer.with_property(scene.MODE, mode))

    def save_launch_line(self, path):
        """Writes what is shown as a shell script. Whether that worked."""
        return self._write(path, f"#!/bin/sh\n{self.launch_line()}\n".encode())

    def _write(self, path, content):
        try:
            files.write(path, content)
            return True
        except OSError as error:
            return self._not_written(path, error)

    def _not_written(self, path, error):
        self.report(Trouble(f"{path} cannot be written: {error.strerror}.", "Choose another folder.", False))
        return False

    def snapshot(self, path):
        """Writes the picture that is shown as PNG. Whether that worked."""
        sample = self.playback.sink.get_property("last-sample") if self.playback.sink else None
        if not sample:
            self.report(Trouble("There is no picture yet.", "Open a video first.", False))
            return False
        try:
            png = GstVideo.video_convert_sample(sample, Gst.Caps.from_string("image/png"), 5 * Gst.SECOND)
        except GLib.Error as error:
            self.report(Trouble(f"The picture cannot be made a PNG: {error.message}.",
                                "Install gstreamer1.0-plugins-good.", False))
            return False
        return self._write(path, _content(png))

    def start_recording(self, path):
        """Records what is shown from now on. Whether that worked."""
        if not self.playback.stage:
            return False
        try:
            self.recorder = Recorder(path, self.playback.stage.picture_pad, self._on_recorder_failed, self.overwrite,
                                     self.project.source, self.playback.source.sound)
        except RecorderError as error:
            self.on_trouble(Trouble(str(error)))
            return False
        self.playback.every_frame(not self.playback.source.live)
        self.observer()
        return True

    def stop_recording(self):
        """Ends a recording; its file is complete then."""
        recorder, self.recorder = self.recorder, None
        if not recorder:
            return
        if recorder.stop():
            self.report(Trouble(f"Recorded {recorder.frames} frames to {recorder.path}.", recorder.note, fatal=False))
        else:
            self.on_trouble(Trouble(f"The recording failed: {recorder.failure}."))
        self.playback.every_frame(False)
        self.observer()

    def _on_recorder_failed(self, recorder):
        if recorder is self.recorder:
            self.stop_recording()


def _content(sample):
    buffer = sample.get_buffer()
    return buffer.extract_dup(0, buffer.get_size())
