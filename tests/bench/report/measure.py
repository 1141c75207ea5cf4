# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the measuring programs of a build folder and gathers what they say into one dictionary."""
import json
import os
import pathlib
import platform
import subprocess
import time

import summary
import whdr


class Failed(RuntimeError):
    pass


spent, took = {}, {}  # processor seconds of programs, and seconds on the clock, by part


def follow(arguments, progress, **environment):
    """Runs a program whose standard error has lines '@progress SHARE TEXT'; others are shown if it fails."""
    said = []
    before, start = os.times(), time.monotonic()
    with subprocess.Popen([str(a) for a in arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env={**os.environ, **environment}) as process:
        for line in process.stderr:
            if line.startswith("@progress "):
                _, share, text = line.rstrip().split(" ", 2)
                progress.update(float(share), text)
            else:
                said.append(line)
        out = process.stdout.read()
    after = os.times()
    spent[progress.part] = (spent.get(progress.part, 0) + after.children_user + after.children_system -
                            before.children_user - before.children_system)
    took[progress.part] = took.get(progress.part, 0) + time.monotonic() - start
    if process.returncode:
        raise Failed(f"{arguments[0]} failed (exit status {process.returncode}):\n{''.join(said[-20:])}{out[-2000:]}")
    return out


def first_line(path, key):
    for line in pathlib.Path(path).read_text().splitlines():
        if line.startswith(key):
            return line.split(":", 1)[1].strip()
    return ""


def machine():
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], stdout=subprocess.PIPE, text=True,
                            stderr=subprocess.DEVNULL).stdout.strip()
    return {"processor": first_line("/proc/cpuinfo", "model name"), "cores": os.cpu_count(),
            "system": platform.platform(), "commit": commit, "load_before": os.getloadavg()[0]}


