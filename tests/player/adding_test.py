# SPDX-License-Identifier: LGPL-2.1-or-later
"""The window: editors that the mouse sets first."""
import json
import unittest

import support
from window_case import CYAN, RED, YELLOW, WindowCase, is_blue


class Add(WindowCase):
    """Editors that the mouse sets first."""

    def element(self, name):
        """The element of that name, once it has edited a frame."""
        self.wait(lambda: self.player.stage._elements[name].get_property("stats").get_value("frames"))
        return self.player.stage._elements[name]

    def lamps(self, field="position"):
        text = self.session.project.element("relight1").get("lamps")
        return [lamp[field] for lamp in json.loads(text)["lamps"]] if text else []

    def test_a_lamp(self):
        self.key("r", "l")
        self.wait(lambda: self.editors == [("intrinsicrelight", True)])
        self.assertEqual(self.window.tool.name, "lamp")
        self.wait_for_note("place a lamp")
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
        # The one that was dragged, and those to come.
        usual = self.lamps("power")[1]
        powers = lambda: [round(power / usual, 3) for power in self.lamps("power")]  # noqa: E731
        self.session.set_property("relight1", "lamp-power", 3 * usual)
        self.session.set_property("relight1", "lamp-color", "0xffff0000")
        self.wait(lambda: relight.get_property("lamps").count("#ff0000") == 1)
        self.assertEqual(powers(), [3, 1])
        self.assertEqual(self.lamps("color"), ["#ff0000", "#ffffff"])
        self.drag((400, 300), (420, 300))
        self.wait(lambda: self.session.project.element("relight1").get("lamp-color") == "0xffffffff")
        self.session.set_property("relight1", "lamp-power", 2 * usual)
        self.assertEqual(powers(), [3, 2])
        self.drag((420, 300), (400, 300))
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
        self.assertEqual(set(self.session.project.editors[0].properties), {"ambient", "lamps", "lamp-power"})
        self.click_widget(self.window.toolbar.adders["intrinsicrelight"])
        self.wait(lambda: len(self.editors) == 2 and self.window.tool.name == "lamp")
        self.key("Delete")
        self.key("Delete")
        self.wait(lambda: not self.editors and self.window.tool.name == "look")
        self.assertEqual(self.session.troubles, [])

    def test_a_picture(self):
        self.in_dialog("The picture to hang", "x", None)
        self.wait(lambda: self.editors == [("intrinsictexture", True)])
        self.wait_for_note("location")
        self.key("Delete", "r")
        support.run_line("videotestsrc num-buffers=1 pattern=blue ! video/x-raw,width=80,height=60 ! pngenc ! "
                         f"filesink location={self.path('blue.png')}")
        self.in_dialog("The picture to hang", "x", self.path("blue.png"))
        self.wait(lambda: self.editors == [("intrinsictexture", True)])
        self.assertEqual(self.window.tool.name, "look")
        self.assertNotIn("location", self.window._info_text.get_text())
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
        self.wait_for_note("Click on the screen")
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


if __name__ == "__main__":
    unittest.main()
