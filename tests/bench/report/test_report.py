#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks the report's arithmetic where the answer is known."""
import math
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import ablations
import against
import brief
import intervals
import light
import summary
import tables


def row(setting, times, error, scene="a", **more):
    return {"method": "m", "curve": "c", "setting": setting, "order": 0, "preset": "", "base": False, "parameters": {},
            "against": "", "device": "gpu", "set": "own", "scene": scene, "regime": "r", "video": False, "width": 320,
            "height": 240, "frames": 1, "wall_ms": list(times), "processor_ms": list(times),
            "device_ms": list(times), "stages_ms": {},
            "lmse20": [error], **more}


def results(*rows):
    return {"methods": {"m": {"family": "method"}, "p": {"family": "peer"}},
            "rows": [summary.condensed(r) for r in rows]}


class Summary(unittest.TestCase):
    def test_quartiles(self):
        self.assertEqual(summary.quartiles([4, None, 1, 3, 2, 5]), [2, 3, 4, 5])
        self.assertEqual(summary.quartiles([7]), [7, 7, 7, 1])
        self.assertIsNone(summary.quartiles([None]))

    def test_passes_are_joined(self):
        first, second = row("1", [1, 2], 0.5), row("1", [3], 0.5)
        del second["lmse20"]
        joined = summary.merged([{"rows": [first]}, {"rows": [second]}])
        self.assertEqual(len(joined), 1)
        self.assertEqual(joined[0]["wall_ms"], [1, 2, 3])
        self.assertEqual(joined[0]["lmse20"], [0.5])

    def test_scenes_weigh_the_same_and_times_are_for_one_size(self):
        large = row("1", [40], 0.3, scene="b", width=640, height=480)
        points = summary.points(results(row("1", [10], 0.1), large)["rows"])
        self.assertEqual(len(points), 1)
        self.assertAlmostEqual(points[0]["lmse20"], 0.2)
        self.assertAlmostEqual(points[0]["wall_ms"][1], 10)

    def test_settings_that_miss_a_scene_are_left_out(self):
        rows = results(row("1", [10], 0.1), row("1", [10], 0.3, scene="b"), row("2", [10], 0.1))["rows"]
        self.assertEqual([p["setting"] for p in summary.points(rows)], ["1"])

    def test_front_is_what_nothing_beats(self):
        rows = results(row("slow good", [4], 0.1), row("fast bad", [1], 0.4), row("beaten", [5], 0.2),
                       row("between", [2], 0.2))["rows"]
        self.assertEqual([p["setting"] for p in summary.front(summary.points(rows), "lmse20")],
                         ["fast bad", "between", "slow good"])

    def test_knee_is_farthest_below_the_line(self):
        curve = [{"setting": n, "wall_ms": [t, t, t], "e": e}
                 for n, t, e in [("a", 1, 1), ("b", 2, 0.2), ("c", 10, 0.15), ("d", 100, 0.1)]]
        self.assertEqual([p["setting"] for p in summary.knee(curve, "e")], ["b"])
        self.assertEqual(summary.knee(curve[:2], "e"), [])

    def test_ratio_of_pairs(self):
        low, middle, high = summary.bootstrap_ratio([1, 2, 3, 4] * 5, [2, 4, 6, 8] * 5)
        self.assertEqual((low, middle, high), (0.5, 0.5, 0.5))
        self.assertIsNone(summary.bootstrap_ratio([None], [1]))

    def test_adaptivity_compares_with_whom_it_says(self):
        off, on = row("off", [10, 20, 30], 0.1), row("on", [5, 10, 15], 0.2, against="c/off")
        entry, = summary.adaptivity([off, on])
        self.assertEqual(entry["wall_ratio"][1], 0.5)
        self.assertAlmostEqual(entry["lmse20_added"], 0.1)
        self.assertNotIn("tint_added", entry)

    def test_errors_of_light_are_added_up_where_a_method_tells_it(self):
        off = row("off", [10, 20, 30], 0.1, tint=[0.2, 0.4], indJ=[0.5])
        rows = [off, row("on", [5, 10, 15], 0.2, against="c/off", curve="adaptive", tint=[0.1, 0.2], indJ=[0.5]),
                row("light", [10, 20, 30], 0.1003, against="c/off", curve="adaptive")]
        entries = summary.adaptivity(rows)
        self.assertAlmostEqual(entries[0]["tint_added"], -0.15)
        text = tables.adaptivity(entries)
        self.assertIn("flicker added | `tint` added | `indJ` added |", text)
        self.assertIn("| +.1000 | – | −.1500 | 0 |", text)
        self.assertNotIn("tint", tables.adaptivity([{k: v for k, v in e.items() if k not in ("tint_added", "indJ_added")} for e in entries]))
        self.assertIn("| a: r | +.1000 | +.0003 |", tables.by_parts(entries, "lmse20_added", tables.left_out_where))


