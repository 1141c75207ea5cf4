# SPDX-License-Identifier: LGPL-2.1-or-later
"""The window: puts its parts together, and does what keys and buttons ask for."""
from gi.repository import Gdk, GLib, Gtk

from .. import autosave, elements, layers, selection, tools
from ..messages import Trouble
from ..playback import CLOSED, ENDED, FAILED, PAUSED, PLAYING
from . import dialogs, keys
from .header import LAYER_KEYS, Header
from .mouse import Mouse
from .panel import Panel
from .picture import Picture
from .scene import ACTIONS, SceneTools
from .strokes import StrokeView
from .style import add_class, label
from .timeline import Timeline
from .toolbar import Toolbar

SKIP_SECONDS, SPLIT_STEP, BRUSH_STEP = 5, 0.05, 1.25
INFO_SECONDS = 8
MOVING = {"Up", "Down", "Left", "Right", "Home", "End", "Page_Up", "Page_Down", "Tab", "ISO_Left_Tab", "space", "Return"}
PICTURES = "image/png", "image/jpeg"  # that intrinsictexture reads


class Window(Gtk.Window):
    """`session` is a Session, whose pictures it shows; `folder` is where recordings and snapshots go."""

    def __init__(self, make_session, folder=None):
        super().__init__(title="inverse-play", default_width=1360, default_height=820)
        self.picture = Picture(lambda split: self.session.set_split(split))
        self.session = make_session(self.picture.make_sink, self.picture.make_original_sink)
        self._folder, self.exit_at_end = folder, False
        self._info_timer, self._tool_before, self._unsaved = None, tools.LOOK, None
        self._failed = False  # whether the message that is shown is why nothing plays
        self._build()
        self.session.observer, self.session.report = self.update, self.show_trouble
        self.session.ask = lambda name, demands: dialogs.may_open(self, name, demands)
        self.session.finished, self.session.touched = self._on_finished, self.strokes.move
        self.session.playback.on_mouse = self._on_mouse
        self._keys = keys.Keys([(t.key, f"tool-{t.name}") for t in self.all_tools()] +
                               [(key, f"add-{factory}") for factory, _, key, _ in tools.editors()])
        self.connect("key-press-event", self._on_key)
        self.connect("delete-event", lambda *_: self.quit())
        self._waited = 0  # ticks for a frame
        self._timers = [GLib.timeout_add(200, self._tick), GLib.timeout_add(1000, self._tick_rate)]
        self.connect("destroy", self._on_destroy)
        self.update()

    def _on_destroy(self, _window):
        for timer in (*self._timers, self._info_timer):
            if timer:
                GLib.source_remove(timer)
        self._info_timer = None

    def all_tools(self):
        """The tools of the project's decomposer."""
        return tools.offered(self.session.project)

    # Its parts.
    def _build(self):
        self.header = Header(self.do, self.open, self.session.show_layer)
        self.set_titlebar(self.header)
        self.strokes = StrokeView(self.picture.frame_place)
        self.picture.add_overlay(self.strokes)
        self.picture.set_overlay_pass_through(self.strokes, True)
        self.scene = SceneTools(self.session, self.note, self._choose_stroke)
        self.toolbar = Toolbar(self.session.project, self.choose_tool, self.add_editor,
                               self._do_another_object, self.scene)
        self.panel = Panel(self.session, lambda: self.mouse.use_element(), self._pick_up)
        self.mouse = Mouse(self.session, self.panel, self.strokes, self.note,
                           lambda: self.choose_tool(self._tool_before))
        self.timeline = Timeline(self.session.playback, self.session.toggle_playing)
        self.help = keys.help_overlay([(t.key, t.label) for t in self.all_tools()],
                                      [(key, title) for _, title, key, _ in tools.editors()])
        self.start = None
        row = Gtk.Box()
        row.pack_start(self.toolbar, False, False, 0)
        row.pack_start(self.picture, True, True, 0)
        row.pack_start(self.panel, False, False, 0)
        column = Gtk.Box(orientation=Gtk.Orientation.VERTICAL)
        self.info = self._info_bar()
        self.picture.add_overlay(self.info)
        column.pack_start(row, True, True, 0)
        column.pack_start(self.timeline, False, False, 0)
        whole = Gtk.Overlay()
        whole.add(column)
        whole.add_overlay(self.help)
        self.add(whole)
        whole.show_all()
        self.header.show_all()

    def _info_bar(self):
        # Over the picture: one beside it would move what the mouse is about to press.
        bar = Gtk.InfoBar(show_close_button=True, no_show_all=True, valign=Gtk.Align.END)
        self._info_text = label("", wrap=True, selectable=False)
        self._info_text.show()
        bar.get_content_area().add(self._info_text)
        self._undo, self._again = bar.add_button("Undo", 2), bar.add_button("Try again", 1)
        self._go_on = bar.add_button("Open them", 3)
        bar.connect("response", self._on_info)
        return bar

    def _start_page(self):
        """What is shown in place of a picture."""
        box = add_class(Gtk.Box(orientation=Gtk.Orientation.VERTICAL, spacing=6, halign=Gtk.Align.CENTER,
                                valign=Gtk.Align.CENTER), "help")
        box.add(label("Open a video", "heading"))
        for words, do in self.header.source_rows():
            button = Gtk.Button(label=words)
            button.connect("clicked", lambda _, do=do: do())
            box.add(button)
        box.add(label("F1 lists the keys", "faint"))
        box.show_all()
        return box

    # What is shown.
    def update(self):
        """Shows the session as it is now."""
        session, playback = self.session, self.session.playback
        self.header.update(session.project, session.recorder is not None, session.project.split is not None)
        if self.tool not in self.all_tools() or (self.tool.lamps and not self.mouse.lit_by()):
            self.choose_tool(tools.LOOK)
        self.toolbar.update(session.project, self.tool)
        self.scene.update()
        self.panel.update()
        self.timeline.update()
        self._show_start(playback.state == CLOSED and not session.project.source)
        self._show_split()
        self._show_strokes()
        if self._failed and playback.state == PLAYING:  # what was wrong is over
            self.info.hide()
        self._failed = self._failed and playback.state != PLAYING
        if playback.source and playback.state != CLOSED:
            self.set_title(f"{playback.source.title} – inverse-play")

    def _show_start(self, shown):
        if shown and not self.start:
            self.start = self._start_page()
            self.picture.add_overlay(self.start)
        elif not shown and self.start:
            self.start.destroy()
            self.start = None

    def _show_split(self):
        playback = self.session.playback
        split = self.session.project.split if playback.state != CLOSED else None
        self.picture.show_split(split, (playback.width, playback.height))

    def _show_strokes(self):
        tool, described = self.tool, self.mouse.drawn_on()
        text = None
        if tool.draws or (tool.mouse != "off" and not tool.lamps):
            text = described.get("strokes::list") if described else ""
        self.strokes.show_strokes(text, self.mouse.brush(), (self.session.playback.width, self.session.playback.height))

    def _tick(self):
        # Of ticks before: what comes at once flickers.
        self._waited = self._waited + 1 if self.session.playback.waits else 0
        self.picture.show_waiting(self._waited > 2)
        self.timeline.update()
        self._show_split()
        return GLib.SOURCE_CONTINUE

    def _tick_rate(self):
        self.timeline.update_rate()
        self.scene.update()
        return GLib.SOURCE_CONTINUE

    def show_trouble(self, trouble):
        """Shows an error, a warning or a note at the bottom of the picture."""
        if self._info_timer:
            GLib.source_remove(self._info_timer)
            self._info_timer = None
        if not trouble.fatal:
            self._info_timer = GLib.timeout_add_seconds(INFO_SECONDS, self._hide_info)
        self._failed = trouble.fatal and self.session.playback.state in (CLOSED, FAILED)
        self._info_text.set_text(f"{trouble.text} {trouble.advice}".strip())
        self.info.set_message_type(Gtk.MessageType.ERROR if trouble.fatal else Gtk.MessageType.INFO)
        self._again.set_visible(self.session.playback.state in (CLOSED, FAILED) and bool(self.session.project.source))
        self._undo.set_visible(trouble.fatal and trouble.of_edits)
        self._go_on.hide()
        self.info.show()

    def note(self, text):
        """Shows a note for some seconds."""
        self.show_trouble(Trouble(text, fatal=False))

    def _hide_info(self):
        self._info_timer = None
        self.info.hide()
        return GLib.SOURCE_REMOVE

    def _on_info(self, bar, response):
        bar.hide()
        if response == 1:
            self.session.open(self.session.project.source)
        elif response == 2:
            self.session.undo()
        elif response == 3:
            self.session.load_unsaved(self._unsaved)

    def offer_unsaved(self):
        """Offers edits that an earlier run of the program left."""
        for path in autosave.left():
            what = autosave.title(path)
            if what:
                self._unsaved = path
                self.show_trouble(Trouble(f"There are unsaved edits of {what}.", fatal=True))
                self.info.set_message_type(Gtk.MessageType.QUESTION)
                self._again.hide()
                self._go_on.show()
                return

    # Tools.
    @property
    def tool(self):
        """What the mouse does."""
        return self.mouse.tool

    def choose_tool(self, tool, picks=None):
        """What the mouse does from now on. `picks`: the property that the tool Pick sets."""
        if tool.lamps and not self.mouse.lit_by():
            self.add_editor(tools.RELIGHT_FACTORY)  # which comes back to here
            return
        if tool.mouse != "off":
            self.panel.selected = self.mouse.lit_by() if tool.lamps else "decomposer"
        if tool == tools.PICK and self.tool != tools.PICK:
            self._tool_before = self.tool
        self.mouse.use(tool, picks)
        self.picture.set_cursor("default" if tool == tools.LOOK else "crosshair")
        self.update()

    def _choose_stroke(self):
        """Chooses a tool that draws strokes of the decomposer, if none is chosen."""
        if self.tool.mouse == "off" or self.tool.lamps:
            self.choose_tool(next(t for t in self.all_tools() if t.mouse == "recolor"))

    def _pick_up(self, name):
        self.choose_tool(tools.PICK, name)

    def add_editor(self, factory):
        """Adds an editor behind the selected one, and selects it: for the object that is selected if that is intrinsicselect, else for the
        whole picture. The mouse does what that editor needs first."""
        picture, selected = None, selection.selection_of(self.session.project, self.panel.selected)
        if factory == tools.TEXTURE_FACTORY:
            picture = dialogs.file_to_open(self, "The picture to hang", PICTURES)
        settings = {"location": picture} if picture else {}
        if factory == selection.KEY:
            settings = {"key": "0x00000000"}  # what is at the border, until a color is picked
        reach = ""
        if selected and "use-mask" in elements.properties(factory):
            of_object = selected.name == self.panel.selected
            settings["use-mask"] = of_object
            reach = f"{elements.title(factory)} applies to the {'selected object' if of_object else 'whole picture'}: "
            reach += f"turn use mask {'off for the whole picture' if of_object else 'on for the selected object'}."
        self.panel.select(self.session.add_editor(factory, settings, self.panel.selected))
        self._begin_with(factory, picture, reach)

    def _begin_with(self, factory, picture, reach):
        """Chooses the tool for an editor that was just added."""
        selects = self.tool.draws and not self.tool.paints
        if not (selects and selection.selection_of(self.session.project, self.panel.selected)):
            self.choose_tool(tools.LOOK)  # the one before would change something else
        words = ""
        if factory == tools.RELIGHT_FACTORY:
            self.choose_tool(tools.LAMP)
            words = "Click to place a lamp, drag it to move it. Lower ambient to see it better. "
        elif factory == tools.TEXTURE_FACTORY:
            self.choose_tool(tools.LOOK)
            words = "" if picture else "Choose a picture: location, at the right. "
            words += "Drag over the place where the picture shall hang, then drag its corners. "
        elif factory == selection.KEY:
            self.choose_tool(tools.LOOK)
            self._pick_up("key")
            words = "Click on the screen to separate the foreground from it, by its color. "
        if words or reach:
            self.note((words + reach).strip())

    def _on_mouse(self, kind, x, y, shift):
        if kind == "mouse-button-press":
            self.set_focus(None)  # what was typed is complete
        return self.mouse.take(kind, x, y, shift)

    # Keys and buttons.
    def _on_key(self, _window, event):
        action = self._keys.action_of(event)
        if not action or self._typing(event):
            return False
        self.do(action)
        return True

    def _typing(self, event):
        """Whether the key is a part of a text that is typed, or moves the control that has the keyboard."""
        focus = self.get_focus()
        if not focus or not focus.is_ancestor(self.panel):
            return False
        if not isinstance(focus, (Gtk.Entry, Gtk.TextView)):
            return not event.state & keys.CONTROL and Gdk.keyval_name(event.keyval) in MOVING
        special = event.state & keys.CONTROL or event.keyval == Gdk.KEY_Escape or \
            Gdk.KEY_F1 <= event.keyval <= Gdk.KEY_F12
        return not special

    def do(self, action):
        """Does an action of keys.SHORTCUTS, or one of a tool or an editor."""
        if action.startswith("layer-") and action[6:].isdigit():
            self.session.show_layer(self._layers()[int(action[6:]) - 1])
        elif action.startswith("tool-"):
            tool = next((t for t in self.all_tools() if f"tool-{t.name}" == action), None)
            if tool:
                self.choose_tool(tool)
            else:
                self.note(f"{self.session.project.decomposer.factory} has no such tool.")
        elif action.startswith("add-"):
            self.add_editor(action[4:])
        elif action in ACTIONS:
            self.scene.do(action)
        else:
            getattr(self, "_do_" + action.replace("-", "_"))()

    def _layers(self):
        return list(self.header.layers)

    def _do_layer_next(self):
        session = self.session
        further = [n for n, _, _ in layers.choices()[len(LAYER_KEYS):] if not layers.missing(n, session.project)]
        if not further:
            self.note("This decomposer has no further layers; globalintrinsic has direct and indirect light.")
            return
        show = session.project.compose.get("show")
        session.show_layer(further[(further.index(show) + 1) % len(further) if show in further else 0])

    def _do_play(self):
        self.session.toggle_playing()

    def _do_back(self):
        self.session.playback.seek(self.session.playback.goal - SKIP_SECONDS)

    def _do_forward(self):
        self.session.playback.seek(self.session.playback.goal + SKIP_SECONDS)

    def _do_start(self):
        self.session.playback.seek(0)

    def _do_end(self):
        self.session.playback.seek(max(self.session.playback.duration - 1, 0))

    def open(self, text):
        """Opens a video; asks what becomes of the edits of the one before."""
        keep = dialogs.keep_edits(self) if self.session.edited and text != self.session.project.source else True
        if keep is not None:
            self.session.open(text, keep)

    def _do_open_file(self):
        path = dialogs.file_to_open(self, "Open a video or a picture")
        if path:
            self.open(path)

    def _do_open_folder(self):
        path = dialogs.folder_to_open(self, "Open the folder of a recording with depth")
        if path:
            self.open(path)

    def _do_open_uri(self):
        text = dialogs.text(self, "Open", "A URI, or a piece of a launch line that outputs video:",
                            self.session.project.source)
        if text:
            self.open(text)

    def _do_open_menu(self):
        self.header.open.set_active(True)

    def _do_split(self):
        self.session.set_split(0.5 if self.session.project.split is None else None)

    def _move_split(self, by):
        split = self.session.project.split
        self.session.set_split(0.5 if split is None else min(max(split + by, 0.0), 1.0))

    def _do_split_left(self):
        self._move_split(-SPLIT_STEP)

    def _do_split_right(self):
        self._move_split(SPLIT_STEP)

    def _do_panel(self):
        shown = not self.panel.get_visible()
        self.panel.set_visible(shown)
        self.toolbar.set_visible(shown)

    def _do_fullscreen(self):
        full = self.get_window().get_state() & Gdk.WindowState.FULLSCREEN
        self.unfullscreen() if full else self.fullscreen()

    def _do_select_previous(self):
        self.panel.select_by(-1)

    def _do_select_next(self):
        self.panel.select_by(1)

    def _editor(self):
        """The selected editor's name; None, with a note, if none is."""
        if self.panel.selected in (e.name for e in self.session.project.editors):
            return self.panel.selected
        self.note("Select an editor first: Up and Down do.")
        return None

    def _with_editor(self, do, *more):
        name = self._editor()
        if name:
            do(name, *more)

    def _do_move_up(self):
        self._with_editor(self.session.move_editor, -1)

    def _do_move_down(self):
        self._with_editor(self.session.move_editor, 1)

    def _do_switch(self):
        self._with_editor(self.session.switch_editor)

    def _do_remove(self):
        self._with_editor(self.session.remove_editor)

    def _do_settings(self):
        self.panel.focus_settings()

    def _do_another_object(self):
        if not self.tool.draws:
            self.choose_tool(tools.RECOLOR)
        self.mouse.begin_anew()
        self.update()
        self.note("Click on another object.")

    def _do_color(self):
        self.panel.open_color()

    def _scale_brush(self, factor):
        described = self.mouse.drawn_on()
        if described and "strokes::radius" in elements.properties(described.factory):
            radius = min(max(self.mouse.brush() * factor, 1.0), 1000.0)
            self.session.set_property(described.name, "strokes::radius", round(radius, 2))

    def _do_brush_larger(self):
        self._scale_brush(BRUSH_STEP)

    def _do_brush_smaller(self):
        self._scale_brush(1 / BRUSH_STEP)

    def _do_undo(self):
        label_of_it = self.session.undo()
        self.note(f"Undone: {label_of_it}" if label_of_it else "There is nothing to undo.")

    def _do_redo(self):
        label_of_it = self.session.redo()
        self.note(f"Done again: {label_of_it}" if label_of_it else "There is nothing to do again.")

    def _do_record(self):
        if self.session.recorder:
            self.session.stop_recording()
        elif self.session.start_recording(dialogs.new_path(self._folder, ".mkv")):
            waits = " once the video plays" if self.session.playback.state in (PAUSED, ENDED) else ""
            self.note(f"Recording to {self.session.recorder.path}{waits}")
        elif self.session.playback.state == CLOSED:
            self.note("Open a video first.")

    def _do_snapshot(self):
        path = dialogs.new_path(self._folder, ".png")
        if self.session.snapshot(path):
            self.note(f"Snapshot: {path}")

    def _do_save(self):
        path = dialogs.file_to_save(self, "Save the project", *self.session.project_place())
        if path and self.session.save(path):
            self.note(f"Saved {path}")

    def _do_load(self):
        path = dialogs.file_to_open(self, "Load a project")
        if path:
            self.session.load(path)

    def _do_copy_line(self):
        Gtk.Clipboard.get(Gdk.SELECTION_CLIPBOARD).set_text(self.session.launch_line(), -1)
        self.note("The launch line is in the clipboard.")

    def _do_save_line(self):
        path = dialogs.file_to_save(self, "Save the launch line", "play.sh")
        if path and self.session.save_launch_line(path):
            self.note(f"Saved {path}")

    def _do_help(self):
        self.help.set_visible(not self.help.get_visible())

    def _do_escape(self):
        if self.help.get_visible():
            self.help.hide()
        elif self.get_focus():
            self.set_focus(None)
        elif self.tool != tools.LOOK:
            self.choose_tool(tools.LOOK)
        else:
            self.info.hide()
            self.unfullscreen()

    def _do_quit(self):
        self.quit()

    # The end.
    def _on_finished(self):
        if self.exit_at_end and self.session.playback.state in (ENDED, FAILED):
            GLib.idle_add(self.quit)

    def quit(self):
        """Closes the window; a recording is complete then."""
        self.hide()
        self.session.close()
        Gtk.main_quit()
        return True
