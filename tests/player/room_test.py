# SPDX-License-Identifier: LGPL-2.1-or-later
"""A room with a depth camera in the window: strokes, a hand, lamps, and the scene."""
import json
import os
import unittest

import support
from window_case import TEST, WindowCase, is_green
from inverse_play import elements, scene
from inverse_play.json_list import entries

ROOM = "rgbdtestsrc samples=1 path={} ! video/x-raw,width=160,height=120,framerate=5/1"
# Not live: a busy machine leaves out no frames, by which the camera or a hand would leap.
MOVING = "rgbdtestsrc name=camera is-live=false samples=1 path={} ! video/x-raw,width=160,height=120,framerate={}/1"
TABLE, WALL = (70, 75), (30, 30)


class Room(WindowCase):
    def enter(self, line):
        self.open(line, 160)
        self.wait_for_camera()

    def enter_moving(self, path, rate):
        """Every frame is worked on, however long that takes."""
        self.open(MOVING.format(path, rate), 160)
        self.player.every_frame(True)
        self.wait_for_camera()

    def wait_for_camera(self):
        self.wait(lambda: "camera found" in self.window.timeline.scene.get_text())
        self.wait(self.window.scene.get_mapped)

    def set_hand(self, target):
        self.player._pipeline.get_by_name("camera").set_property("hand", target)

    def details(self):
        return f"{super().details()}; {self.window.timeline.scene.get_text()}; {self.element('decomposer').props.stats.to_string()}"

    def element(self, name):
        return self.player.stage._elements[name]

    def set(self, name, value, element="decomposer"):
        self.session.set_property(element, name, value)
        self.wait(lambda: elements.read(self.element(element), name) == value)

    def strokes(self):
        return entries(self.session.project.decomposer.get("strokes::list"), "strokes")

    def are_in_scene(self, count):
        return len(self.strokes()) == count and all("balls" in stroke for stroke in self.strokes())

    def lamps(self):
        return json.loads(self.session.project.element("relight1").get("lamps") or '{"lamps":[]}')["lamps"]

    def test_its_tools_are_there_with_depth_alone(self):
        self.assertFalse(self.window.scene.get_mapped())
        self.assertEqual(self.window.timeline.scene.get_text(), "")
        self.enter(ROOM.format("orbit"))
        self.open(TEST, 640)
        self.wait(lambda: not self.window.scene.get_mapped() and self.window.timeline.scene.get_text() == "")
        self.session.set_decomposer(next(f for f in elements.decomposers() if not scene.is_offered(f)))
        self.key("h")
        self.wait_for_note("remembers no scene")

    def test_strokes_are_undone_while_the_camera_moves(self):
        self.enter_moving("orbit speed=0.3", 5)
        self.key("c")
        self.click(*TABLE)
        self.wait(lambda: len(self.strokes()) == 1)  # a step of its own
        self.click(*WALL)  # maybe before the first one is in the scene
        self.wait(lambda: self.are_in_scene(2))
        first, second = self.strokes()
        self.key("ctrl+z")
        self.wait(lambda: self.strokes() == [first])
        self.key("ctrl+z")
        self.wait(lambda: self.strokes() == [])
        self.key("ctrl+shift+z", "ctrl+shift+z")
        self.wait(lambda: self.strokes() == [first, second])
        self.wait(lambda: entries(elements.read(self.element("decomposer"), "strokes::list"), "strokes") == [first, second])
        self.assertEqual(self.session.troubles, [])

    def test_strokes_are_seen_and_erased(self):
        self.enter(ROOM.format("still"))
        self.set("strokes::color", "0xff00c000")
        self.key("c")
        self.click(*TABLE)
        self.wait(lambda: self.are_in_scene(1) and is_green(self.shown(TABLE)))
        self.key("e")
        self.click(*TABLE)
        self.wait(lambda: self.strokes() == [] and not is_green(self.shown(TABLE)))

    def test_a_hand_paints(self):
        self.enter_moving("table", 10)
        self.key("h")
        self.wait(lambda: elements.read(self.element("decomposer"), "strokes::touch"))
        self.assertEqual(self.window.tool.name, "stroke-recolor")
        self.assertTrue(self.window.scene.buttons["freeze"].get_active())
        self.set_hand("dark-ball")  # which the scene has not seen: it stays as it was
        self.wait(lambda: self.strokes())
        self.set_hand("none")  # it would come again
        self.wait(lambda: self.are_in_scene(1))
        for word in ("strokes::touch=true", "scene::update=false", "strokes::mode=recolor"):
            self.assertIn(word, self.session.launch_line())
        self.session.save(self.path("p.json"))
        self.key("ctrl+z")
        self.wait(lambda: self.strokes() == [])
        self.key("h")
        self.assertEqual(self.session.project.decomposer.properties, {})
        self.session.load(self.path("p.json"))
        self.assertTrue(self.session.touches and self.are_in_scene(1))
        self.assertEqual(self.session.troubles, [])

    def test_lamps_stand_in_the_room(self):
        self.enter(ROOM.format("still"))
        self.key("l")
        self.wait(lambda: self.editors == [("intrinsicrelight", True)])
        self.wait(self.window.panel.settings.controls["shadows"].get_mapped)
        self.set("show-lamps", True, "relight1")
        # A frame is completed when later ones have come; the mouse needs what one saw of the scene.
        self.wait(lambda: (self.element("relight1").get_property("stats").get_value("frames") or 0) > 4)
        self.click(*TABLE)
        self.wait(lambda: len(self.lamps()) == 1)
        first = self.lamps()[0]
        self.assertTrue(first["room"])
        self.wait(lambda: min(self.shown(TABLE)) > 240)  # its mark
        self.drag(TABLE, (110, 75))
        self.wait(lambda: self.lamps()[0]["position"][0] > first["position"][0] + 0.1)
        self.assertTrue(self.lamps()[0]["room"])
        self.click_widget(self.window.toolbar.buttons["no-lamp"])
        self.click(110, 75)
        self.wait(lambda: self.lamps() == [])
        self.session.toggle_playing()
        self.key("l")
        self.click(*TABLE)
        self.wait_for_note("Play to place them in the room")
        self.assertEqual(self.session.troubles, [])

    def test_the_scene_is_saved_loaded_and_forgotten(self):
        self.enter(ROOM.format("still"))
        path = self.path("room.scene")
        self.in_dialog("Save the scene", self.window.scene.buttons["save-scene"], path)
        self.wait_for_note(f"Saved {path}")
        self.assertGreater(os.path.getsize(path), 10000)
        before = self.element("decomposer")
        self.in_dialog("Load a scene", self.window.scene.buttons["load-scene"], path)
        self.wait(lambda: self.element("decomposer") is not before and self.player.stage.scene())
        self.assertEqual(self.session.project.decomposer.properties, {"scene::load": path})
        self.wait(lambda: self.player.stage.scene().get("scene-keyframes", 0) > 0)
        self.click_widget(self.window.scene.buttons["forget-scene"])
        self.wait(lambda: self.session.project.decomposer.properties == {} and self.player.stage.scene())
        self.session.save_scene("/none/room.ply")
        self.wait_for_note("/none/room.ply")
        self.assertEqual(self.session.troubles, [])


if __name__ == "__main__":
    unittest.main()
