# SPDX-License-Identifier: LGPL-2.1-or-later
"""The program inverse-play."""
import sys

from gi.repository import GLib, Gst
from inverse_common import media

from . import arguments, elements, launch_line, source
from .messages import Trouble


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


def _begin(window, made, options, demands):
    if not window.session.may_open(options.project, demands):
        window.session.troubles.append(Trouble(f"{options.project} was not opened."))
        window.quit()
        return GLib.SOURCE_REMOVE
    if made.source:
        window.session.open(made.source)
    if not options.close_at_end:
        window.offer_unsaved()
    return GLib.SOURCE_REMOVE


def _show(made, options, demands):
    gtk = _gtk()
    from .session import Session
    from .ui import style
    from .ui.window import Window
    style.apply()
    window = Window(lambda sink, second: Session(sink, second, made), options.folder)
    window.exit_at_end = options.close_at_end
    window.session.record_at_start, window.session.overwrite = options.record, options.overwrite
    for signal in (2, 15):  # Ctrl-C, kill
        GLib.unix_signal_add(GLib.PRIORITY_DEFAULT, signal, window.quit)
    window.show()
    GLib.idle_add(_begin, window, made, options, demands)
    gtk.main()
    for trouble in window.session.troubles:
        print(f"inverse-play: {trouble.text} {trouble.advice}".rstrip(), file=sys.stderr)
    return 1 if window.session.troubles else 0


def main():
    """Runs the program; returns its exit status."""
    Gst.init(None)
    media.prefer_decoders()
    options = arguments.parser().parse_args()
    try:
        made, demands = arguments.project_of(options), arguments.demands_of(options)
        if options.launch_line:
            if not made.source:
                fail("--launch-line needs a SOURCE", 2)
            print(launch_line.shell_text(made))
            return 0
    except (elements.ElementError, source.SourceError, OSError) as error:
        fail(error)
    return _show(made, options, demands)


if __name__ == "__main__":
    sys.exit(main())
