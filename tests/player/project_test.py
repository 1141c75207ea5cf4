# SPDX-License-Identifier: LGPL-2.1-or-later
"""Projects, undo, launch lines and the command line: without a display."""
import dataclasses
import json
import os
import shlex
import shutil
import subprocess
import sys
import unittest
from concurrent import futures

import support
from gi.repository import Gst
from inverse_play import arguments, elements, intros, launch_line, layers, project, scene, selection, source, tools, trust
from inverse_play.elements import ElementError
from inverse_play.history import History
from inverse_play.project import Element, Project
from lists_in_files import Listed

STROKES = '[{"kind":"shading","radius":12,"points":[[100,80],[120,80]]}]'


def painted(**properties):
    """A project with one editor."""
    editor = Element("recolor1", "intrinsicrecolor")
    for name, value in properties.items():
        editor = editor.with_property(name.replace("_", "-"), value)
    return Project(source="test", editors=(editor,))


class Elements(support.Case):
    def test_finds_editors_and_decomposers_by_their_pads(self):
        self.assertLessEqual({"intrinsicrecolor", "intrinsicdespill"}, set(elements.editors()))
        self.assertLessEqual({"intrinsicdecomp", "globalintrinsic"}, set(elements.decomposers()))
        for name in ("intrinsiccompose", "intrinsicsplit", "videoconvert", "videorate", "materialclone"):
            self.assertNotIn(name, elements.editors() + elements.decomposers())

    def test_offers_no_editor_that_does_nothing_alone_or_twice(self):
        self.assertTrue(elements.merges("intrinsicmerge"))
        offered = {factory for factory, _, _, _ in tools.editors()}
        self.assertLessEqual({"intrinsicrelight", "intrinsictexture", "intrinsicedit"}, offered)
        self.assertFalse(offered & {"intrinsicmerge", "intrinsicselect", "intrinsicrecolor"})
        titles = [title for _, title, _, _ in tools.editors()] + [tool.label for tool in tools.offered(Project())]
        self.assertEqual(len(titles), len(set(titles)))
        keys = [key for _, _, key, _ in tools.editors() if key] + [t.key for t in tools.offered(Project()) if t.key]
        self.assertEqual(len(keys), len(set(keys)))

    def test_a_key_makes_a_mask(self):
        keyed = project.parse_editor("intrinsickey", Project())
        self.assertIsNone(layers.missing("mask", keyed))
        off = keyed.with_element(keyed.editors[0].with_property("strength", 0))
        self.assertIsNotNone(layers.missing("mask", off))

    def test_settings_that_no_table_names_are_rare(self):
        for factory, name, rare in (("intrinsicrelight", "plane-depth", True), ("intrinsicrelight", "ambient", False),
                                    ("intrinsicrelight", "use-mask", False), ("intrinsicdecomp", "device", True),
                                    ("intrinsicdecomp", "quality", False), ("globalintrinsic", "quality", False)):
            self.assertEqual(intros.is_rare(factory, name), rare, name)
        self.assertFalse(intros.is_rare("videobalance", "hue"))  # has no page

    def test_describes_properties(self):
        found = elements.properties("intrinsicrecolor")
        self.assertEqual((found["key"].kind, found["key"].default), ("color", "0x00000000"))
        self.assertEqual((found["tolerance"].minimum, found["tolerance"].maximum), (0, 4.25))
        self.assertEqual(found["write-mask"].kind, "bool")
        self.assertTrue(found["key"].live)
        self.assertFalse(elements.properties("intrinsicdecomp")["device"].live)
        modes = dict(elements.properties("intrinsicdecomp")["strokes::mode"].choices)
        self.assertIn("strokes of constant shading", modes["shading"])
        self.assertNotIn("stats", found)

    def test_sets_what_it_reads(self):
        for factory in elements.editors() + elements.decomposers() + ["intrinsiccompose"]:
            element = elements.make(factory, None)
            for name in elements.properties(factory):
                value = elements.read(element, name)
                elements.write(element, name, elements.checked(factory, name, value))
                self.assertEqual(elements.read(element, name), value, f"{factory} {name}")

    def test_files_to_read_are_chosen_and_files_to_write_named(self):
        kinds = {name: described.kind for name, described in elements.properties("intrinsicdecomp").items()}
        self.assertEqual((kinds["scene::load"], kinds["scene::location"], kinds["prior"]), ("file", "text", "text"))
        self.assertEqual(elements.properties("intrinsictexture")["location"].kind, "file")

    def test_refuses_what_does_not_fit(self):
        for name, value in (("key", "red"), ("tolerance", 9), ("tolerance", "x"), ("use-mask", "perhaps"),
                            ("base-color", 16), ("nothing", 1)):
            with self.assertRaises(ElementError, msg=f"{name}={value}"):
                elements.checked("intrinsicrecolor", name, value)
        with self.assertRaisesRegex(ElementError, "install the plugin"):
            elements.make("intrinsicnothing", None)


