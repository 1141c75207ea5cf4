# SPDX-License-Identifier: LGPL-2.1-or-later
"""A window on a display without a screen, with a real mouse and keyboard: what its tests share."""
import os
import subprocess
import unittest

import support

DISPLAY = support.Display()
unittest.addModuleCleanup(DISPLAY.close)
Gtk = support.need_gtk()
from gi.repository import Gdk, GdkX11, GLib  # noqa: E402, F401  (GdkX11 has get_xid)
from inverse_play.project import Project  # noqa: E402
from inverse_play.session import Session  # noqa: E402
from inverse_play.ui import style  # noqa: E402
from inverse_play.ui.window import Window  # noqa: E402

style.apply()
RED, CYAN, YELLOW = (500, 100), (230, 100), (140, 100)  # bars of the test picture of 640 x 480 pixels


def pixel(x, y):
    """A pixel of the display."""
    picture = Gdk.pixbuf_get_from_window(Gdk.get_default_root_window(), x, y, 1, 1)
    return tuple(picture.get_pixels()[:3])


def screenshot(path):
    """Writes what the display shows."""
    root = Gdk.get_default_root_window()
    Gdk.pixbuf_get_from_window(root, 0, 0, root.get_width(), root.get_height()).savev(path, "png", [], [])


def is_blue(color):
    return color[2] > color[0] + 60


def is_near(color, other):
    return max(abs(a - b) for a, b in zip(color, other)) < 16


def is_green(color):
    return color[1] > color[0] + 60 and color[1] > color[2] + 60


TEST = "videotestsrc is-live=true ! video/x-raw,width=640,height=480,framerate=15/1"


