# SPDX-License-Identifier: LGPL-2.1-or-later
"""The column at the left: tools of the mouse, and editors to add."""
from gi.repository import Gtk

from .. import tools
from .keys import button_content
from .style import add_class, label


class Toolbar(Gtk.ScrolledWindow):
    """`choose`(Tool), `add`(factory) and `begin_anew`() are called for what is pressed. `scene`: SceneTools."""

    def __init__(self, project, choose, add, begin_anew, scene):
        super().__init__(hscrollbar_policy=Gtk.PolicyType.NEVER)
        column = add_class(Gtk.Box(orientation=Gtk.Orientation.VERTICAL, spacing=2, width_request=150), "panel")
        self.add(add_class(column, "tools"))
        self._choose, self._showing = choose, False
        self._box = Gtk.Box(orientation=Gtk.Orientation.VERTICAL, spacing=2)
        self.tools, self.buttons, self.adders = [], {}, {}
        column.add(label("Tools", "heading"))
        column.add(self._box)
        self.another = Gtk.Button(tooltip_text="The next click selects another object", can_focus=False)
        self.another.add(button_content("Another object", "n"))
        self.another.connect("clicked", lambda _: begin_anew())
        column.add(self.another)
        column.add(scene)
        column.add(label("Add an editor", "heading"))
        for factory, title, key, meaning in tools.editors():
            button = Gtk.Button(tooltip_text=meaning, can_focus=False)
            button.add(button_content(title, key))
            button.connect("clicked", lambda _, factory=factory: add(factory))
            self.adders[factory] = button
            column.add(button)
        self.update(project, tools.LOOK)

    def update(self, project, active):
        """Offers the tools of the project's elements."""
        offered = tools.offered(project)
        self._showing = True
        if offered != self.tools:
            self._fill(offered)
        self.another.set_sensitive(bool(active.draws))
        if active.name in self.buttons:
            self.buttons[active.name].set_active(True)
        self._showing = False

    def _fill(self, offered):
        for child in self._box.get_children():
            child.destroy()
        self.tools, self.buttons, first = offered, {}, None
        for tool in offered:
            button = Gtk.RadioButton.new_from_widget(first)
            button.set_mode(False)
            button.set_can_focus(False)
            button.set_tooltip_text(tool.hint)
            button.add(button_content(tool.label, tool.key))
            button.connect("toggled", lambda b, tool=tool: b.get_active() and self._chosen(tool))
            first = first or button
            self.buttons[tool.name] = button
            self._box.add(button)
        self._box.show_all()

    def _chosen(self, tool):
        if not self._showing:
            self._choose(tool)