class Files(support.Case):
    def test_properties_of_older_files_are_found(self):
        made = project.from_data({
            "version": 1, "decomposer": {"element": "intrinsicdecomp", "properties": {"strokes": STROKES, "stroke-radius": 20, "scene-depth": 3}},
            "editors": [{"element": "intrinsicselect", "properties": {"strokes": "[]", "stroke-mode": "lasso", "tolerance": 0.5}}]})
        self.assertEqual(made.decomposer.properties, {"strokes::list": STROKES, "strokes::radius": 20, "scene::max-depth": 3})
        self.assertEqual(made.editors[0].properties, {"strokes::list": "[]", "strokes::mode": "lasso", "tolerance": 0.5})

    def test_saves_and_loads(self):
        made = dataclasses.replace(painted(key="0xff102030", tolerance=0.7, use_mask=False), split=0.25)
        made = made.with_element(made.decomposer.with_property("strokes::list", STROKES))
        made = made.with_element(dataclasses.replace(made.editors[0], on=False))
        made = made.with_element(made.compose.with_property("show", "shading"))
        project.save(made, self.path("p.json"))
        self.assertEqual(project.load(self.path("p.json")), made)
        self.assertEqual(os.listdir(self.folder), ["p.json"])

    def test_refuses_broken_files(self):
        good = project.to_data(painted(key="0xff102030"))
        broken = ["", "[]", "{}", '{"version": 2}', json.dumps({**good, "split": 2}),
                  json.dumps({**good, "editors": [{"element": "intrinsicnothing"}]}),
                  json.dumps({**good, "editors": [{"element": "intrinsiccompose"}]}),
                  json.dumps({**good, "editors": [{"element": "intrinsicrecolor", "properties": {"key": "x"}}]}),
                  json.dumps({**good, "editors": [{"element": "intrinsicrecolor", "properties": []}]}),
                  json.dumps({**good, "decomposer": {"element": "videoconvert"}}), json.dumps({**good, "source": 3}),
                  json.dumps(good).replace('"on": true', '"on": 1'), "[" * 100000, '{"version": 1, "editors": ' + "[" * 100000,
                  json.dumps({**good, "editors": [{"element": "intrinsicrecolor", "properties": {"tolerance": float("inf")}}]}),
                  json.dumps({**good, "editors": [{"element": "intrinsicrelight", "properties": {"layer": float("inf")}}]}),
                  json.dumps({**good, "decomposer": {"element": "intrinsicdecomp", "properties": {"strokes": "\ud800"}}}),
                  json.dumps({**good, "decomposer": {"element": "intrinsicdecomp", "properties": {"strokes": "a\0b"}}}),
                  json.dumps({**good, "source": "\ud800"}), json.dumps({**good, "source": "a\0b"}), json.dumps({**good, "split": float("nan")})]
        for text in broken:
            with open(self.path("p.json"), "w", encoding="utf-8") as file:
                file.write(text)
            with self.assertRaises(ElementError, msg=text) as caught:
                project.load(self.path("p.json"))
            self.assertIn("p.json", str(caught.exception))

    def test_a_file_that_cannot_be_written_leaves_nothing(self):
        with self.assertRaises(OSError):
            project.save(painted(), self.path("none/p.json"))

    def test_names_of_editors_are_used_again(self):
        made = project.parse_editor("intrinsicrecolor", project.parse_editor("intrinsicrecolor", Project()))
        self.assertEqual([e.name for e in made.editors], ["recolor1", "recolor2"])
        self.assertEqual(made.with_editors(made.editors[1:]).new_name("intrinsicrecolor"), "recolor1")


