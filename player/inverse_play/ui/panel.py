# SPDX-License-Identifier: LGPL-2.1-or-later
"""The side panel: the chain of elements, and the settings of the one that is selected."""
from gi.repository import GLib, Gtk, Pango

from .. import elements
from .settings import Settings
from .style import add_class, label


class Panel(Gtk.Box):
    """Shows session's project; `selected` is the name of an element. `pick`(name) picks up a color for one of its
    properties."""

    def __init__(self, session, on_select, pick):
        super().__init__(orientation=Gtk.Orientation.VERTICAL, spacing=6, width_request=310, hexpand=False)
        add_class(self, "panel")
        self._session, self._on_select, self._pick = session, on_select, pick
        self.selected, self.settings = "decomposer", None
        self._shown, self._showing = None, False
        self.pack_start(label("Chain", "heading"), False, False, 0)
        self.list = Gtk.ListBox(activate_on_single_click=True)
        self.list.connect("row-selected", self._on_row)
        self.pack_start(self._scrolled(self.list, 40, 290), False, False, 0)
        self._title = label("", "heading", ellipsize=Pango.EllipsizeMode.END)
        self._about = label("", "faint", wrap=True, max_width_chars=38)
        self.pack_start(self._title, False, False, 0)
        self.pack_start(self._about, False, False, 0)
        self._place = Gtk.Box(orientation=Gtk.Orientation.VERTICAL, spacing=6)
        self.pack_start(self._scrolled(self._place, 100, -1), True, True, 0)

    @staticmethod
    def _scrolled(child, low, high):
        scrolled = Gtk.ScrolledWindow(hscrollbar_policy=Gtk.PolicyType.NEVER, min_content_height=low)
        if high > 0:
            scrolled.set_max_content_height(high)
            scrolled.set_propagate_natural_height(True)
        scrolled.add(child)
        return scrolled

    def select(self, name):
        """Selects an element of the chain."""
        self.selected = name
        self.update()
        self._on_select()

    def select_by(self, step):
        """Selects the element before (-1) or behind (1)."""
        names = [e.name for e in self._session.project.elements()]
        self.select(names[min(max(names.index(self.selected) + step, 0), len(names) - 1)])

    def update(self):
        """Shows the project as it is now."""
        project = self._session.project
        if not project.element(self.selected):
            self.selected = project.editors[-1].name if project.editors else "decomposer"
        self._update_list(project)
        self._update_settings(project.element(self.selected))

    def _update_list(self, project):
        shown = [(e.name, e.factory, e.on) for e in project.elements()]
        self._showing = True
        if shown != self._shown:
            for row in self.list.get_children():
                self.list.remove(row)
            for described in project.elements():
                self.list.add(self._row(described))
            self.list.show_all()
            self._shown = shown
        names = [name for name, _, _ in shown]
        self.list.select_row(self.list.get_row_at_index(names.index(self.selected)))
        self._showing = False

    def _row(self, described):
        box = Gtk.Box(spacing=4, margin=3)
        is_editor = described.name not in ("decomposer", "compose")
        title = "Picture" if described.name == "compose" else elements.title(described.factory)
        name = label(title, tooltip_text=elements.description(described.factory), ellipsize=Pango.EllipsizeMode.END)
        if is_editor:
            switch = Gtk.CheckButton(active=described.on, tooltip_text="Switch off or on (O)")
            switch.connect("toggled", lambda _: GLib.idle_add(self._session.switch_editor, described.name))
            box.pack_start(switch, False, False, 0)
        box.pack_start(name, True, True, 0)
        if is_editor:
            for text, hint, act in (("▲", "Earlier (Alt+Up)", lambda n: self._session.move_editor(n, -1)),
                                    ("▼", "Later (Alt+Down)", lambda n: self._session.move_editor(n, 1)),
                                    ("✕", "Remove (Delete)", self._session.remove_editor)):
                button = Gtk.Button(label=text, tooltip_text=hint, relief=Gtk.ReliefStyle.NONE)
                button.connect("clicked", lambda _, act=act: GLib.idle_add(act, described.name))
                box.pack_start(button, False, False, 0)
        row = Gtk.ListBoxRow()
        row.add(box)
        row.name = described.name
        return row

    def _on_row(self, _list, row):
        if row and not self._showing and row.name != self.selected:
            GLib.idle_add(self.select, row.name)

    def _update_settings(self, described):
        shown = self.settings.described if self.settings else None
        if shown and (shown.name, shown.factory) == (described.name, described.factory):
            self.settings.show_values(described)
            self._update_strokes(described)
            return
        for child in self._place.get_children():
            child.destroy()
        self._title.set_text(elements.title(described.factory))
        self._about.set_text(elements.description(described.factory))
        if described.name == "decomposer":
            self._place.add(self._decomposer_choice(described))
        is_editor = described.factory in elements.editors()
        self.settings = Settings(described, lambda values, what:
                                 self._session.set_properties(described.name, values, what),
                                 self._pick if is_editor else None)
        self._clear = None
        if "strokes::list" in elements.properties(described.factory):
            self._clear = Gtk.Button(label="Clear strokes", halign=Gtk.Align.START)
            self._clear.connect("clicked", lambda _: self._session.set_property(described.name, "strokes::list", ""))
            self._place.add(self._clear)
        self._place.add(self.settings)
        self._place.show_all()
        self._update_strokes(described)

    def _update_strokes(self, described):
        if self._clear:
            self._clear.set_sensitive(described.get("strokes::list") != "")

    def _decomposer_choice(self, described):
        combo = Gtk.ComboBoxText(tooltip_text="The element that separates reflectance and light")
        for factory in elements.decomposers():
            combo.append(factory, factory)
        combo.set_active_id(described.factory)
        combo.connect("changed", lambda c: GLib.idle_add(self._session.set_decomposer, c.get_active_id()))
        return combo

    def focus_settings(self):
        """Moves the keyboard to the first control."""
        if self.settings:
            self.settings.child_focus(Gtk.DirectionType.TAB_FORWARD)

    def open_color(self):
        """Opens the choice of the editor's color: its target if it has one."""
        name = self.settings.first_color() if self.settings else None
        if name:
            self.settings.controls[name].set_active(True)