class ThroughElements(unittest.TestCase):
    def test_ratios_are_of_the_same_scene_and_size(self):
        def sample(setting, times, width=640, element="intrinsicdecomp"):
            return {"element": element, "scene": "ball", "width": width, "height": 480, "frames": 3, "setting": setting, "wall_ms": times, "processor_ms": times}
        rows = [sample("off", [10, 20, 30]), sample("on", [1, 2, 3]), sample("tiles", [5, 10, 15]), sample("on", [1, 1, 1], 1280)]
        other = [sample("off", [2, 2], element="globalintrinsic"), sample("on", [1, 1], element="globalintrinsic")]
        both = summary.against_off(rows + other)
        self.assertEqual([(e["element"], e["pairs"]) for e in both], [("intrinsicdecomp", 3)] * 2 + [("globalintrinsic", 2)])
        self.assertAlmostEqual(both[2]["processor_ratio"][1], 0.5)
        self.assertIn("| `globalintrinsic` | ball | 640×480 | 2 | 2.0 → 1.0 |", tables.through_elements(both))
        self.assertIn("| all | .10 |\n", tables.parts_of_elements(both))  # only of the element of which parts were measured
        found = summary.against_off(rows)
        self.assertEqual([e["setting"] for e in found], ["on", "tiles"])
        self.assertAlmostEqual(found[0]["processor_ratio"][1], 0.1)
        self.assertEqual(found[0]["wall_ms"], [20, 2])
        self.assertEqual(tables.times_faster(found[0]["processor_ratio"]), "**10.0×**")
        self.assertEqual(tables.times_faster(found[1]["processor_ratio"]), "2.0×")
        text = tables.by_parts(found, "processor_ratio", tables.left_out_where)
        self.assertIn("| ball, 640×480, element | .10 | .50 |", text)
        rest = {**found[1], "setting": "all but tiles", "processor_ratio": [0.2, 0.25, 0.3]}
        self.assertIn("| tiles | .50 / .25 |", tables.parts_of_elements(found + [rest]))
        self.assertEqual(tables.parts_of_elements(found[:1]), "")
        whole = {**found[0], "scene": "noise"}
        self.assertNotIn("noise", tables.by_parts(found + [whole], "processor_ratio", tables.left_out_where))
        self.assertEqual(tables.by_parts(found[:1], "processor_ratio", tables.left_out_where), "")