def select(made, selected, at=(125, 40), kind="add", paints=True):
    """(project, name) after a click on a frame of 160 x 120 pixels."""
    return selection.drawn(made, selected, selection.Stroke(kind, 3, [at]), (160, 120), paints)


def strokes_of(made, name="select1"):
    return json.loads(made.element(name).get("strokes::list"))["strokes"]


class Selections(support.Case):
    def names(self, made):
        return [e.name for e in made.editors]

    def test_the_first_click_adds_what_the_next_ones_extend(self):
        made, name = select(Project(), "decomposer")
        self.assertEqual((self.names(made), name), (["select1", "recolor1"], "recolor1"))
        made, name = select(made, name, (30.04, 40), "subtract")
        self.assertEqual((self.names(made), name), (["select1", "recolor1"], "recolor1"))
        self.assertEqual([(s["kind"], s["points"]) for s in strokes_of(made)],
                         [("add", [[125, 40]]), ("subtract", [[30, 40]])])

    def test_another_object_has_a_selection_of_its_own(self):
        made, _ = select(Project(), None)
        made, second = select(made, None)
        self.assertEqual(self.names(made), ["select1", "recolor1", "select2", "recolor2"])
        made, name = select(made, "recolor1", paints=False)
        self.assertEqual((len(strokes_of(made)), len(strokes_of(made, "select2")), name), (2, 1, "select1"))
        made, name = select(made.with_editors(e for e in made.editors if e.name != "recolor1"), "select1")
        self.assertEqual(self.names(made), ["select1", "recolor1", "select2", "recolor2"])
        self.assertEqual((name, second), ("recolor1", "recolor2"))

    def test_what_is_off_or_selects_a_color_is_no_selection(self):
        made, name = select(Project(), None)
        for changed in (dataclasses.replace(made.element("select1"), on=False),
                        made.element("select1").with_property("by", "key")):
            self.assertIsNone(selection.selection_of(made.with_element(changed), name))
        keyed = made.with_element(made.element("recolor1").with_property("key", "0xff00ff00"))
        self.assertEqual(self.names(select(keyed, "recolor1")[0]), ["select1", "recolor2", "recolor1"])

    def test_strokes_fit_the_frame_that_they_are_for(self):
        stroke = selection.Stroke("add", 3, [(80, 60)], closed=True)
        half = selection.with_stroke('{"frame":[80,60],"strokes":[]}', stroke, (160, 120))
        self.assertEqual(json.loads(half), {"frame": [80, 60], "strokes": [
            {"kind": "add", "radius": 3, "closed": True, "points": [[40, 30]]}]})
        self.assertEqual(json.loads(selection.with_stroke("[]", stroke, (9, 9)))[0]["points"], [[80, 60]])

    def test_takes_no_more_than_the_element_does(self):
        made = Project()
        for x in range(selection.MAX_STROKES - 1):
            self.assertFalse(selection.is_full(selection.selection_of(made, "select1")))
            made, _ = select(made, "select1", (x, 0), paints=False)
        long = selection.Stroke("add", 1, [(0, 0)])
        for x in range(2 * selection.MAX_POINTS):
            long.extend(x, 0)
        made, _ = selection.drawn(made, "select1", long, (160, 120), False)
        text = made.element("select1").get("strokes::list")
        element = elements.make("intrinsicselect", None)
        elements.write(element, "strokes::list", text)
        self.assertEqual(elements.read(element, "strokes::list"), text)
        self.assertEqual(len(strokes_of(made)), selection.MAX_STROKES)
        self.assertTrue(selection.is_full(made.element("select1")))

    def test_tools_are_what_the_elements_offer(self):
        found = {tool.draws: tool.label for tool in tools.offered(Project()) if tool.draws and not tool.paints}
        self.assertEqual(found, {"add": "Select", "subtract": "Not this", "lasso": "Lasso"})