class WindowCase(support.Case):
    """A window that plays the test picture."""

    def setUp(self):
        super().setUp()
        self.window = Window(lambda first, second: Session(first, second, Project()), self.folder)
        self.window.show()
        self.session, self.player = self.window.session, self.window.session.playback
        self.focus()
        self.open(TEST, 640)
        self.addCleanup(self.end)

    def focus(self):
        """Gives the window the keyboard, as a window manager would."""
        focus = ["xdotool", "mousemove", "700", "850", "windowfocus", str(self.window.get_window().get_xid())]
        self.wait(lambda: subprocess.run(focus, stderr=subprocess.DEVNULL, check=False).returncode == 0)
        self.wait(self.window.has_toplevel_focus)

    def open(self, text, width):
        self.session.open(text)
        self.wait(lambda: self.player.width == width)

    def end(self):
        self.session.close()
        self.window.destroy()
        support.pump(0.1)

    def wait(self, until, seconds=support.LIMIT):
        """Runs until something is true; else it fails with a screenshot."""
        if not support.pump(seconds, until):
            path = os.path.join(os.environ.get("INVERSE_SCREENSHOTS", "/tmp"), f"inverse-play-{self.id()}.png")
            screenshot(path)
            self.fail(f"waited in vain; the display is in {path}; {self.details()}")

    def wait_for_note(self, text):
        """Runs until the line at the bottom of the picture says that."""
        self.wait(lambda: text in self.window._info_text.get_text())

    def details(self):
        """What may say why something did not happen."""
        return f"{self.session.project}, {self.session.troubles}, {self.window._info_text.get_text()}"

    def xdotool(self, *words):
        """Real events; runs the window until it has answered them."""
        process = subprocess.Popen(["xdotool", *map(str, words)])
        self.wait(lambda: process.poll() is not None)
        self.assertEqual(process.returncode, 0, words)
        self.settle()

    def settle(self):
        """Runs the window until it has done what all events call for, and has laid itself out and painted itself."""
        Gdk.Display.get_default().sync()  # all events are here
        support.pump(0)
        painted, clock = [], self.window.get_frame_clock()
        handler = clock.connect("after-paint", lambda _: painted.append(True))
        clock.request_phase(Gdk.FrameClockPhase.AFTER_PAINT)
        self.wait(lambda: painted)
        clock.disconnect(handler)

    def key(self, *names):
        for name in names:
            self.xdotool("key", name)

    def on_display(self, x, y):
        """Where a pixel of the frame is on the display."""
        picture, frame = self.window.picture, (self.player.width, self.player.height)
        area, (_, left, top) = picture.get_allocation(), picture.get_window().get_origin()
        scale = min(area.width / frame[0], area.height / frame[1])
        return (round(left + area.x + (area.width - scale * frame[0]) / 2 + (x + 0.5) * scale),
                round(top + area.y + (area.height - scale * frame[1]) / 2 + (y + 0.5) * scale))

    def click(self, x, y, held=None):
        """Clicks on a pixel of the frame, while a key may be held."""
        hold = (["keydown", held], ["keyup", held]) if held else ([], [])
        self.xdotool("mousemove", *self.on_display(x, y), *hold[0], "click", 1, *hold[1])

    def drag(self, *places):
        """Drags over pixels of the frame."""
        self.xdotool("mousemove", *self.on_display(*places[0]), "mousedown", 1)
        for place in places[1:]:
            self.xdotool("mousemove", *self.on_display(*place))
        self.xdotool("mouseup", 1)

    def click_widget(self, widget):
        """Clicks on a widget where it stays: what opens beside it may move it."""
        self.wait(widget.get_mapped)
        own, place, at = not widget.get_has_window(), None, ()
        while place != at:
            area, (_, left, top) = widget.get_allocation(), widget.get_window().get_origin()
            place, at = at, (left + (area.x if own else 0) + area.width // 2, top + (area.y if own else 0) + area.height // 2)
            self.xdotool("mousemove", *at)
        self.xdotool("click", 1)

    def shown(self, at):
        """A pixel of the frame as the display shows it."""
        return pixel(*self.on_display(*at))

    def beside(self, at):
        """One that no mark of a click or a brush covers."""
        return self.shown((at[0] + 9, at[1] + 9))

    @property
    def editors(self):
        return [(e.factory, e.on) for e in self.session.project.editors]

    def in_dialog(self, title, key, path):
        """Opens a dialog by a key or a button, and sets its path (letters are lost while a folder is listed), or without
        one presses Escape."""
        ended = []
        steps = self.dialog_steps(title, path, ended)
        GLib.timeout_add(50, lambda: next(steps, None) is not None)
        # The dialog waits in a loop of its own.
        self.click_widget(key) if isinstance(key, Gtk.Widget) else self.key(key)
        self.wait(lambda: ended)
        self.assertEqual(ended, [path], f"'{title}' has another path")
        self.focus()

    def answer(self, words, response, ask):
        """Does what asks a question with these words, and answers it."""
        asked = []

        def step():
            for window in Gtk.Window.list_toplevels():
                if isinstance(window, Gtk.MessageDialog) and window.get_mapped() and words in window.props.text:
                    asked.append(True)
                    window.response(response)
            return not asked
        GLib.timeout_add(50, step)
        ask()
        self.assertTrue(asked, f"there was no question: {words}")

    @staticmethod
    def dialog_steps(title, path, ended):
        """What is done while a dialog is open, in steps of 50 ms; then `ended` gets the path that it has."""
        dialog = None
        while not dialog:
            dialog = next((w for w in Gtk.Window.list_toplevels() if w.get_title() == title and w.get_mapped()), None)
            yield True
        if path:
            if dialog.get_action() == Gtk.FileChooserAction.SAVE:  # set_filename() names files that exist only
                dialog.set_current_folder(os.path.dirname(path))
                dialog.set_current_name(os.path.basename(path))
            else:
                dialog.set_filename(path)
            yield from (True for _ in range(20 * support.LIMIT) if dialog.get_filename() != path)
            ended.append(dialog.get_filename())
            dialog.response(Gtk.ResponseType.OK if ended == [path] else Gtk.ResponseType.CANCEL)
            return
        for words in (["windowfocus", "--sync", dialog.get_window().get_xid()], ["key", "Escape"]):
            process = subprocess.Popen(["xdotool", *map(str, words)])
            while process.poll() is None:
                yield True
        yield from (True for _ in range(20 * support.LIMIT) if dialog.get_mapped())
        ended.append(None)
        if dialog.get_mapped():
            dialog.response(Gtk.ResponseType.CANCEL)
