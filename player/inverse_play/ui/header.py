# SPDX-License-Identifier: LGPL-2.1-or-later
"""The bar at the top: input, layers, and what keeps the result."""
from gi.repository import Gtk

from .. import layers, source
from . import keys
from .style import add_class

LAYER_KEYS = ("1", "2", "3", "4", "5", "6")


class Header(Gtk.HeaderBar):
    """`act`(name) does an action of keys.SHORTCUTS, `open_source`(text) opens an input."""

    def __init__(self, act, open_source, show_layer):
        super().__init__(show_close_button=True, title="inverse-play", has_subtitle=False)
        self._act, self._open_source = act, open_source
        self.open = Gtk.MenuButton(label="Open", tooltip_text="File, recording, URI, camera or test picture")
        self.open.connect("toggled", lambda b: b.get_active() and self._fill_sources())
        self.open.set_popover(Gtk.Popover())
        self.pack_start(self.open)
        self.buttons = {}
        for label, name in (("Undo", "undo"), ("Redo", "redo")):
            self._button(label, name, self.pack_start)
        self.layers, self._nicks, self._showing = {}, [nick for nick, _, _ in layers.choices()], False
        self.set_custom_title(self._layer_buttons(show_layer))
        for label, name in (("Help", "help"),):
            self._button(label, name, self.pack_end)
        self.keep = Gtk.MenuButton(label="Keep", popover=self._keep_menu(), tooltip_text="Project and launch line")
        self.pack_end(self.keep)
        for label, name in (("Record", "record"), ("Snapshot", "snapshot"), ("Split", "split")):
            self._button(label, name, self.pack_end)

    def _button(self, label, name, pack):
        self.buttons[name] = self._made(label, name)
        pack(self.buttons[name])

    def _made(self, label, name):
        key = keys.key_of(name)
        text = next((words for _, _, action, words in keys.SHORTCUTS if action == name), "")
        button = Gtk.Button(label=label, tooltip_text=f"{text.capitalize()} ({keys.words(key)})", can_focus=False)
        button.connect("clicked", lambda _: self._act(name))
        return button

    def _layer_buttons(self, show_layer):
        box = add_class(Gtk.Box(), "linked")
        first, choices = None, layers.choices()
        for place, (nick, name, meaning) in enumerate(choices[:len(LAYER_KEYS)]):
            button = Gtk.RadioButton.new_from_widget(first)
            button.set_mode(False)
            button.set_label(name)
            button.set_can_focus(False)
            button.set_tooltip_text(f"{meaning} ({LAYER_KEYS[place]})")
            button.connect("toggled", lambda b, nick=nick: b.get_active() and self._chosen(show_layer, nick))
            first = first or button
            self.layers[nick] = button
            box.add(button)
        self._more = Gtk.ComboBoxText(tooltip_text="Further layers (7)", can_focus=False)
        self._more.append("", "More")
        for nick, name, _ in choices[len(LAYER_KEYS):]:
            self._more.append(nick, name)
        self._more.set_active_id("")
        self._more.connect("changed", lambda c: c.get_active_id() and self._chosen(show_layer, c.get_active_id()))
        box.add(self._more)
        return box

    def _chosen(self, show_layer, nick):
        if not self._showing:
            show_layer(nick)

    def update(self, project, recording, shown_split):
        """Shows what is in force."""
        self._showing = True
        show = project.compose.get("show")
        if show in self.layers:
            self.layers[show].set_active(True)
        self._more.set_active_id("" if show in self.layers else show)
        for nick, button in self.layers.items():
            button.set_opacity(0.5 if layers.missing(nick, project) else 1)
        self.buttons["record"].set_label("End recording" if recording else "Record")
        style = self.buttons["record"].get_style_context()
        style.add_class("recording") if recording else style.remove_class("recording")
        style = self.buttons["split"].get_style_context()
        style.add_class("suggested-action") if shown_split else style.remove_class("suggested-action")
        self._showing = False

    def _keep_menu(self):
        return self._menu([("Save project…", "save"), ("Load project…", "load"), ("Copy launch line", "copy-line"),
                           ("Save launch line…", "save-line")])

    def _menu(self, rows):
        popover = Gtk.Popover()
        popover.add(self._menu_box(popover, [(label, lambda name=name: self._act(name)) for label, name in rows]))
        return popover

    @staticmethod
    def _menu_box(popover, rows):
        box = Gtk.Box(orientation=Gtk.Orientation.VERTICAL, margin=6)
        for label, do in rows:
            button = Gtk.ModelButton(text=label)
            button.connect("clicked", lambda _, do=do: (popover.popdown(), do()))
            box.add(button)
        box.show_all()
        return box

    def _fill_sources(self):
        popover = self.open.get_popover()
        for child in popover.get_children():
            popover.remove(child)
        popover.add(self._menu_box(popover, self.source_rows()))

    def source_rows(self):
        """(words, function) for each input that can be opened."""
        rows = [("File…", lambda: self._act("open-file")),
                ("Recording with depth…", lambda: self._act("open-folder")),
                ("URI or launch line…", lambda: self._act("open-uri"))]
        for name, text in source.cameras():
            rows.append((f"Camera: {name}", lambda text=text: self._open_source(text)))
        return rows + [("Test picture", lambda: self._open_source("test")),
                       ("Virtual room with a depth camera", lambda: self._open_source("room"))]