class Undo(support.Case):
    def test_steps_and_their_labels(self):
        now = [0.0]
        history = History("a", lambda: now[0])
        history.add("one", "b")
        history.add("slide", "c", "slider")
        now[0] = 0.5
        history.add("slide", "d", "slider")  # joins the one before
        now[0] = 5
        history.add("slide", "e", "slider")  # later: another step
        self.assertEqual([history.undo() for _ in range(4)], ["slide", "slide", "one", None])
        self.assertEqual(history.state, "a")
        self.assertEqual([history.redo() for _ in range(4)], ["one", "slide", "slide", None])
        self.assertEqual(history.state, "e")
        history.undo()
        history.add("other", "f")
        self.assertIsNone(history.redo())
        self.assertEqual((history.undo(), history.state), ("other", "d"))

    def test_all_states_are_amended(self):
        history = History("a")
        history.add("one", "ab")
        history.add("two", "abc")
        history.undo()
        history.amend(str.upper)
        self.assertEqual((history.state, history.redo(), history.state), ("AB", "two", "ABC"))
        history.undo()
        self.assertEqual((history.undo(), history.state), ("one", "A"))

    def test_memory_is_bounded(self):
        history = History(0)
        for i in range(2000):
            history.add("", i)
        self.assertLess(sum(1 for _ in iter(history.undo, None)), 600)


class Layers(support.Case):
    def test_only_those_that_are_there(self):
        made = painted()
        self.assertIn("globalintrinsic", layers.missing("direct", made)[1])
        self.assertIn("write-mask", layers.missing("mask", made)[1])
        masked = painted(write_mask=True)
        self.assertIsNone(layers.missing("mask", masked))
        shown = masked.with_element(masked.compose.with_property("show", "mask"))
        self.assertEqual(layers.corrected(shown).compose.get("show"), "mask")
        self.assertEqual(layers.corrected(shown.with_editors([])).compose.get("show"), "composed")


POINTS = {"kind": "recolor", "color": "#00c000", "radius": 12.0, "points": [[9, 9]]}
OTHER = {"kind": "shading", "radius": 12.0, "points": [[5, 5]]}
BALLS = {"kind": "recolor", "color": "#00c000", "balls": [[0.1, 0.2, 0.3, 0.05]]}


def listed(*strokes):
    return json.dumps({"frame": [160, 120], "strokes": strokes})


class StrokesOfARoom(support.Case):
    def test_those_that_are_put_into_the_scene_are_found(self):
        self.assertIsNotNone(scene.placed(listed(POINTS, OTHER), listed(BALLS, OTHER)))
        drawn = scene.placed(listed(POINTS), listed(BALLS, OTHER))  # and another one was drawn
        made = Project(decomposer=Element("decomposer", "intrinsicdecomp").with_property("strokes::list", listed(POINTS)))
        self.assertEqual(json.loads(drawn(made).decomposer.get("strokes::list")), json.loads(listed(BALLS)))
        for before, after in ((listed(POINTS), listed(POINTS, BALLS)), (listed(POINTS, OTHER), listed(BALLS)),
                              (listed(BALLS), listed(POINTS)), (listed(POINTS), listed(POINTS)), ("", listed(BALLS)),
                              (listed(OTHER), listed(BALLS)), (listed(BALLS), "")):
            self.assertIsNone(scene.placed(before, after), (before, after))

    def test_they_are_described_anew_wherever_they_are(self):
        describe = scene.placed(listed(POINTS, OTHER), listed(BALLS, OTHER))
        for before, after in ((listed(OTHER, POINTS), listed(OTHER, BALLS)), (listed(OTHER), listed(OTHER)), ("", ""),
                              (json.dumps([POINTS]), json.dumps([BALLS])),
                              (listed(POINTS, OTHER), listed(BALLS, OTHER)), (listed(BALLS), listed(BALLS))):
            made = Project(decomposer=Element("decomposer", "intrinsicdecomp").with_property("strokes::list", before))
            found = describe(made).decomposer.get("strokes::list")
            self.assertEqual(json.loads(found or "0"), json.loads(after or "0"))
        other = Project(decomposer=Element("decomposer", "limematerial"))
        self.assertEqual(describe(other), other)

    def test_a_launch_line_lets_a_hand_draw_as_the_project_does(self):
        hand = Element("decomposer", "intrinsicdecomp", {**scene.touched(True), "strokes::mode": "select"})
        text = launch_line.element_text(hand)
        for word in ("strokes::touch=true", "scene::update=false", "strokes::mode=select"):
            self.assertIn(word, text)
        mouse = Element("decomposer", "intrinsicdecomp", {"strokes::mode": "select", "strokes::fill": True})
        self.assertEqual(launch_line.element_text(mouse), "intrinsicdecomp")

    def test_what_is_said_of_the_scene(self):
        self.assertEqual(scene.text({}), "")
        found = {"scene-camera-found": True, "scene-frames-lost": 0, "scene-blocks": 12}
        self.assertEqual(scene.text(found), "Scene: camera found · 12 blocks")
        lost = scene.text({**found, "scene-camera-found": False, "scene-frames-lost": 3})
        self.assertEqual(lost, "Scene: camera lost for 3 frames · 12 blocks")
        self.assertIn("touched", scene.text({**found, "scene-touched": True}))


