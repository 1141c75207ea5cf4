# SPDX-License-Identifier: LGPL-2.1-or-later
"""The window's look: dark and neutral, so that colors of the picture are judged well."""
from gi.repository import Gdk, Gtk

CSS = b"""
window, headerbar, .panel, popover, popover.background { background: #2b2b2b; color: #dedede; }
headerbar { border-bottom: 1px solid #1c1c1c; min-height: 40px; box-shadow: none; }
.picture { background: #161616; }
.panel { padding: 8px; }
.heading { color: #9a9a9a; font-size: 90%; font-weight: bold; margin-top: 6px; }
.key, .faint { color: #8c8c8c; font-size: 85%; }
.help { background: rgba(24, 24, 24, 0.94); border-radius: 8px; padding: 24px; color: #e6e6e6; }
.divider { background: rgba(255, 255, 255, 0.85); }
.tag { background: rgba(20, 20, 20, 0.7); color: #e6e6e6; padding: 2px 8px; border-radius: 4px; }
button { padding: 3px 8px; }
.tools button { padding: 1px 8px; min-height: 20px; }
.tools .linked button { padding: 1px 2px; }
button.recording { background: #a02020; color: #ffffff; }
list, list row { background: #232323; }
list row:selected { background: #3d4a5c; }
"""


def apply():
    """Uses the look for all windows of the program."""
    Gtk.Settings.get_default().set_property("gtk-application-prefer-dark-theme", True)
    provider = Gtk.CssProvider()
    provider.load_from_data(CSS)
    Gtk.StyleContext.add_provider_for_screen(Gdk.Screen.get_default(), provider,
                                             Gtk.STYLE_PROVIDER_PRIORITY_APPLICATION)


def add_class(widget, name):
    """The widget, with a class of the style sheet."""
    widget.get_style_context().add_class(name)
    return widget


def label(text, name=None, **properties):
    """A label that starts at the left."""
    made = Gtk.Label(label=text, xalign=0, **properties)
    return add_class(made, name) if name else made