class Light(unittest.TestCase):
    def rows(self):
        def one(method, curve, setting, error, group="cornell", base=False, **more):
            return row(setting, [1], error, **{"method": method, "curve": curve, "set": group, "base": base, "lmse20_R": [error],
                                               "mse_R": [error], **more})
        thesis = light.THESIS
        some = [one("intrinsicdecomp", "quality", "4", 0.4, base=True), one("intrinsicdecomp", "cycles", "8", 0.1),
                one("gray Retinex", "thresholds", "t .1", 0.5), one("gray Retinex", "thresholds", "t .2", 0.3),
                one(thesis, "quality", "5x16", 0.3, base=True, base_before=[0.1, None, 0.3], base_after=[0.4], misclustered=[0.25],
                    layers=[8]),
                one(thesis, "with", "correction", 0.2, base_before=[0.1], base_after=[0.1], misclustered=[0.01], clicks=[3, 5],
                    clicks_right=[2, 4], layers=[8]),
                one(thesis, "quality", "1x8", 0.9)]
        return [summary.condensed(r) for r in some]

    def test_tables_show_one_setting_of_a_method(self):
        found = light.by_group(self.rows())
        self.assertEqual(list(found), ["gray Retinex", "intrinsicdecomp", light.THESIS, f"{light.THESIS} with correction"])
        self.assertAlmostEqual(found["gray Retinex"]["cornell"]["lmse20_R"], 0.5)
        text = light.errors(found)
        self.assertIn("| globalintrinsicthesis with correction | **.2000** | – | – | **.2000** |", text)

    def test_base_colors_are_means_over_what_is_known(self):
        found = light.by_group(self.rows())
        self.assertAlmostEqual(found[light.THESIS]["cornell"]["base_before"], 0.2)
        self.assertIn("| cornell † | as it is | .200 | .400 | 25.0 % | – | – | 8.0 |", light.base_colors(found))
        self.assertIn("| 4.0 | 3.0 | 8.0 |", light.base_colors(found))
        self.assertIn("away from", light.verdict(found))

    def test_scenes_that_a_method_misses_are_not_compared(self):
        rows = self.rows() + [summary.condensed(row("4", [1], 0.1, scene="b", method="intrinsicdecomp", curve="quality", base=True,
                                                    set="cornell", lmse20_R=[0.1]))]
        self.assertEqual(list(light.by_group(rows)), ["intrinsicdecomp"])

    def test_costs_are_by_base_color(self):
        entries = [{"element": f"globalintrinsicthesis base-colors={k}", "layers": k, "device_bytes_per_pixel": 100 + 16 * k, "wall_ms": k,
                    "processor_ms": k} for k in (4, 8)]
        self.assertIn("| `globalintrinsicthesis` | 8 | 8 | 228 | 16 |", light.by_colors(light.of_lines(entries)))

    def test_frames_beside_background_work_are_compared_with_those_without(self):
        text = light.held_up({"times_ms": {"alone": [10, 20, 30], "refining": [40, 30, 20, 20], "correcting": []}})
        self.assertIn("1.25 times as long while base colors are refined (1 of 4 frames", text)
        self.assertNotIn("decided", text)

    def test_kept_rows_serve_where_the_thesis_was_not_measured(self):
        brief = [r for r in self.rows() if r["method"] == "intrinsicdecomp"]
        rows, kept = light.chosen({"rows": brief, "kept": {"rows": self.rows(), "commit": "x"}})
        self.assertEqual((len(rows), kept["commit"]), (5, "x"))
        rows, kept = light.chosen({"rows": self.rows(), "kept": {"rows": [], "commit": "x"}})
        self.assertIsNone(kept)