def blocks(line):
    """Blocks of voxels that the decomposer remembers of a line's frames; None if they carry no depth."""
    pipeline = Gst.parse_launch(f"{line} ! videoconvert ! intrinsicdecomp name=d ! fakesink sync=false")
    pipeline.set_state(Gst.State.PLAYING)
    pipeline.get_bus().timed_pop_filtered(60 * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    stats = pipeline.get_by_name("d").get_property("stats")
    pipeline.set_state(Gst.State.NULL)
    return stats.get_value("scene-blocks")


class LaunchLine(support.Case):
    def run_in_shell(self, made, width=0):
        """Runs the command with a file in place of the window; returns its frames."""
        command = launch_line.shell_text(made, width)
        self.assertTrue(command.startswith("gst-launch-1.0 "))
        out = self.path("out.mkv")
        command = command.replace(" autovideosink", f" vp8enc deadline=1 ! matroskamux ! filesink location={out}")
        subprocess.run(command, shell=True, check=True, timeout=60, stdout=subprocess.DEVNULL)
        return support.read_video(out)

    def test_runs_in_a_shell(self):
        path = self.clip(5, "a clip's \"name\" $HOME \\.mkv")
        made = dataclasses.replace(painted(key="0xffc00000", target="0xff00c000", tolerance=0.9), source=path)
        made = made.with_element(made.decomposer.with_property("strokes::list", STROKES))
        frames = self.run_in_shell(made)
        self.assertEqual(len(frames), 5)
        red, green, _ = support.color(frames[-1], 125, 40)  # the red bar
        self.assertGreater(green, red + 60)

    def test_a_painted_object_runs_in_a_shell(self):
        made, _ = select(Project(source=self.clip(3)), None)
        made = made.with_editor_behind(Element("tone1", "intrinsictone", {"look": "metal"}), "recolor1")
        frame = self.run_in_shell(made)[-1]
        red, _, blue = support.color(frame, 125, 40)
        self.assertGreater(blue, red + 60)
        for at, color in (((30, 40), (255, 255, 0)), ((100, 40), (255, 0, 255))):  # the rest stays
            self.assertLess(max(abs(a - b) for a, b in zip(support.color(frame, *at), color)), 40, at)

    def test_a_recording_with_depth_runs_in_a_shell(self):
        made = Project(source=self.recording("my room"))
        self.assertGreater(blocks(source.parse(made.source).line), 100)
        self.assertIsNone(blocks(source.parse(self.clip(3)).line))
        self.assertEqual(len(self.run_in_shell(made)), 4)
        project.save(made, self.path("p.json"))
        self.assertEqual(project.load(self.path("p.json")), made)

    @unittest.skipUnless(Gst.ElementFactory.find("avenc_ffv1"), "gstreamer1.0-libav is missing")
    def test_a_file_with_depth_runs_in_a_shell(self):
        path, room = self.path("room.mkv"), "rgbdtestsrc is-live=false samples=1 num-buffers=4"
        size = "width=160,height=120,framerate=10/1"
        support.run_line(f"matroskamux name=mux ! filesink location={path} "
                         f"{room} show=depth max-depth=60 ! video/x-raw,format=GRAY16_LE,{support.LINEAR},{size} ! "
                         f"avenc_ffv1 ! queue ! mux. {room} ! video/x-raw,{size} ! videoconvert ! vp8enc deadline=1 ! "
                         "queue ! mux.")
        made = Project(source=path)
        self.assertGreater(blocks(source.parse(path).line), 100)
        self.assertEqual(len(self.run_in_shell(made)), 4)

    def test_editors_that_are_off_are_left_out(self):
        made = painted()
        self.assertIn("intrinsicrecolor", launch_line.shell_text(made))
        off = made.with_element(dataclasses.replace(made.editors[0], on=False))
        self.assertNotIn("intrinsicrecolor", launch_line.shell_text(off))

    def test_the_split_view(self):
        made = dataclasses.replace(painted(key="0xffc00000", target="0xff00c000", tolerance=4.25), split=0.5,
                                   source=self.clip(3))
        frames = self.run_in_shell(made, 160)
        left, right = support.color(frames[-1], 30, 40), support.color(frames[-1], 100, 40)
        self.assertGreater(left[0], 150)  # yellow
        self.assertGreater(right[1], right[0] + 60)  # magenta was painted

    def test_it_is_what_the_program_prints(self):
        environment = {**os.environ, "PYTHONPATH": support.PLAYER}
        words = [sys.executable, "-m", "inverse_play", "test", "--decomposer", "globalintrinsic", "--edit",
                 "intrinsicdespill keep=0.5", "--show", "indirect", "--launch-line"]
        done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=60, check=True)
        line = shlex.split(done.stdout)
        for word in ("globalintrinsic", "intrinsicdespill", "keep=0.5", "show=indirect", "autovideosink"):
            self.assertIn(word, line)


