# SPDX-License-Identifier: LGPL-2.1-or-later
"""The window, with a real mouse and keyboard on a display without a screen."""
import json
import os
import re
import subprocess
import unittest

import support

DISPLAY = support.Display()
unittest.addModuleCleanup(DISPLAY.close)
Gtk = support.need_gtk()
from gi.repository import Gdk, GdkX11, GLib  # noqa: E402, F401  (GdkX11 has get_xid)
from inverse_play import playback  # noqa: E402
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
        support.pump(0.1)

    def open(self, text, width):
        self.session.open(text)
        self.wait(lambda: self.player.width == width)

    def end(self):
        self.session.close()
        self.window.destroy()
        support.pump(0.1)

    def wait(self, until, seconds=20):
        """Runs until something is true; else it fails with a screenshot."""
        if not support.pump(seconds, until):
            path = os.path.join(os.environ.get("INVERSE_SCREENSHOTS", "/tmp"), f"inverse-play-{self.id()}.png")
            screenshot(path)
            self.fail(f"waited in vain; the display is in {path}; {self.session.project}, {self.session.troubles}, "
                      f"{self.window._info_text.get_text()}")

    @staticmethod
    def xdotool(*words):
        """Real events; runs the window meanwhile."""
        process = subprocess.Popen(["xdotool", *map(str, words)])
        support.pump(10, lambda: process.poll() is not None)
        support.pump(0.1)

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
        self.wait(widget.get_mapped)
        area, (_, left, top) = widget.get_allocation(), widget.get_window().get_origin()
        own = not widget.get_has_window()
        self.xdotool("mousemove", left + (area.x if own else 0) + area.width // 2,
                     top + (area.y if own else 0) + area.height // 2, "click", 1)

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
        """Opens a dialog by a key. One for a file to save gets its path and Return. One for a file to open gets no
        letters, which it loses while it lists a folder: the path is set, or without one Escape pressed."""
        steps = self.dialog_steps(title, path)
        GLib.timeout_add(50, lambda: next(steps, None) is not None)
        self.key(key)  # the dialog waits in a loop of its own
        self.focus()

    @staticmethod
    def dialog_steps(title, path):
        """What is done while a dialog is open, in steps of 50 ms."""
        dialog = None
        while not dialog:
            dialog = next((w for w in Gtk.Window.list_toplevels() if w.get_title() == title and w.get_mapped()), None)
            yield True
        saves = dialog.get_action() == Gtk.FileChooserAction.SAVE
        if path and not saves:
            dialog.set_filename(path)
            while dialog.get_filename() != path:
                yield True
            dialog.response(Gtk.ResponseType.OK)
            return
        typed = (["key", "Home", "shift+End"], ["type", "--delay", 40, path], ["key", "Return"]) if saves else ()
        for words in (["windowfocus", "--sync", dialog.get_window().get_xid()], *(typed or (["key", "Escape"],))):
            process = subprocess.Popen(["xdotool", *map(str, words)])
            while process.poll() is None:
                yield True
            yield from (True for _ in range(10) if dialog.get_mapped())
        yield from (True for _ in range(100) if dialog.get_mapped())
        if dialog.get_mapped():
            dialog.response(Gtk.ResponseType.CANCEL)


class Paint(WindowCase):
    def test_an_object_is_painted_by_key_click_and_color(self):
        self.wait(lambda: self.shown(RED)[0] > 150)
        self.key("r")
        self.click(*RED)
        self.wait(lambda: self.editors == [("intrinsicselect", True), ("intrinsicrecolor", True)])
        self.wait(lambda: is_blue(self.shown(RED)))  # the color that it begins with
        self.key("b")
        self.click_widget(self.window.panel.settings.controls["target"].swatches[3])
        self.wait(lambda: is_green(self.shown(RED)))
        self.assertEqual(self.shown(CYAN)[1:], (255, 255))  # the rest stays
        self.key("ctrl+z", "ctrl+z")
        self.wait(lambda: self.editors == [] and self.shown(RED)[0] > 150)
        self.key("ctrl+shift+z", "ctrl+shift+z")
        self.wait(lambda: is_green(self.shown(RED)))

    def test_buttons_do_the_same(self):
        self.click_widget(self.window.toolbar.buttons["recolor"])
        self.click(*RED)
        self.wait(lambda: self.editors)
        self.click_widget(self.window.header.layers["difference"])
        self.wait(lambda: self.session.project.compose.get("show") == "difference")
        self.click_widget(self.window.header.buttons["undo"])
        self.wait(lambda: self.session.project.compose.get("show") == "composed")
        self.click_widget(self.window.toolbar.adders["intrinsictone"])
        self.wait(lambda: len(self.editors) == 3)

    def test_one_ball_of_the_clip(self):
        ball, book, ring, drawn = (385, 303), (99, 324), (285, 386), {}
        self.open(str(support.CLIP), 640)
        self.wait(lambda: self.player.seekable)
        self.session.toggle_playing()
        self.player.seek(2)
        self.wait(lambda: abs(self.player.position - 2) < 0.05 and self.beside(ball)[0] > 150)
        for place in (book, ring):
            drawn[place] = self.beside(place)
        self.key("r")
        self.click(*ball)
        self.wait(lambda: is_blue(self.beside(ball)))
        for x, y in ((364, 303), (400, 303), (385, 285)):
            self.assertTrue(is_blue(self.shown((x, y))), f"{x},{y}")
        for place, before in drawn.items():  # the red book is not painted
            self.assertTrue(is_near(self.beside(place), before), place)
        self.click(*ring)  # adds to it
        self.wait(lambda: is_blue(self.beside(ring)) and is_blue(self.beside(ball)))
        self.click(*ring, held="shift")
        self.wait(lambda: is_near(self.beside(ring), drawn[ring]) and is_blue(self.beside(ball)))
        self.key("n")
        self.click(*book)
        self.wait(lambda: len(self.editors) == 4 and is_blue(self.beside(book)))
        self.assertTrue(is_blue(self.beside(ball)))
        self.assertEqual(self.session.troubles, [])

    def test_a_color_is_recolored_everywhere(self):
        self.key("g")
        self.click(*RED)
        self.wait(lambda: self.editors == [("intrinsicrecolor", True)] and is_blue(self.beside(RED)))
        self.assertFalse(self.session.project.editors[0].get("use-mask"))

    def test_colors_are_picked_up(self):
        self.key("r")
        self.click(*RED)
        self.wait(lambda: is_blue(self.beside(RED)))
        self.click_widget(self.window.panel.settings.picks["target"])
        self.click(*YELLOW)
        self.wait(lambda: self.beside(RED)[2] < 60 and min(self.beside(RED)[:2]) > 120)
        self.assertEqual(self.window.tool.name, "recolor")  # goes on
        self.key("p")
        self.click(*CYAN)
        self.wait(lambda: self.beside(RED)[0] < 60 and min(self.beside(RED)[1:]) > 120)
        self.click_widget(self.window.panel.settings.picks["key"])
        self.click(*RED)
        self.wait(lambda: int(self.session.project.editors[1].get("key"), 0) & 0xffff < 0x2020)
        self.assertEqual(len(self.editors), 2)


class Select(WindowCase):
    def strokes(self):
        return json.loads(self.session.project.element("select1").get("strokes"))["strokes"]

    def test_editors_behind_change_what_is_selected(self):
        self.key("u")
        self.click(*RED)
        self.assertEqual(self.editors, [])  # nothing to leave out yet
        self.assertIn("Select an object first", self.window._info_text.get_text())
        self.key("m")
        self.drag(YELLOW, CYAN)
        self.wait(lambda: self.editors == [("intrinsicselect", True)])
        self.key("5")
        self.wait(lambda: min(*self.beside(YELLOW), *self.beside(CYAN)) > 240 and max(self.beside(RED)) < 15)
        self.key("plus", "u")
        self.drag(CYAN, (CYAN[0], 200))
        self.wait(lambda: max(self.beside(CYAN)) < 15 and min(self.beside(YELLOW)) > 240)
        self.assertEqual([(s["kind"], s["radius"]) for s in self.strokes()], [("add", 6), ("subtract", 7.5)])
        self.key("1")
        self.wait(lambda: self.beside(CYAN)[1:] == (255, 255))
        red, yellow, cyan = (self.beside(at) for at in (RED, YELLOW, CYAN))
        self.key("t")
        self.click_widget(self.window.panel.settings.controls["look"].buttons["metal"])
        self.wait(lambda: self.session.project.element("tone1").get("look") == "metal")
        self.wait(lambda: self.beside(YELLOW) != yellow)
        self.assertEqual((self.beside(RED), self.beside(CYAN)), (red, cyan))

    def test_a_lasso(self):
        self.key("a")
        corners = ((470, 30), (520, 30), (520, 150), (470, 150))
        self.drag(*corners)
        self.wait(lambda: self.editors == [("intrinsicselect", True)])
        drawn = self.strokes()[0]
        self.assertTrue(drawn["closed"])
        for found, wanted in zip(drawn["points"], corners):
            self.assertLess(max(abs(a - b) for a, b in zip(found, wanted)), 2)
        self.key("5")
        self.wait(lambda: min(self.beside(RED)) > 240 and max(self.beside(CYAN)) < 15)


class Add(WindowCase):
    """Editors that the mouse sets first."""

    def note(self):
        return self.window._info_text.get_text()

    def element(self, name):
        """The element of that name, once it has edited a frame."""
        self.wait(lambda: self.player.stage._elements[name].get_property("stats").get_value("frames"))
        return self.player.stage._elements[name]

    def lamps(self):
        text = self.session.project.element("relight1").get("lamps")
        return [lamp["position"] for lamp in json.loads(text)["lamps"]] if text else []

    def test_a_lamp(self):
        self.key("r", "l")
        self.wait(lambda: self.editors == [("intrinsicrelight", True)])
        self.assertEqual(self.window.tool.name, "lamp")
        self.assertIn("place a lamp", self.note())
        relight = self.element("relight1")
        self.session.set_property("relight1", "ambient", 0)
        self.wait(lambda: max(self.beside(CYAN)) < 20)
        self.click(*CYAN)
        self.wait(lambda: len(self.lamps()) == 1 and min(self.beside(CYAN)[1:]) > 100)
        for found, wanted in zip(self.lamps()[0], CYAN):
            self.assertAlmostEqual(found, wanted, delta=1.5)
        self.click(400, 300)
        self.wait(lambda: len(self.lamps()) == 2)
        self.drag(CYAN, (300, 200))  # not at once after the click there: gtksink ends a double click by a release
        self.wait(lambda: abs(self.lamps()[0][0] - 300) < 2 and abs(self.lamps()[0][1] - 200) < 2)
        self.key("s")  # another tool has the mouse
        self.wait(lambda: relight.get_property("lamp-mode").value_nick == "off")
        self.key("l")  # back to the same lamps
        self.wait(lambda: relight.get_property("lamp-mode").value_nick == "add")
        self.click_widget(self.window.toolbar.buttons["no-lamp"])
        self.click(400, 300)
        self.wait(lambda: len(self.lamps()) == 1)
        self.key("v")
        self.wait(lambda: relight.get_property("lamp-mode").value_nick == "move")
        self.assertEqual(self.editors, [("intrinsicrelight", True)])
        self.assertEqual(set(self.session.project.editors[0].properties), {"ambient", "lamps"})
        self.click_widget(self.window.toolbar.adders["intrinsicrelight"])
        self.wait(lambda: len(self.editors) == 2 and self.window.tool.name == "lamp")
        self.key("Delete")
        self.key("Delete")
        self.wait(lambda: not self.editors and self.window.tool.name == "look")
        self.assertEqual(self.session.troubles, [])

    def test_a_picture(self):
        self.in_dialog("The picture to hang", "x", None)
        self.wait(lambda: self.editors == [("intrinsictexture", True)])
        self.assertIn("location", self.note())
        self.key("Delete", "r")
        support.run_line("videotestsrc num-buffers=1 pattern=blue ! video/x-raw,width=80,height=60 ! pngenc ! "
                         f"filesink location={self.path('blue.png')}")
        self.in_dialog("The picture to hang", "x", self.path("blue.png"))
        self.wait(lambda: self.editors == [("intrinsictexture", True)])
        self.assertEqual(self.window.tool.name, "look")
        self.assertNotIn("location", self.note())
        self.element("texture1")
        self.drag((120, 60), (300, 140), (300, 160))
        self.wait(lambda: is_blue(self.shown((290, 150))) and is_blue(self.beside(YELLOW)))  # as it ended
        self.assertFalse(is_blue(self.beside(RED)))
        self.drag((300, 160), (420, 160))  # a corner
        self.wait(lambda: "420." in self.session.project.element("texture1").get("corners"))
        self.assertEqual(self.session.troubles, [])

    def test_a_key(self):
        self.key("r", "k")
        self.wait(lambda: self.editors == [("intrinsickey", True)])
        self.assertEqual(self.window.tool.name, "pick")
        self.assertIn("Click on the screen", self.note())
        self.click(*RED)
        self.wait(lambda: int(self.session.project.editors[0].get("key"), 0) & 0xff0000 > 0x800000)
        self.assertEqual(self.window.tool.name, "look")
        self.key("5")
        self.wait(lambda: max(self.beside(RED)) < 40 and min(self.beside(CYAN)) > 200)
        self.assertEqual(len(self.editors), 1)

    def test_others_leave_only_a_selection_going_on(self):
        self.key("r", "y")
        self.wait(lambda: self.editors == [("intrinsicstylize", True)])
        self.assertEqual(self.window.tool.name, "look")
        self.key("ctrl+z", "m")
        self.click(*RED)
        self.wait(lambda: self.editors == [("intrinsicselect", True)])
        self.key("t")
        self.wait(lambda: len(self.editors) == 2)
        self.assertEqual(self.window.tool.name, "select-add")
        self.assertTrue({"intrinsictexture", "intrinsickey"} <= set(self.window.toolbar.adders))


class Strokes(WindowCase):
    def strokes(self):
        text = self.session.project.decomposer.get("strokes")
        data = json.loads(text) if text else []
        return data["strokes"] if isinstance(data, dict) else data

    def test_each_kind_is_drawn_where_the_mouse_is(self):
        kinds = [nick for nick, _ in self.modes() if nick not in ("off", "erase")]
        self.assertLessEqual({"shading", "reflectance"}, set(kinds))
        for count, kind in enumerate(kinds, 1):
            self.click_widget(self.window.toolbar.buttons[f"stroke-{kind}"])
            start, end = (60 + 10 * count, 90 * count), (500, 90 * count + 40)
            self.drag(start, end)
            self.wait(lambda count=count: len(self.strokes()) == count)
            drawn = self.strokes()[-1]
            self.assertEqual(drawn["kind"], kind)
            for found, wanted in ((drawn["points"][0], start), (drawn["points"][-1], end)):
                self.assertAlmostEqual(found[0], wanted[0], delta=12)  # less than the brush
                self.assertAlmostEqual(found[1], wanted[1], delta=12)
            self.assertAlmostEqual(drawn["points"][0][0], start[0], delta=1.5)
        self.key("e")
        self.click(70, 90)
        self.wait(lambda: len(self.strokes()) == len(kinds) - 1)
        self.key("ctrl+z")
        self.wait(lambda: len(self.strokes()) == len(kinds))
        self.assertEqual(self.session.troubles, [])

    def modes(self):
        from inverse_play import elements
        return elements.properties("intrinsicdecomp")["stroke-mode"].choices

    def test_over_the_original_in_another_size(self):
        self.key("backslash", "s", "plus")
        decomposer = self.player.stage._elements["decomposer"]
        self.wait(lambda: decomposer.get_property("stroke-radius") == 15)  # from the next frame on
        self.window.resize(900, 700)
        support.pump(0.5)
        self.drag((50, 200), (100, 200))
        self.wait(lambda: len(self.strokes()) == 1)
        self.assertAlmostEqual(self.strokes()[0]["points"][0][0], 50, delta=1.5)
        self.assertAlmostEqual(self.strokes()[0]["points"][0][1], 200, delta=1.5)
        self.assertAlmostEqual(self.strokes()[0]["radius"], 15, delta=0.01)


class Keys(WindowCase):
    def show(self):
        return self.session.project.compose.get("show")

    def test_layers(self):
        for key, layer in zip("234651", ("reflectance", "shading", "input", "difference", "difference", "composed")):
            self.key(key)
            self.wait(lambda layer=layer: self.show() == layer)
        self.key("5")
        self.assertIn("write-mask", self.window._info_text.get_text())
        self.session.add_editor("intrinsicrecolor", {"write-mask": True})
        self.key("5")
        self.wait(lambda: self.show() == "mask")
        self.key("Up", "Down", "Delete")  # which made the mask
        self.wait(lambda: self.show() == "composed" and not self.editors)
        self.key("7")
        self.assertIn("globalintrinsic", self.window._info_text.get_text())
        self.assertEqual(self.session.troubles, [])

    def test_the_chain(self):
        self.session.set_decomposer("globalintrinsic")  # which intrinsicdespill needs
        self.key("d", "d")
        self.window.add_editor("intrinsicrecolor")
        self.key("alt+Up", "alt+Up")
        self.wait(lambda: [f for f, _ in self.editors] == ["intrinsicrecolor", "intrinsicdespill", "intrinsicdespill"])
        self.key("o")
        self.wait(lambda: self.editors[0] == ("intrinsicrecolor", False))
        self.key("alt+Down", "Delete")
        self.wait(lambda: len(self.editors) == 2)
        for _ in range(9):
            self.key("ctrl+z")
        self.wait(lambda: not self.editors)
        self.assertEqual(self.session.troubles, [])
        self.key("ctrl+z", "ctrl+z")
        self.assertIn("nothing to undo", self.window._info_text.get_text())

    def test_an_editor_that_does_not_fit_is_taken_back(self):
        self.key("d")
        self.wait(lambda: self.player.state == playback.FAILED)
        self.wait(self.window.info.get_mapped)
        self.assertIn("globalintrinsic", self.window._info_text.get_text())
        self.click_widget(self.window._undo)
        self.wait(lambda: self.player.state == playback.PLAYING and not self.editors)
        self.wait(lambda: self.player.stage.frames() > 2)
        self.assertEqual(self.session.troubles, [])

    def test_settings_that_are_changed_rarely(self):
        def controls():
            return self.window.panel.settings.controls
        self.window.add_editor("intrinsicrelight")
        self.wait(controls()["ambient"].get_mapped)
        self.assertTrue(controls()["lamp-color"].get_mapped())
        self.wait(lambda: not controls()["plane-depth"].get_mapped())
        self.window.panel.settings.more.set_expanded(True)
        self.wait(controls()["plane-depth"].get_mapped)
        self.session.set_property("relight1", "plane-depth", 2)
        self.key("Up", "Down")
        self.wait(lambda: controls()["plane-depth"].get_mapped())  # as it was changed

    def test_settings_by_keyboard(self):
        self.window.add_editor("intrinsicrecolor")
        self.key("Return", "Tab", "Tab", "Tab", "Tab", "Right", "Right")  # over two colors and what picks them up
        self.wait(lambda: self.session.project.editors[0].get("tolerance") > 0.41)
        self.key("Escape", "ctrl+z")
        if self.session.project.editors[0].get("tolerance") != 0.4:
            self.key("ctrl+z")  # both steps came slowly
        self.wait(lambda: self.session.project.editors[0].get("tolerance") == 0.4)

    def test_the_split_view(self):
        self.window.add_editor("intrinsicrecolor")
        for name, value in (("key", "0xffc00000"), ("target", "0xff00c000"), ("tolerance", 4.25)):
            self.session.set_property("recolor1", name, value)
        yellow = (140, 100)
        self.wait(lambda: is_green(self.shown(RED)) and is_green(self.shown(yellow)))
        self.key("backslash")
        self.wait(lambda: is_green(self.shown(RED)) and self.shown(yellow)[0] > 200)
        x, y = self.on_display(320, 240)
        self.xdotool("mousemove", x, y, "mousedown", 1)
        self.xdotool("mousemove", self.on_display(560, 240)[0], y)
        self.xdotool("mouseup", 1)
        self.wait(lambda: abs(self.session.project.split - 560 / 640) < 0.02)
        self.wait(lambda: self.shown(RED)[0] > 150)
        self.key("bracketleft", "bracketright", "bracketleft")
        self.assertAlmostEqual(self.session.project.split, 560 / 640 - 0.05, delta=0.02)
        self.key("backslash")
        self.wait(lambda: is_green(self.shown(RED)))

    def test_help_and_panels(self):
        self.key("F1")
        self.wait(self.window.help.get_mapped)
        self.key("Escape")
        self.wait(lambda: not self.window.help.get_mapped())
        self.key("question")
        self.wait(self.window.help.get_mapped)
        self.key("F1", "F9")
        self.wait(lambda: not self.window.panel.get_mapped())
        self.key("F9")
        self.wait(self.window.panel.get_mapped)

    def test_play_and_seek(self):
        self.open(self.clip(300), 160)
        self.wait(lambda: self.player.seekable)
        self.wait(lambda: re.fullmatch(r"160×120 · [\d.]+ of 10 frames/s · elements [1-9]\d* ms a frame",
                                       self.window.timeline.rate.get_text()))
        self.key("space")
        self.wait(lambda: self.player.state == playback.PAUSED)
        self.key("Home", "Right", "Right")
        self.wait(lambda: abs(self.player.position - 10) < 0.5)
        self.key("Left")
        self.wait(lambda: abs(self.player.position - 5) < 0.5)
        area = self.window.timeline.scale.get_allocation()
        self.click_widget(self.window.timeline.scale)  # its middle
        self.assertGreater(area.width, 100)
        self.wait(lambda: self.player.position > 6)
        self.key("End", "space")
        self.wait(lambda: self.player.state == playback.ENDED)
        self.wait(lambda: self.window.timeline.play.get_label() == "Again")
        self.wait(lambda: self.window.timeline.time.get_text() == "0:30.0 / 0:30.0")
        self.key("space")
        self.wait(lambda: self.player.state == playback.PLAYING and 0 < self.player.position < 20)

    def test_the_original_of_a_frame_that_stands_still(self):
        self.open(self.clip(40), 160)
        self.wait(lambda: self.player.seekable)
        self.key("space")
        self.session.set_property("compose", "show", "shading")
        self.session.set_split(0.5)
        yellow = (30, 40)
        self.wait(lambda: self.shown(yellow)[0] > 150 and self.shown(yellow)[2] < 80)
        self.key("2")
        self.key("Right")
        self.wait(lambda: self.player.position > 3)
        self.wait(lambda: self.shown(yellow)[0] > 150 and self.shown(yellow)[2] < 80)
        self.key("backslash", "space")
        self.wait(lambda: self.player.state == playback.ENDED)

    def test_record_and_snapshot(self):
        self.key("ctrl+r")
        self.wait(lambda: self.session.recorder and self.session.recorder.frames > 3)
        self.key("ctrl+r", "ctrl+p")
        self.wait(lambda: not self.session.recorder)
        names = sorted(os.listdir(self.folder))
        self.assertEqual([name[-4:] for name in names], [".mkv", ".png"])
        for name in names:
            self.assertTrue(support.read_video(self.path(name)))

    def test_files_by_dialogs(self):
        self.session.set_decomposer("globalintrinsic")
        self.key("d")
        self.in_dialog("Save the project", "ctrl+s", self.path("p.json"))
        self.wait(lambda: os.path.exists(self.path("p.json")))
        self.in_dialog("Save the launch line", "ctrl+shift+s", self.path("play.sh"))
        self.wait(lambda: os.path.exists(self.path("play.sh")))
        with open(self.path("play.sh"), encoding="utf-8") as file:
            self.assertIn("! intrinsicdespill !", file.read())
        self.key("Delete")
        self.wait(lambda: not self.editors)
        self.in_dialog("Load a project", "ctrl+l", None)
        self.assertEqual(self.editors, [])
        self.session.load(self.path("p.json"))
        self.wait(lambda: len(self.editors) == 1)
        self.key("ctrl+shift+c")
        self.wait(lambda: "intrinsicdespill" in (Gtk.Clipboard.get(Gdk.SELECTION_CLIPBOARD).wait_for_text() or ""))


if __name__ == "__main__":
    unittest.main()