class Intervals(unittest.TestCase):
    FAMILIES = {"intrinsicdecomp": {"family": "method"}, "thesis PCG": {"family": "method"}, "filter": {"family": "peer"},
                "same energy": {"family": "peer"}, "nothing": {"family": "trivial"}}

    def rows(self, method, errors, curve="c", setting="1", preset="", regime="r", **more):
        return [{**row(setting, [1], e, scene=str(n), **more), "method": method, "curve": curve, "preset": preset, "lmse20": e,
                 "regime": regime} for n, e in enumerate(errors)]

    def test_mean_and_interval(self):
        self.assertEqual(intervals.bootstrap_mean([2, 2, 2, 2]), [2, 2, 2])
        self.assertEqual(intervals.bootstrap_mean([0, 1]), [0, 0.5, 1])  # a quarter of the draws at either end
        self.assertIsNone(intervals.bootstrap_mean([1]))
        # Of zeros and ones the mean is binomial: 50 of 100 give a deviation of .05, and 1.96 times that at either side.
        low, middle, high = intervals.bootstrap_mean([0, 1] * 50)
        self.assertEqual(middle, 0.5)
        self.assertAlmostEqual(low, 0.402, delta=0.015)
        self.assertAlmostEqual(high, 0.598, delta=0.015)
        self.assertEqual(intervals.bootstrap_mean([0, 1] * 50), [low, middle, high])

    def test_differences_are_paired(self):
        # Scenes differ by far more than methods do, and yet there is no doubt.
        ours, theirs = {n: 10.0 * n for n in range(6)}, {n: 10.0 * n + 1 + n / 10 for n in range(6)}
        d = intervals.differences(ours, theirs)
        self.assertAlmostEqual(d["mean"], -1.25)
        self.assertTrue(-1.5 <= d["interval"][0] < d["interval"][1] < d["interval"][2] <= -1)
        self.assertEqual((d["better"], d["scenes"], d["separated"]), (6, 6, True))
        self.assertTrue(intervals.differences(theirs, ours)["separated"])
        self.assertFalse(intervals.differences({0: 1, 1: 3, 2: 1}, {0: 2, 1: 2, 2: 2})["separated"])
        self.assertIsNone(intervals.differences({0: 1, 1: 1}, {0: 2, 1: 2})["separated"])
        self.assertIsNone(intervals.differences({0: 1}, {1: 1}))

    def test_by_regime(self):
        rows = (self.rows("intrinsicdecomp", [0.1, 0.2, 0.3], preset="medium") +
                self.rows("intrinsicdecomp", [0.0, 0.0, 0.0], setting="2", preset="best") +
                self.rows("intrinsicdecomp", [9, 9, 9], preset="medium", video=True) +
                self.rows("thesis PCG", [0.2, 0.3, 0.4], preset="medium") +
                self.rows("filter", [0.3, 0.3, 0.3]) + self.rows("filter", [0.1, 0.1, 0.1], setting="2") +
                self.rows("nothing", [0.0, 0.0], setting="") +  # misses a scene
                self.rows("same energy", [0.0, 0.0, 0.0], curve="tolerance") +
                self.rows("intrinsicdecomp", [0.5], preset="medium", regime="other"))
        found = intervals.by_regime(rows, self.FAMILIES)
        self.assertEqual(list(found), ["r", "other"])
        entry = found["r"]
        self.assertAlmostEqual(entry["mean"], 0.2)
        self.assertAlmostEqual(entry["minus_thesis"]["mean"], -0.1)
        self.assertTrue(entry["minus_thesis"]["separated"])
        self.assertEqual((entry["baseline"]["method"], entry["baseline"]["setting"]), ("filter", "2"))
        self.assertAlmostEqual(entry["minus_baseline"]["mean"], 0.1)
        self.assertEqual((entry["minus_baseline"]["better"], entry["minus_baseline"]["separated"]), (0, False))
        self.assertIsNone(found["other"]["interval"])
        self.assertNotIn("baseline", found["other"])
        text = tables.by_regime_intervals(found)
        self.assertIn("| r | .2000 [.1000, .3000] | −.1000 [−.1000, −.1000] | 3 of 3 | yes | filter 2: .1000 | "
                      "+.1000 [0, +.2000] | 0 of 3 | no |", text)
        self.assertIn("| other | .5000 | – | – | – | – | – | – | – |", text)