class Trust(support.Case):
    """What a project file may do without a question."""

    def test_texts_that_run_or_write_are_known(self):
        effects = {(factory, name): described.effect for factory in (*elements.decomposers(), *elements.editors())
                   for name, described in elements.properties(factory).items() if described.effect}
        scenes = {(factory, "scene::location"): "writes" for factory in elements.decomposers()
                  if "scene::location" in elements.properties(factory)}
        wanted = {("intrinsicedit", "effect"): "runs", ("intrinsicedit", "decomposer"): "runs", **scenes}
        if "limematerial" in elements.decomposers():
            wanted["limematerial", "save-environment-location"] = "writes"
        self.assertEqual(effects, wanted)

    def test_demands(self):
        edit = Element("edit1", "intrinsicedit")
        for made, words in (
                (Project(source="videotestsrc ! identity"), "runs the launch line"),
                (Project(source="videotestsrc num-buffers=1"), "runs the launch line"),
                (Project(source="http://host/x"), "opens http://host/x"), (Project(source="rtsp://host/x"), "opens"),
                (Project(editors=(edit.with_property("effect", "filesink location=x"),)), "runs the elements filesink"),
                (Project(editors=(edit.with_property("decomposer", "identity"),)), "runs the elements identity"),
                (Project().with_element(Element("decomposer", "intrinsicdecomp", {"scene::location": "/x.ply"})), "writes the file /x.ply")):
            (demand,) = project.demands(made)
            self.assertIn(words, demand)
        for harmless in ("", "test", "room", "/dev/video0", "libcamera", "clip.mkv", "file:///a.mkv"):
            self.assertEqual(project.demands(Project(source=harmless)), [], harmless)
        self.assertEqual(project.demands(painted(key="0xffc00000")), [])

    def test_what_is_allowed_is_remembered_as_a_whole(self):
        one, other = ["runs a"], ["runs a", "runs b"]
        self.assertTrue(trust.is_allowed([]))
        self.assertFalse(trust.is_allowed(one))
        trust.allow(one)
        trust.allow(one)
        self.assertTrue(trust.is_allowed(one))
        self.assertFalse(trust.is_allowed(other))
        self.assertEqual(os.stat(os.path.join(trust.folder(), "allowed")).st_mode & 0o077, 0)

    def test_a_name_that_exists_as_a_file_is_a_file(self):
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)
        for name in ("Stop ! Look.mkv", "videotestsrc num-buffers=1 ! filesink location=x.mkv videotestsrc", "test", "room", "libcamera", "a:b.mkv"):
            shutil.copy(self.clip(2), name)
            opened = source.parse(name)
            self.assertIn("filesrc location=", opened.line)
            self.assertFalse(opened.live)
            os.unlink(name)
        self.assertEqual(source.parse("test").line, source.TEST_LINE)

    def test_a_list_of_streams_opens_no_connection(self):
        for name, text in (("a.m3u8", "#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\nhttp://127.0.0.1:9/x.ts\n"),
                           ("a.mp4", "#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\nhttp://127.0.0.1:9/x.ts\n"),
                           ("a.mpd", '<?xml version="1.0" encoding="UTF-8"?>\n<MPD xmlns="urn:mpeg:dash:schema:mpd:2011" type="static" ' +
                            'minBufferTime="PT2S" profiles="urn:mpeg:dash:profile:isoff-live:2011" mediaPresentationDuration="PT1S">' + 90 * '\n<Period></Period>' + '</MPD>\n'),
                           ("a.sdp", "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 5000 RTP/AVP 96\n"),
                           ("a.txt", "http://127.0.0.1:9/x\n")):
            with open(self.path(name), "w", encoding="ascii") as file:
                file.write(text)
            with self.subTest(name), self.assertRaisesRegex(source.SourceError, "list of streams"):
                source.parse(self.path(name))

    def test_a_list_within_a_file_opens_no_connection(self):
        listed = Listed(self)
        for name in listed.write(self.path("")):
            with self.subTest(name), self.assertRaisesRegex(source.SourceError, f"{name} is a list of streams"):
                source.parse(self.path(name))
        listed.expect_no_connection(self)


