#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Checks the report's arithmetic where the answer is known."""
import math
import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import ablations
import brief
import intervals
import summary
import tables
import whdr


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

    def test_ratio_of_pairs(self):
        low, middle, high = summary.bootstrap_ratio([1, 2, 3, 4] * 5, [2, 4, 6, 8] * 5)
        self.assertEqual((low, middle, high), (0.5, 0.5, 0.5))
        self.assertIsNone(summary.bootstrap_ratio([None], [1]))



class ThroughElements(unittest.TestCase):
    def test_ratios_are_of_the_same_scene_and_size(self):
        def sample(setting, times, width=640, element="intrinsicdecomp"):
            return {"element": element, "scene": "ball", "width": width, "height": 480, "frames": 3, "setting": setting, "wall_ms": times, "processor_ms": times}
        rows = [sample("off", [10, 20, 30]), sample("on", [1, 2, 3]), sample("edges", [5, 10, 15]), sample("on", [1, 1, 1], 1280)]
        other = [sample("off", [2, 2], element="globalintrinsic"), sample("on", [1, 1], element="globalintrinsic")]
        both = summary.against_off(rows + other)
        self.assertEqual([(e["element"], e["pairs"]) for e in both], [("intrinsicdecomp", 3)] * 2 + [("globalintrinsic", 2)])
        self.assertAlmostEqual(both[2]["processor_ratio"][1], 0.5)
        found = summary.against_off(rows)
        self.assertEqual([e["setting"] for e in found], ["on", "edges"])
        self.assertAlmostEqual(found[0]["processor_ratio"][1], 0.1)
        self.assertEqual(found[0]["wall_ms"], [20, 2])
        text = brief.skipped({"through_elements": both[:1] + both[2:]})
        self.assertIn("| ball |", text.splitlines()[0])
        self.assertIn("| `intrinsicdecomp` 640×480 | 20.0 → 2.0; .100 (≤ .100) |", text)
        self.assertIn("| `globalintrinsic` 640×480 | 2.0 → 1.0; .500 (≤ .500) |", text)


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


class Photographs(unittest.TestCase):
    """Two pictures: darker points 1, E and 2 in the first, E and 1 in the other; the pair with chroma 20 is chromatic."""
    PICTURES = [{"picture": "a", "darker": "1E2", "chroma": [3, 3, 20]}, {"picture": "b", "darker": "E1", "chroma": [3, 16]}]

    def found(self, ratios, **more):
        return [{"method": "intrinsicdecomp", "curve": "quality", "setting": "4", "preset": "medium", "base": True, "picture": p, "ratios": r, **more}
                for p, r in ratios.items()]

    def pairs(self, a, b):
        [found] = whdr.methods({"pictures": self.PICTURES, "rows": self.found({"a": a, "b": b})}).values()
        return found

    def test_counted_by_hand(self):
        # 1: 1/.5 = 2, right. E: 1.2, wrong at .1 and right at .2. 2: .8, the other order. E: exact. 1: 1/.95 = 1.053, called equal at .1.
        pairs = self.pairs([0.5, 1.2, 0.8], [1, 0.95])
        self.assertAlmostEqual(whdr.whdr(pairs, 0.1), 3 / 5)
        self.assertAlmostEqual(whdr.whdr(pairs, 0.2), 2 / 5)
        self.assertAlmostEqual(whdr.whdr(pairs, 0.05), 2 / 5)
        self.assertEqual([whdr.whdr(pairs, 0.1, g) for g in whdr.GROUPS], [1 / 2, 1 / 2, 1])
        self.assertAlmostEqual(whdr.wrong_order(pairs), 1 / 3)
        self.assertAlmostEqual(whdr.rms_of_equal(pairs), math.log(1.2) / math.sqrt(2))
        self.assertEqual(whdr.by_picture(pairs, 0.1), {"a": (2, 3), "b": (1, 2)})
        self.assertEqual(whdr.scores(pairs)["best"], 0.05)
        self.assertEqual(whdr.scores(self.pairs([0.5, 1.2, 1.8], [1, 0.5]))["best"], 0.2)

    def test_at_the_threshold_points_are_equal(self):
        self.assertEqual([whdr.judgment(r, 0.25) for r in (1.25, 0.8, 1.26, 0.79)], ["E", "E", "2", "1"])

    def test_what_misses_a_picture_is_left_out(self):
        self.assertEqual(whdr.methods({"pictures": self.PICTURES, "rows": self.found({"a": [1, 1, 1]})}), {})

    def test_interval_draws_whole_pictures(self):
        self.assertEqual(intervals.bootstrap_share([(0, 1), (4, 4)]), [0, 0.8, 1])
        self.assertIsNone(intervals.bootstrap_share([(1, 2)]))

    def test_table(self):
        other = self.found({"a": [1, 1, 1], "b": [1, 1]}, method="constant reflectance", curve="only", setting="", base=False, preset="")
        found = {"pictures": self.PICTURES, "rows": self.found({"a": [0.5, 1.2, 0.8], "b": [1, 0.95]}) + other}
        text = whdr.table(found)
        self.assertIn("2 pictures, 5 pairs: 2 equal, 2 unequal achromatic, 1 unequal chromatic.", text)
        self.assertIn("| intrinsicdecomp | .600 [.500 .667] | .500 / .500 / 1.000 | .400 [0 .667] at .05 | .500 / 0 / 1.000 | .333 | .129 |", text)
        self.assertIn("| constant reflectance | 0 [0, 0] | −.200", text)
        self.assertIn("at δ = .10: a 2 of 3, b 1 of 2.", text)
        text = whdr.parts(found, "c")["photographs"]
        self.assertIn("Measured at commit c. 2 pictures, 5 pairs: ", text)
        self.assertIn("| intrinsicdecomp | .600 [.500 .667] | .400 [0 .667] | .129 |", text)
        self.assertIn("| constant reflectance | .600 [.500 .667] |", text)

    def test_variants_of_the_thesis_have_their_titles(self):
        rows = [row for curve, setting in (("without", "samples"), ("IRLS weight", "printed"), ("IRLS weight", "printed, without samples"))
                for row in self.found({"a": [1, 1, 1]}, method="thesis PCG", curve=curve, setting=setting, base=False, preset="")]
        self.assertEqual(list(whdr.titles({"rows": rows}).values()),
                         [f"thesis, chapter 3 without {what}" for what in ("p/2", "p/2, samples", "samples")])

    def test_the_tables_of_a_page_are_replaced(self):
        page = "a\n<!-- photographs -->\nold\n<!-- end -->\nb\n"
        self.assertEqual(tables.inserted(page, "photographs", "new\n"), page.replace("old", "new"))
        self.assertRaises(ValueError, tables.inserted, "a\n", "photographs", "new\n")

    def test_parts_go_to_the_pages_that_have_their_lines(self):
        with tempfile.TemporaryDirectory() as folder:
            first, second, none = (pathlib.Path(folder) / name for name in "abc")
            first.write_text("<!-- x -->\n<!-- end -->\n")
            second.write_text("<!-- y -->\nold\n<!-- end -->\n")
            none.write_text("")
            self.assertEqual(tables.pages_of(("--page", str(first), "--page", str(second), "m")), ([first, second], ("m",)))
            tables.insert([first, second], {"x": "1\n", "y": "2\n"})
            self.assertEqual(first.read_text() + second.read_text(), "<!-- x -->\n1\n<!-- end -->\n<!-- y -->\n2\n<!-- end -->\n")
            self.assertRaises(ValueError, tables.insert, [none], {"x": "1\n"})


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