class Ablations(unittest.TestCase):
    def ours(self, curve, setting, errors, time=10, regimes="rrs", **more):
        return [{**row(setting, [time], e, scene=str(n), **more), "method": "intrinsicdecomp", "curve": curve, "lmse20": e,
                 "regime": regimes[n], "processor_ms": [time] * 3 + [1]} for n, e in enumerate(errors)]

    def test_errors_by_regime_and_time(self):
        whole = self.ours("quality", "4", [0.1, 0.3, 0.5])
        for r in whole:
            r["base"] = True
        rows = whole + self.ours("without", "chroma", [0.2, 0.4, 0.4], time=8) + self.ours("weights", "b v g", [9, 9, 9])
        found = ablations.stills(rows, "intrinsicdecomp", "processor_ms")
        self.assertEqual([e["term"] for e in found], ["", "chroma"])
        self.assertAlmostEqual(found[0]["errors"]["r"], 0.2)
        self.assertAlmostEqual(found[1]["errors"]["r"], 0.3)
        self.assertEqual(found[0]["scenes"], {"r": 2, "s": 1})
        self.assertAlmostEqual(found[1]["time"], 0.8)
        text = tables.without(found)
        self.assertIn("| LMSE (k = 20) | r (2) | s (1) | time |", text)
        self.assertIn("| without chroma | .3000 (+50 %) | .4000 (−20 %) | −20 % |", text)
        self.assertEqual(ablations.stills(whole, "intrinsicdecomp", "processor_ms"), [])

    def test_weights_are_chosen_without_the_scene(self):
        # Twice the value weight is best on scene 0 alone, by so much that it would be chosen with it.
        rows = (self.ours("weights", "b v g", [0.5, 0.2, 0.2], regimes="rrr") +
                self.ours("weights", "b v·2 g", [0.0, 0.3, 0.3], regimes="rrr"))
        found = ablations.leave_one_out(rows)
        entry = found["regimes"]["r"]
        self.assertAlmostEqual(entry["ships"], 0.3)
        self.assertAlmostEqual(entry["best"], 0.2)
        self.assertAlmostEqual(entry["left_out"], (0.5 + 0.3 + 0.3) / 3)
        self.assertEqual(found["picks"], {"b v g": 1, "b v·2 g": 2})
        self.assertIsNone(ablations.leave_one_out(rows[:1]))
        self.assertIn("| r (3) | .3000 | .3667 | .2000 |", tables.left_out(found))


class Page(unittest.TestCase):
    METHODS = {"guess": {"family": "trivial"}, "global": {"family": "method"}}

    def layers(self, method, preset, **errors):
        return {**row("1", [1], 0.1), "method": method, "preset": preset, "dirJ": 0.5, "tint": 0.5, "indJ": 0.5, **errors}

    def test_layers_beyond_two_wait_for_a_method(self):
        guess, ours = self.layers("guess", "", ind=0.2), self.layers("global", "medium", ind=0.1)
        self.assertEqual(tables.layers_beyond_two([guess], self.METHODS), "")
        odd = {**self.layers("global", "", ind=0.05), "setting": "2"}  # neither preset nor default: not shown
        text = tables.layers_beyond_two([guess, ours, odd], self.METHODS)
        self.assertIn("| global `medium` | .1000 | **.1000** |", text)
        self.assertNotIn(".0500", text)
        self.assertIn("| guess: 1 | .2000 | .2000 |", text)

    def test_means_of_layers_are_over_all_scenes_or_none(self):
        rows = [self.layers("global", "medium", ind=0.1), {**self.layers("global", "medium", ind=0.3), "scene": "other"},
                {**self.layers("global", "", ind=0.2), "curve": "without", "setting": "tint"}]
        text = tables.layers_beyond_two(rows, self.METHODS)
        self.assertIn("| global `medium` | .2000 | **.1000** | **.3000** |", text)
        self.assertIn("| global without tint | – | .2000 | – |", text)

    def test_devices_are_columns(self):
        def points(device, time):
            return [{"device": device, "method": "intrinsicdecomp", "curve": "quality", "setting": "4", "preset": "medium",
                     "base": True, "wall_ms": [time] * 3, "device_ms": [time] * 3, "lmse20": 0.1}]
        results = {"device": "llvmpipe (LLVM)", "summary": {"own": points("llvmpipe (LLVM)", 10)}}
        self.assertIn("One device so far", tables.by_device(results))
        results["others"] = [{"device": "a GPU", "points": points("a GPU", 1)}]
        text = tables.by_device(results)
        self.assertIn("llvmpipe: ms | llvmpipe: device ms | llvmpipe: LMSE | a GPU: ms", text)
        self.assertIn("| intrinsicdecomp `medium` | 10.0 | 10.0 | .1000 | 1.0 | 1.0 | .1000 |", text)

    def test_earlier_sizes_are_kept_and_marked(self):
        def element(width):
            return {"element": "e", "width": width, "height": 1, "wall_ms": 1, "processor_ms": 1, "device_ms": 1,
                    "first_frame_ms": 1, "device_bytes_per_pixel": 1}
        found = tables.all_elements({"elements": [element(320)], "kept": {"elements": [element(1920)]}})
        self.assertIn("| `e` | 320×1 | 1.0", tables.elements(found))
        self.assertIn("| `e` | 1920×1* | 1.0", tables.elements(found))
        self.assertEqual(len(tables.all_elements({"elements": [element(320)]})), 1)


