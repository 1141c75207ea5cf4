# SPDX-License-Identifier: LGPL-2.1-or-later
"""The program inverse-play."""
import sys

from gi.repository import GLib, Gst

from . import arguments, elements, launch_line, source


def fail(text, status=1):
    """Ends the program with a message."""
    print(f"inverse-play: {text}", file=sys.stderr)
    sys.exit(status)


def _gtk():
    """The module Gtk, where a window can be shown."""
    import gi
    try:
        gi.require_version("Gtk", "3.0")
        from gi.repository import Gtk
    except (ImportError, ValueError):
        fail("GTK 3 is missing; install gir1.2-gtk-3.0, python3-gi-cairo and gstreamer1.0-gtk3")
    if not Gst.ElementFactory.find("gtksink"):
        fail("gtksink is missing; install gstreamer1.0-gtk3")
    if not Gtk.init_check(None)[0]:
        fail("no window can be shown: neither DISPLAY nor WAYLAND_DISPLAY names a display that answers")
    return Gtk


def _show(made, options):
    gtk = _gtk()
    from .session import Session
    from .ui import style
    from .ui.window import Window
    style.apply()
    window = Window(lambda sink, second: Session(sink, second, made), options.folder)
    window.exit_at_end = options.close_at_end
    window.session.record_at_start = options.record
    for signal in (2, 15):  # Ctrl-C, kill
        GLib.unix_signal_add(GLib.PRIORITY_DEFAULT, signal, window.quit)
    window.show()
    if made.source:
        GLib.idle_add(lambda: window.session.open(made.source))
    gtk.main()
    for trouble in window.session.troubles:
        print(f"inverse-play: {trouble.text} {trouble.advice}".rstrip(), file=sys.stderr)
    return 1 if window.session.troubles else 0


def main():
    """Runs the program; returns its exit status."""
    Gst.init(None)
    options = arguments.parser().parse_args()
    try:
        made = arguments.project_of(options)
        if options.launch_line:
            if not made.source:
                fail("--launch-line needs a SOURCE", 2)
            print(launch_line.shell_text(made))
            return 0
    except (elements.ElementError, source.SourceError, OSError) as error:
        fail(error)
    return _show(made, options)


if __name__ == "__main__":
    sys.exit(main())
