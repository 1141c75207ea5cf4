# SPDX-License-Identifier: LGPL-2.1-or-later
"""A panel for any element, made from its properties."""
import collections

from gi.repository import Gdk, GObject, Gst, Gtk

from .. import elements, intros
from .style import label

WIDE_RANGE = 30  # above it a number has a box instead of a slider
SWATCHES = ("0xffc03028", "0xffd07820", "0xffd8c030", "0xff40a040", "0xff30a0a0", "0xff2864c8", "0xff7040b0",
            "0xffc04090", "0xfff0f0f0", "0xff909090", "0xff303030", "0xff7a4a28")


def rgba(color):
    """A Gdk.RGBA of 0xAARRGGBB, without alpha."""
    value = int(color, 0)
    return Gdk.RGBA((value >> 16 & 255) / 255, (value >> 8 & 255) / 255, (value & 255) / 255, 1)


def color_text(color):
    """0xffRRGGBB of a Gdk.RGBA."""
    red, green, blue = (round(255 * c) for c in (color.red, color.green, color.blue))
    return f"0xff{red:02x}{green:02x}{blue:02x}"


class ColorControl(Gtk.MenuButton):
    """A button in a color, with swatches and a free choice behind it."""

    def __init__(self, changed):
        super().__init__(hexpand=True, focus_on_click=False)
        self.show_color = Gtk.DrawingArea(width_request=60, height_request=16)
        self.add(self.show_color)
        self.show_color.connect("draw", self._draw)
        self._color, self._changed = rgba("0xff000000"), changed
        self.swatches = [self._swatch(text) for text in SWATCHES]
        self.set_popover(self._popover())

    def _popover(self):
        grid = Gtk.Grid(row_spacing=4, column_spacing=4, margin=8)
        for place, swatch in enumerate(self.swatches):
            grid.attach(swatch, place % 6, place // 6, 1, 1)
        other = Gtk.Button(label="Other color…")
        other.connect("clicked", self._choose)
        grid.attach(other, 0, 2, 6, 1)
        grid.show_all()
        popover = Gtk.Popover()
        popover.add(grid)
        return popover

    def _swatch(self, text):
        button = Gtk.Button(tooltip_text=text)
        area = Gtk.DrawingArea(width_request=28, height_request=28)
        area.connect("draw", lambda widget, context: _fill(widget, context, rgba(text)))
        button.add(area)
        button.connect("clicked", lambda _: self._take(text))
        return button

    def _take(self, text):
        self.set_value(text)
        self._changed(text)
        self.get_popover().popdown()

    def _choose(self, _button):
        dialog = Gtk.ColorChooserDialog(title="Color", transient_for=self.get_toplevel(), use_alpha=False,
                                        show_editor=True)
        dialog.set_rgba(self._color)
        dialog.connect("notify::rgba", lambda d, _: self._changed(color_text(d.get_rgba())))
        before = color_text(self._color)
        if dialog.run() != Gtk.ResponseType.OK:
            self._changed(before)
        dialog.destroy()

    def _draw(self, widget, context):
        return _fill(widget, context, self._color)

    def set_value(self, text):
        """Shows a color."""
        self._color = rgba(text)
        self.show_color.queue_draw()


def _fill(widget, context, color):
    area = widget.get_allocation()
    Gdk.cairo_set_source_rgba(context, color)
    context.rectangle(0, 0, area.width, area.height)
    context.fill()
    return False


def _bool_control(_described, changed):
    control = Gtk.Switch(halign=Gtk.Align.START)
    control.connect("notify::active", lambda c, _: changed(c.get_active()))
    control.set_value = control.set_active
    return control


def _enum_control(described, changed):
    control = Gtk.ComboBoxText(hexpand=True)
    for nick, _ in described.choices:
        control.append(nick, nick)
    control.connect("changed", lambda c: changed(c.get_active_id()))
    meanings = "\n".join(f"{nick}: {meaning}" for nick, meaning in described.choices)
    control.set_tooltip_text(f"{described.blurb}\n{meanings}")
    control.set_value = control.set_active_id
    return control


class ChoiceButtons(Gtk.Grid):
    """A button for each choice of a property."""

    def __init__(self, described, changed):
        super().__init__(hexpand=True, column_homogeneous=True)
        first, self.buttons = None, {}
        for place, (nick, meaning) in enumerate(described.choices):
            button = Gtk.RadioButton.new_with_label_from_widget(first, nick)
            button.set_mode(False)
            button.set_focus_on_click(False)  # the keys go on to work
            button.set_tooltip_text(meaning)
            button.connect("toggled", lambda b, nick=nick: b.get_active() and changed(nick))
            first = first or button
            self.buttons[nick] = button
            self.attach(button, place % BUTTON_COLUMNS, place // BUTTON_COLUMNS, 1, 1)

    def set_value(self, nick):
        """Shows a choice."""
        self.buttons[nick].set_active(True)


def _number_control(described, changed):
    span = described.maximum - described.minimum
    whole = described.kind == "int"
    step = 1 if whole else 0.01 if span <= 5 else 0.1
    adjustment = Gtk.Adjustment(lower=described.minimum, upper=described.maximum, step_increment=step,
                                page_increment=10 * step)
    digits = 0 if whole else 3 if 0 < described.minimum < 0.01 else 2
    if span > WIDE_RANGE:
        control = Gtk.SpinButton(adjustment=adjustment, digits=digits, hexpand=True, width_chars=7)
    else:
        control = Gtk.Scale(adjustment=adjustment, digits=digits, hexpand=True, value_pos=Gtk.PositionType.RIGHT)
        control.connect("scroll-event", lambda c, _: GObject.signal_stop_emission_by_name(c, "scroll-event"))
    adjustment.connect("value-changed", lambda a: changed(int(a.get_value()) if whole else
                                                          elements.rounded(a.get_value())))
    control.set_value = adjustment.set_value
    return control


def _text_control(_described, changed):
    control = Gtk.Entry(hexpand=True, width_chars=8)
    control.connect("activate", lambda c: changed(c.get_text()))
    control.connect("focus-out-event", lambda c, _: changed(c.get_text()))
    control.set_value = control.set_text
    return control


def _file_control(described, changed):
    control = Gtk.FileChooserButton(title=described.blurb, hexpand=True)
    control.connect("file-set", lambda c: changed(c.get_filename() or ""))
    control.set_value = lambda path: control.set_filename(path) if path else control.unselect_all()
    return control


CONTROLS = {"bool": _bool_control, "enum": _enum_control, "int": _number_control, "float": _number_control,
            "text": _text_control, "file": _file_control, "color": lambda _, changed: ColorControl(changed)}
HIDDEN = {"show", "strokes::list", "strokes::mode", "lamp-mode", "pick"}  # by layer buttons, by the mouse, by tools
BUTTONS = {"look", "style"}  # choices that are tried one after the other
BUTTON_COLUMNS = 3
FIRST = BUTTONS | {"target"}
SETTINGS, MORE = "settings", "more"
GROUP = 3  # settings of a child object, or whose names begin with the same word, have a heading of their own


def _place(prop):
    """What is changed most often comes first, what makes the element anew last; the rest as the element has it."""
    return 0 if prop.name in FIRST or prop.name.startswith("strokes::") else 1 if prop.live else 2


def _word(name):
    """The word that a heading may have: that of the child object, or the first one."""
    return name.partition("::" if "::" in name else "-")[0]


def _groups(factory):
    """(heading, properties) of an element, in the order in which they are shown; the last ones are changed rarely."""
    shown = sorted((p for p in elements.properties(factory).values() if p.name not in HIDDEN), key=_place)
    words = collections.Counter(_word(p.name) for p in shown)
    found = {word: [] for word in words if words[word] >= GROUP}
    found.update({SETTINGS: [], MORE: []})
    for prop in shown:
        word = _word(prop.name)
        rare = intros.is_rare(factory, prop.name) and _place(prop) > 0
        found[word if word in found else MORE if rare else SETTINGS].append(prop)
    return [(heading, props) for heading, props in found.items() if props]


class Settings(Gtk.Grid):
    """Controls for the properties of an element of the project. `changed(values, what)` sets some, by name;
    `pick`(name) lets the mouse pick up a color for one, None without."""

    def __init__(self, described, changed, pick):
        super().__init__(row_spacing=4, column_spacing=8)
        self.described, self._changed, self._pick, self._showing = described, changed, pick, False
        self.controls, self.picks, self.more = {}, {}, None
        self._names = Gtk.SizeGroup(mode=Gtk.SizeGroupMode.HORIZONTAL)
        self._add_presets(described.factory)
        for place, (heading, props) in enumerate(_groups(described.factory)):
            self._add_group("" if place == 0 and heading == SETTINGS else heading, props)
        self.show_values(described)
        self.show_all()

    def _add_group(self, heading, props):
        rows = self
        if heading == MORE:
            rows = Gtk.Grid(row_spacing=4, column_spacing=8, margin_top=4)
            self.more = Gtk.Expander(label="More", tooltip_text="Settings that are changed rarely",
                                     expanded=any(p.name in self.described.properties for p in props))
            self.more.add(rows)
            self.attach_next_to(self.more, None, Gtk.PositionType.BOTTOM, 2, 1)
        elif heading:
            self.attach_next_to(label(heading.capitalize(), "heading"), None, Gtk.PositionType.BOTTOM, 2, 1)
        for prop in props:
            self._add_row(prop, rows)
        if heading == MORE:
            # A child that was never expanded would take the keyboard.
            rows.show_all()
            rows.set_no_show_all(True)
            self.more.bind_property("expanded", rows, "visible", GObject.BindingFlags.SYNC_CREATE)

    def _add_row(self, prop, rows):
        make = ChoiceButtons if prop.name in BUTTONS and prop.kind == "enum" else CONTROLS[prop.kind]
        control = make(prop, lambda value, name=prop.name: self._on_changed(name, value))
        if not control.get_tooltip_text():
            control.set_tooltip_text(prop.blurb)
        name = label(prop.name.rpartition("::")[2].replace("-", " "), tooltip_text=prop.blurb)
        self.controls[prop.name] = control
        picks = prop.kind == "color" and self._pick
        self._attach(rows, name, self._with_pick(prop.name, control) if picks else control)

    def _with_pick(self, name, control):
        """A color's control, with a button that picks one up from the picture."""
        box = Gtk.Box(hexpand=True, spacing=4)
        self.picks[name] = Gtk.Button(label="Pick up", tooltip_text="Then click on that color in the picture",
                                      focus_on_click=False)
        self.picks[name].connect("clicked", lambda _: self._pick(name))
        box.pack_start(control, True, True, 0)
        box.pack_start(self.picks[name], False, False, 0)
        return box

    def first_color(self):
        """The name of the color that matters most: the target if there is one; None without any."""
        names = [n for n, c in self.controls.items() if isinstance(c, ColorControl)]
        return "target" if "target" in names else names[-1] if names else None

    def _attach(self, rows, name, control):
        self._names.add_widget(name)
        rows.attach_next_to(name, None, Gtk.PositionType.BOTTOM, 1, 1)
        rows.attach_next_to(control, name, Gtk.PositionType.RIGHT, 1, 1)

    def _add_presets(self, factory):
        """The presets that are installed for the element."""
        element = elements.make(factory, None)
        names = element.get_preset_names() if isinstance(element, Gst.Preset) else []
        if not names:
            return
        combo = Gtk.ComboBoxText(hexpand=True, tooltip_text="Settings that were stored under a name")
        for name in names:
            combo.append(name, name)
        combo.connect("changed", lambda c: self._load_preset(element, c.get_active_id()))
        self._attach(self, label("preset"), combo)

    def _load_preset(self, element, name):
        for prop in self.controls:  # what the preset does not name stays
            elements.write(element, prop, self.described.get(prop))
        if name and element.load_preset(name):
            self._changed({prop: elements.read(element, prop) for prop in self.controls}, f"preset {name}")

    def _on_changed(self, name, value):
        if not self._showing and value is not None and value != self.described.get(name):
            self._changed({name: value}, name)

    def show_values(self, described):
        """Shows the element's values."""
        before, self.described, self._showing = self.described, described, True
        for name, control in self.controls.items():
            if before is described or before.get(name) != described.get(name):
                control.set_value(described.get(name))
        self._showing = False