class Training(unittest.TestCase):
    def test_training_sets_are_marked_once(self):
        rows = [{"set": "room", "regime": "r"}, {"set": "mit", "regime": "r"}]
        once = summary.marked(rows)
        self.assertEqual([r["regime"] for r in once], ["r †", "r"])
        self.assertEqual(summary.marked(once), once)
        self.assertEqual(tables.given_video({"set": "room", "scene": "noise"}), "room †, noise")


class Drift(unittest.TestCase):
    def test_pictures_count_once_a_method_and_motion(self):
        def row(picture, drift):
            return {"picture": picture, "motion": "pan", "method": "m", "drift": drift, "input": 0.01}
        own, photographs = brief.drift_of([row("own-a", 0.02), row("own-b", 0.04), row("c", 0.5)])
        self.assertEqual((own["count"], own["within"], own["worst"]), (2, 1, 0.04))
        self.assertAlmostEqual(own["mean"], 0.03)
        self.assertEqual((photographs["pictures"], photographs["within"]), ("photographs", 0))


class Brief(unittest.TestCase):
    FOLDER = pathlib.Path(__file__).resolve().parents[3] / "docs/report"

    def test_the_committed_page_is_that_of_its_figures(self):
        found = json.loads((self.FOLDER / "figures.json").read_text())
        self.assertEqual(brief.page(found), (self.FOLDER / "README.md").read_text())

    def test_training_sets_are_apart(self):
        found = json.loads((self.FOLDER / "figures.json").read_text())
        self.assertIn("hard shadow †", found["regimes"])
        self.assertEqual(set(found["by_scene"]), {"patches", "sculptures", "still life", "toys"})


class Against(unittest.TestCase):
    def lines(self, before, after):
        return "\n".join(against.compare(before, after))

    def test_noise_is_no_news(self):
        text = self.lines(results(row("1", [9, 10, 11], 0.1)), results(row("1", [9.5, 10.4, 11.5], 0.1)))
        self.assertIn("0 worse, 0 better", text)

    def test_slower_and_worse(self):
        text = self.lines(results(row("1", [9, 10, 11], 0.1)), results(row("1", [18, 20, 22], 0.2)))
        self.assertIn("wall time × 2.00", text)
        self.assertIn("lmse20 0.1000 → 0.2000", text)
        self.assertIn("3 worse, 0 better", text)  # by the clock, by the device's, and the error

    def test_the_clock_of_a_busy_machine_is_no_news(self):
        before, after = results(row("1", [9, 10, 11], 0.1)), results(row("1", [18, 20, 22], 0.1))
        after["machine"] = {"load_before": 6, "load_after": 5}
        text = self.lines(before, after)
        self.assertNotIn("wall time", text)
        self.assertIn("clocks are not compared", text)
        self.assertIn("device time × 2.00", text)

    def test_tells_what_is_new_and_what_is_gone(self):
        text = self.lines(results(row("1", [1], 0.1), row("2", [1], 0.1)), results(row("1", [1], 0.1), row("3", [1], 0.1)))
        self.assertIn("gone: m, c 2", text)
        self.assertIn("new: m, c 3", text)

    def test_a_slower_machine_is_no_news(self):
        def peers(time):
            return [row("1", [time] * 3, 0.1, scene=str(n), method="p", device="processor") for n in range(6)]
        before = results(row("1", [9, 10, 11], 0.1), *peers(5))
        after = results(row("1", [18, 20, 22], 0.1), *peers(10))
        self.assertIn("0 worse, 0 better", self.lines(before, after))


unittest.main()