class Drift(unittest.TestCase):
    def test_pictures_count_once_a_method_and_motion(self):
        def row(picture, drift):
            return {"picture": picture, "motion": "pan", "method": "m", "drift": drift, "input": 0.01, "color": drift, "input_color": 0.0}
        own, photographs = brief.drift_of([row("own-a", 0.02), row("own-b", 0.04), row("c", 0.5)])
        self.assertEqual((own["count"], own["missed"], own["worst"]), (2, ["own-b"], 0.04))
        self.assertAlmostEqual(own["mean"], 0.03)
        self.assertEqual((photographs["pictures"], photographs["missed"]), ("photographs", ["c"]))


class Brief(unittest.TestCase):
    FOLDER = pathlib.Path(__file__).resolve().parents[3] / "docs/report"

    def test_the_committed_page_is_that_of_its_figures(self):
        found = json.loads((self.FOLDER / "figures.json").read_text())
        self.assertEqual(brief.page(found), (self.FOLDER / "README.md").read_text())


    def test_a_gpu_has_a_table_of_the_sizes_that_ran(self):
        rows = [{"element": "a", "width": 64, "height": 48, "device": "D", "device_ms": 0.5, "wall_ms": 1.25},
                {"element": "b", "width": 640, "height": 480, "device": "D", "device_ms": 2, "wall_ms": 3},
                {"element": "b", "width": 64, "height": 48, "device": "D", "error": "none"}]
        text = brief.gpu({"gpu": rows})
        self.assertIn("(D;", text)
        self.assertIn("| `a` | 0.50, 1.25 | – |", text)
        self.assertIn("| `b` | – | 2.00, 3.00 |", text)
        self.assertEqual(brief.gpu({"gpu": []}), "")
        self.assertEqual(brief.gpu({}), "")


class Page(unittest.TestCase):
    def test_light_is_averaged_over_scenes_that_all_have(self):
        def one(method, scene, ind, **more):
            return {"video": False, "set": "own", "scene": scene, "method": method, "curve": "quality", "setting": "4", "base": True,
                    "ind": ind, "indJ": ind, "dirJ": ind, "tint": ind, **more}
        found = brief.light_of({"rows": [one("a", "x", 0.1), one("a", "y", 0.3), one("globalintrinsicthesis", "x", 0.5),
                                         one("globalintrinsicthesis", "y", 0.9, base=False)]})
        self.assertEqual([(n, round(ind, 6)) for n, ind, *_ in found["means"]], [("a", 0.2)])
        self.assertEqual((found["scenes"], found["thesis"]), (2, {"own stills": 0.5}))

    def test_filters_are_in_the_plot_only(self):
        point = {"curve": "c", "setting": "1", "preset": "", "base": False, "order": 0, "wall_ms": [1, 1, 1], "device_ms": None, "processor_ms": [1, 1, 1],
                 **dict.fromkeys(["lmse20", "lmse10", "mse", "dssim", "ms_ssim", "whdr"], 0.1)}
        text = tables.all_methods([{**point, "method": "guided filter"}, {**point, "method": "gray Retinex"}],
                                  {"guided filter": {"family": "peer"}, "gray Retinex": {"family": "peer"}})
        self.assertNotIn("guided", text)
        self.assertIn("| gray Retinex 1 | 1.0 (1…1) | .1000 |", text)


unittest.main()