class CommandLine(support.Case):
    def run_it(self, *words):
        environment = {**os.environ, "PYTHONPATH": support.PLAYER}
        return subprocess.run([sys.executable, "-m", "inverse_play", *words], env=environment, capture_output=True,
                              text=True, timeout=60, check=False)

    def test_errors_say_what_to_do(self):
        open(self.path("empty.mp4"), "w", encoding="utf-8").close()
        cases = ((["/none.mp4"], "there is no file"), (["/dev/video97"], "plug it in"),
                 ([self.folder], "is no recording"), ([self.path("empty.mp4")], "is empty"),
                 (["nosuch://x"], "nothing installed here opens"),
                 (["videotestsrc ! nosuchelement"], "no launch line"),
                 (["test", "--decomposer", "videoconvert"], "intrinsicdecomp"),
                 (["test", "--edit", "intrinsicrecolor tolerance=99"], "tolerance"),
                 (["test", "--edit", "intrinsicrecolor nothing=1"], "it has key"),
                 (["test", "--show", "direct"], "globalintrinsic"),
                 (["test", "--split", "7"], "from 0 to 1"), (["--project", "/none.json"], "there is no file /none.json"),
                 (["test", "--folder", "/none"], "no folder"))
        with futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            all_done = pool.map(lambda case: self.run_it(*case[0]), cases)
        for (words, text), done in zip(cases, all_done):
            self.assertEqual(done.returncode, 1, words)
            self.assertIn(text, done.stderr, words)
            self.assertNotIn("Traceback", done.stderr, words)
        self.assertEqual(self.run_it("--launch-line").returncode, 2)
        self.assertEqual(self.run_it("--nothing").returncode, 2)

    def test_help_names_all_options(self):
        text = self.run_it("--help").stdout
        for action in arguments.parser()._actions:
            self.assertIn((action.option_strings or [action.metavar])[-1], text)

    def test_sources(self):
        self.assertTrue(source.parse("test").live and source.parse("room").live)
        self.assertTrue(source.parse("rgbdtestsrc path=table hand=book").live)
        self.assertFalse(source.parse("rgbdtestsrc is-live=false path=table").live)
        self.assertFalse(source.parse(str(support.CLIP)).live)
        self.assertEqual(source.parse(support.CLIP.as_uri()).line, source.parse(str(support.CLIP)).line)
        self.assertIn("imagefreeze", source.parse(str(support.ROOT / "media" / "layers.png")).line)
        self.assertEqual(source.parse("videotestsrc pattern=ball").line, "videotestsrc pattern=ball")


if __name__ == "__main__":
    unittest.main()