def import_data(programs, data, folder, full):
    """Turns ground truth in the folder `data` into flat dumps; returns a line for the page."""
    if not data.is_dir():
        return f"`{data}` is not here: skipped"
    importer = programs / "import-scenes"
    if not importer.exists():
        return f"`{data}` skipped, as OpenCV was not found when this was built"
    out = subprocess.run([str(importer), str(data), str(folder), "--frames", "2" if full else "1"] +
                         (["--videos"] if full else []), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if out.returncode:
        raise Failed(out.stderr)
    return ", ".join(out.stdout.split("\n")).strip(", ")


def split_videos(folder, videos):
    """Moves the dumps of videos to a folder of their own."""
    videos.mkdir(exist_ok=True)
    for path in folder.glob("*.f32"):
        with path.open("rb") as dump:
            if b" video=1" in dump.readline():
                path.rename(videos / path.name)


def stills(pictures):
    """Those that are no video."""
    for path in pictures:
        if path.suffix != ".f32" or b" video=1" not in path.open("rb").readline():
            yield path


class Parts:
    """What is measured, one program run after another. With `resume` what an earlier, interrupted run of the same programs
    with the same options has finished is not run again. A part that fails is noted, and the others go on."""

    def __init__(self, work, progress, resume):
        self.work, self.progress, self.resume = work, progress, resume
        self.failures = []

    def measure(self, name, program, arguments, timeless=False, **environment):
        """What `program` writes to the file that it gets after `arguments`; None where it fails. What is `timeless` is
        taken from any earlier run of the same program."""
        out = self.work / (name.replace(" ", "-") + ".json")
        mark = out.with_suffix(".done")
        key = json.dumps([str(program), program.stat().st_mtime, [str(a) for a in arguments]])
        self.progress.begin(name)
        if not ((self.resume or timeless) and mark.exists() and mark.read_text() == key):
            mark.unlink(missing_ok=True)
            out.unlink(missing_ok=True)
            try:
                # A machine at work on other things takes its time; who waits for it is no error here.
                follow([program, *arguments, out], self.progress, **{"INVERSE_TIMEOUT": "600", **environment})
            except Failed as failure:
                self.failures.append({"part": name, "why": str(failure)})
                return None
            mark.write_text(key)
        return json.loads(out.read_text())


def scene_parts(programs, own, given, videos, full):
    """(name, program, folder, arguments) of the programs that measure methods on scenes, in the order in which they run.
    With --full they take turns several times, so that what disturbs the machine for a while disturbs all alike."""
    runners = ["bench-methods"] + (["bench-peers"] if (programs / "bench-peers").exists() else [])
    for number in range(2 if full else 1):
        for folder in [own, given, videos] if number == 0 else [own]:
            for runner in runners:
                if any(folder.glob("*.f32")):
                    yield f"{runner} {folder.name} {number}", programs / runner, folder, ["--brief"] if number else []


LARGE = "1280x720,1920x1080"
ELEMENTS = {  # by line: sizes always, and those of --full
    "intrinsicdecomp": ("320x240,640x480," + LARGE, "640x512"),
    "globalintrinsic": ("320x240,640x480", "640x512," + LARGE),
    "intrinsicdecompthesis": ("320x240", "640x480,640x512," + LARGE),
    "intrinsicdecomp quality=low": ("", "320x240,640x480," + LARGE),
    "globalintrinsicthesis": ("", "160x120,320x240,640x512")}
ADAPTIVE = ["intrinsicdecomp", "globalintrinsic"]  # for which skipping is measured
UNMEASURED = {"intrinsicdecomp": 24, "globalintrinsic": 56}  # frames until a picture that comes again is kept
COLORS = [1, 2, 4, 8, 12, 16]  # base colors, for what each costs
BY_COLORS = {"globalintrinsicthesis": "globalintrinsicthesis tuning=tau-merge=0:tau-neutral=0 base-colors={}",
             "globalintrinsic with layers of light": "globalintrinsic tuning=base-colors={} ! intrinsiccompose"}


def element_parts(full):
    """(name, program, arguments) of what is measured through the elements, by where its results go."""
    parts = {"elements": [], "by_colors": [], "still": []}
    for line, (always, more) in ELEMENTS.items():
        sizes = ",".join(x for x in (always, more if full else "") if x)
        if sizes:
            slow = "globalintrinsicthesis" in line
            parts["elements"].append((f"elements {line}", "element-bench", [
                "--sizes", sizes, "--frames", "40" if full and not slow else "8", "--rounds",
                "2" if full and not slow else "1", line, "--json"]))
    if full:
        for name, line in BY_COLORS.items():
            parts["by_colors"].append((f"base colors {name}", "element-bench", [
                "--sizes", "320x240", "--frames", "12", "--rounds", "1", *(line.format(k) for k in COLORS), "--json"]))
    for element in ADAPTIVE:
        unmeasured = UNMEASURED[element]
        sizes = {"640x480": ["--frames", str(unmeasured + 16), "--brief"]}
        if full:
            shown = ["--frames", str(unmeasured + 20)]
            sizes = {"640x480": [*shown, "--whole", "124"],
                     "1280x720": [*shown, "--whole", "88"]}
        for size, more in sizes.items():
            parts["still"].append((f"adaptive {element} {size}", "adaptive-bench",
                                   ["--element", element, "--size", size, "--unmeasured", str(unmeasured), *more, "--json"]))
    return parts


def measure_elements(parts, programs, environment, full):
    """Through the elements: by size, by base colors, and what skipping saves."""
    return {place: sum((parts.measure(name, programs / program, arguments, **environment) or [] for name, program, arguments in some), [])
            for place, some in element_parts(full).items()}


def measure_photographs(parts, programs, folder, only):
    """What each program writes about judged photographs, where there are some."""
    if not (folder / "pairs.json").exists():
        return []
    found = [parts.measure(f"{name} photographs", programs / name, ["--photographs", folder, *only, "--out"], timeless=True)
             for name in whdr.PROGRAMS if (programs / name).exists()]
    return [f for f in found if f]


def run(build, work, data, full, progress, only, resume=False):
    """Everything that is measured, as results.json has it."""
    programs = build / "tests" / "bench"
    parts = Parts(work, progress, resume)
    own, given, videos = work / "scenes-own", work / "scenes-given", work / "scenes-videos"
    environment = {"GST_PLUGIN_PATH": str(build / "gst"), "GST_REGISTRY": str(work / "registry.bin")}
    results = {"machine": machine(), "full": full}

    progress.begin("data")
    for stale in [*work.glob("scenes-*/*.f32")] + ([] if resume else [*work.glob("layers/*.f32"), *work.glob("converged/*.f32")]):
        stale.unlink()
    for folder in (own, given):
        folder.mkdir(parents=True, exist_ok=True)
    for scene in (programs / "scenes").glob("*.f32"):
        (own / scene.name).symlink_to(scene.resolve())
    results["data"] = import_data(programs, data, given, full)
    split_videos(given, videos)

    passes = []
    options = ["--rounds", "2", "--converged", work / "converged", "--layers", work / "layers"] + (["--full"] if full else [])
    only_options = [word for name in only for word in ("--only", name)]
    options += only_options
    for name, program, folder, more in scene_parts(programs, own, given, videos, full):
        found = parts.measure(name, program, ["--data", folder, *options, *more, "--out"])
        if found:
            passes.append(found)
    if not passes or not any(p["rows"] for p in passes):
        raise Failed("nothing was measured:\n" + "\n".join(f["why"] for f in parts.failures))
    results["device"] = next((p["device"] for p in passes if p["device"] != "processor"), "processor")
    results["methods"] = {m["name"]: m for p in passes for m in p["methods"]}
    rows = summary.merged(passes)
    results["rows"] = [summary.condensed(r) for r in rows]

    pictures = [*sorted(own.glob("*.f32")), *(sorted((data / "real_pairs").glob("*.png")) if full else [])]
    results["drift"] = parts.measure("drift", programs / "drift-bench", [*stills(pictures), "--json"], timeless=True)
    judged = measure_photographs(parts, programs, data / "real_pairs", only_options) if full else []
    results["photographs"] = whdr.joined(judged) if judged else None
    found = measure_elements(parts, programs, environment, full)
    results["elements"], results["by_colors"] = found["elements"], found["by_colors"]
    results["through_elements"] = summary.against_off(found["still"])
    results["failures"] = parts.failures + [f for p in passes + judged for f in p.get("failures", [])]
    results["processor_seconds"] = {name: round(seconds, 1) for name, seconds in spent.items()}
    results["part_seconds"] = {name: round(seconds, 1) for name, seconds in took.items()}
    results["machine"]["load_after"] = os.getloadavg()[0]
    results["machine"]["seconds"] = round(progress.seconds())
    return results


def weights(full):
    """How long parts take relative to each other, by how their names begin: seconds on two idle cores."""
    short = {"data": 1, "bench-methods scenes-own": 28, "bench-peers scenes-own": 5, "bench-methods scenes-given": 11,
             "bench-peers scenes-given": 5, "elements intrinsicdecomp": 4, "elements globalintrinsic": 2,
             "elements intrinsicdecompthesis": 2, "drift": 90, "adaptive": 4, "plots and page": 6}
    long = {**short, "data": 5, "drift": 600, "bench-methods scenes-own": 330, "bench-methods scenes-own 1": 8, "bench-peers scenes-own": 12,
            "bench-peers scenes-own 1": 2, "bench-methods scenes-given": 360, "bench-peers scenes-given": 45,
            "bench-methods scenes-videos": 200, "bench-peers scenes-videos": 3, "bench-methods photographs": 600, "bench-peers photographs": 60, "elements intrinsicdecomp": 30,
            "elements globalintrinsic": 45, "elements intrinsicdecomp quality=low": 13, "elements intrinsicdecompthesis": 90,
            "elements globalintrinsicthesis": 60, "base colors": 30, "adaptive intrinsicdecomp 640x480": 72, "adaptive intrinsicdecomp 1280x720": 41,
            "adaptive globalintrinsic 640x480": 25, "adaptive globalintrinsic 1280x720": 45}
    return long if full else short


def expected(full):
    """For the progress bar: those, and the parts that will come."""
    parts = ["data"]
    for number in range(2 if full else 1):
        for folder in ["own", "given", "videos"] if full and number == 0 else ["own", "given"] if number == 0 else ["own"]:
            parts += [f"{program} scenes-{folder} {number}" for program in ("bench-methods", "bench-peers")]
    parts += [name for some in element_parts(full).values() for name, _, _ in some]
    return weights(full), parts + ["drift"] + [f"{name} photographs" for name in whdr.PROGRAMS if full] + ["plots and page"]


def compact(value):
    """Figures to five digits, which is more than any is worth."""
    if isinstance(value, float):
        return float(f"{value:.5g}")
    if isinstance(value, dict):
        return {k: compact(v) for k, v in value.items()}
    return [compact(v) for v in value] if isinstance(value, list) else value


def write(results, path):
    """JSON with one row a line, so that differences are readable. Points are left out, as they follow from the rows, and so
    are stages of what is neither default nor preset."""
    rows = [{k: v for k, v in r.items() if k != "stages_ms" or r["base"] or r["preset"]} for r in results["rows"]]
    lines = ",\n".join("  " + json.dumps(compact(r), separators=(",", ":")) for r in rows)
    head = {k: compact(v) for k, v in results.items() if k not in ("rows", "summary")}
    head["summary"] = {k: compact(v) for k, v in results["summary"].items() if k not in ("own", "regimes", "videos")}
    text = ",\n".join(f' "{k}": ' + (json.dumps(v, indent=1) if k == "machine" else json.dumps(v)) for k, v in head.items())
    path.write_text("{\n" + text + ',\n "rows": [\n' + lines + "\n ]\n}\n")
