# SPDX-License-Identifier: LGPL-2.1-or-later
"""The window: painting, strokes, keys and files."""
import json
import os
import re
import unittest

import support
from gi.repository import Gst
from window_case import CYAN, RED, YELLOW, Gdk, Gtk, WindowCase, is_blue, is_green, is_near
from inverse_play import elements, playback


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
        for place in ((364, 303), (400, 303), (385, 285)):
            self.wait(lambda place=place: is_blue(self.shown(place)))
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


    def test_keys_work_after_a_control_was_used(self):
        self.window.add_editor("intrinsictone")
        self.wait(lambda: self.editors)
        controls = self.window.panel.settings.controls
        for key, name, show in (("2", "use-mask", "reflectance"), ("1", "strength", "composed")):
            self.click_widget(controls[name])
            self.key(key)
            self.wait(lambda show=show: self.session.project.compose.get("show") == show)

    def test_a_wait_for_a_frame_is_shown(self):
        spinner = self.window.picture.spinner
        self.wait(lambda: not spinner.get_visible())
        self.session.open("videotestsrc ! video/x-raw,width=160,height=120 ! identity sleep-time=2000000")
        self.wait(spinner.get_visible)
        self.wait(lambda: not spinner.get_visible())
        self.assertEqual(self.player.width, 160)

    def test_an_edit_says_what_it_applies_to(self):
        self.key("m")
        self.click(*RED)
        self.wait(lambda: self.editors == [("intrinsicselect", True)])
        self.window.add_editor("intrinsictone")
        self.wait_for_note("Tone applies to the selected object")
        self.assertTrue(self.session.project.element("tone1").get("use-mask"))
        self.window.add_editor("intrinsictone")  # tone1 is selected, not the object
        self.wait_for_note("Tone applies to the whole picture")
        self.assertFalse(self.session.project.element("tone2").get("use-mask"))
        # A preset changes what it names alone.
        element = Gst.ElementFactory.make("intrinsictone")
        self.window.panel.settings._load_preset(element, element.get_preset_names()[0])
        self.assertFalse(self.session.project.element("tone2").get("use-mask"))
        self.assertGreater(len(self.session.project.element("tone2").properties), 1)


class Select(WindowCase):
    def strokes(self):
        return json.loads(self.session.project.element("select1").get("strokes::list"))["strokes"]

    def test_editors_behind_change_what_is_selected(self):
        self.key("u")
        self.click(*RED)
        self.wait_for_note("Select an object first")  # nothing to leave out yet
        self.assertEqual(self.editors, [])
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

    def test_one_with_all_its_strokes_takes_no_more(self):
        self.key("m")
        self.click(*YELLOW)
        self.wait(lambda: self.editors == [("intrinsicselect", True)])
        many = [{"kind": "add", "points": [[x, 100]]} for x in range(64)]
        text = json.dumps(many)
        self.session.set_property("select1", "strokes::list", text)
        self.click(*CYAN)
        self.wait_for_note("takes no more")
        self.assertEqual(self.session.project.element("select1").get("strokes::list"), text)


class Strokes(WindowCase):
    def strokes(self):
        text = self.session.project.decomposer.get("strokes::list")
        data = json.loads(text) if text else []
        return data["strokes"] if isinstance(data, dict) else data

    def test_each_kind_is_drawn_where_the_mouse_is(self):
        kinds = [nick for nick, _ in self.modes() if nick not in ("off", "erase", "pick")]
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
        return elements.properties("intrinsicdecomp")["strokes::mode"].choices

    def test_over_the_original_in_another_size(self):
        self.key("backslash", "s", "plus")
        decomposer = self.player.stage._elements["decomposer"]
        self.wait(lambda: elements.read(decomposer, "strokes::radius") == 15)  # from the next frame on
        before = self.window.picture.get_allocated_width()
        self.window.resize(900, 700)
        self.wait(lambda: self.window.picture.get_allocated_width() < before)
        self.settle()
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
        self.wait_for_note("write-mask")
        self.session.add_editor("intrinsicrecolor", {"write-mask": True})
        self.key("5")
        self.wait(lambda: self.show() == "mask")
        self.key("Up", "Down", "Delete")  # which made the mask
        self.wait(lambda: self.show() == "composed" and not self.editors)
        self.key("7")
        self.wait_for_note("globalintrinsic")
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
        self.wait_for_note("nothing to undo")

    def test_an_editor_that_does_not_fit_is_taken_back(self):
        self.key("d")
        self.wait(lambda: self.player.state == playback.FAILED)
        self.wait(self.window.info.get_mapped)
        self.wait_for_note("globalintrinsic")
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
        self.wait(self.window.panel.settings.controls["tolerance"].get_mapped)
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
        self.wait(lambda: abs(self.session.project.split - (560 / 640 - 0.05)) < 0.02)
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

    def test_a_recording_waits_while_the_picture_stands(self):
        self.open(self.clip(60), 160)
        self.wait(lambda: self.player.seekable)
        self.key("space")
        self.wait(lambda: self.player.state == playback.PAUSED)
        self.key("ctrl+r")
        self.wait_for_note("once the video plays")
        self.assertEqual(self.session.recorder.frames, 0)
        self.key("space")
        self.wait(lambda: self.session.recorder.frames > 3)
        self.key("ctrl+r")
        self.wait(lambda: not self.session.recorder)

    def test_a_project_is_named_as_its_video(self):
        self.session.open(self.clip(40, "walk.mkv"))
        self.wait(lambda: self.player.width == 160)
        self.assertEqual(self.session.project_place(), ("walk.json", self.folder))
        self.in_dialog("Save the project", "ctrl+s", self.path("walk.json"))
        self.wait(lambda: os.path.exists(self.path("walk.json")))

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

    def test_another_video_asks_what_becomes_of_the_edits(self):
        first, other = self.session.project.source, self.clip(40)
        self.key("d")
        self.wait(lambda: self.editors)
        edits = self.editors
        for response, source, left in ((Gtk.ResponseType.CANCEL, first, edits), (Gtk.ResponseType.YES, other, edits)):
            self.answer("Keep the edits", response, lambda: self.window.open(other))
            self.assertEqual((self.session.project.source, self.editors), (source, left))
        self.answer("Keep the edits", Gtk.ResponseType.NO, lambda: self.window.open("test"))
        self.assertEqual((self.session.project.source, self.editors), ("test", []))
        self.window.open(other)  # there is nothing to ask about
        self.assertEqual(self.session.project.source, other)
        self.key("ctrl+z", "ctrl+z")
        self.wait(lambda: (self.session.project.source, self.editors) == (other, edits))


if __name__ == "__main__":
    unittest.main()
