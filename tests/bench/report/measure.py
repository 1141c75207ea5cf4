"""Runs the measuring programs of a build folder and gathers what they say into one dictionary."""
import json
import os
import pathlib
import platform
import subprocess

import summary


class Failed(RuntimeError):
    pass


spent = {}  # processor seconds of programs, by part


def follow(arguments, progress, **environment):
    """Runs a program whose standard error has lines '@progress SHARE TEXT'; others are shown if it fails."""
    said = []
    before = os.times()
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
    out = subprocess.run([str(importer), str(data), str(folder), "--frames", "0" if full else "1"] +
                         (["--videos"] if full else []), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if out.returncode:
        raise Failed(out.stderr)
    return ", ".join(out.stdout.split("\n")).strip(", ")


def run(build, work, data, full, progress, only):
    """Everything that is measured, as results.json has it."""
    programs = build / "tests" / "bench"
    for stale in list(work.glob("scenes-*/*.f32")) + list(work.glob("layers/*.f32")):
        stale.unlink()
    own = work / "scenes-own"
    other = work / "scenes-other"
    own.mkdir(parents=True, exist_ok=True)
    for scene in (programs / "scenes").glob("*.f32"):
        (own / scene.name).symlink_to(scene.resolve())
    results = {"machine": machine(), "full": full}

    progress.begin("data")
    results["data"] = import_data(programs, data, other, full)

    passes = []
    options = ["--converged", work / "converged", "--layers", work / "layers"] + (["--full"] if full else [])
    for name in only:
        options += ["--only", name]
    runners = ["bench-methods"] + (["bench-peers"] if (programs / "bench-peers").exists() else [])
    # Programs take turns, so that what disturbs the machine disturbs all alike.
    for number in range(3 if full else 2):
        for runner in runners:
            for folder in [own] + ([other] if number == 0 and any(other.glob("*.f32")) else []):
                progress.begin(f"{runner} {folder.name} {number}")
                out = work / f"{runner}-{folder.name}-{number}.json"
                follow([programs / runner, "--data", folder, "--out", out, "--rounds", "2"] + options +
                       (["--brief"] if number else []), progress)
                passes.append(json.loads(out.read_text()))
    results["device"] = passes[0]["device"]
    results["methods"] = {m["name"]: m for p in passes for m in p["methods"]}
    rows = summary.merged(passes)
    results["adaptivity"] = summary.adaptivity(rows)
    results["rows"] = [summary.condensed(r) for r in rows]

    progress.begin("elements")
    results["elements"] = []
    more = ",1920x1080"
    for element, sizes in (("intrinsicdecomp", "320x240,640x480,1280x720" + (more if full else "")),
                           ("intrinsicdecompthesis", "320x240,640x480" + (",1280x720" + more if full else ""))):
        out = work / "elements.json"
        follow([programs / "element-bench", "--sizes", sizes, "--frames", "40" if full else "12", "--rounds",
                "3" if full else "1", "--json", out, element], progress,
               GST_PLUGIN_PATH=str(build / "gst"), GST_REGISTRY=str(work / "registry.bin"))
        results["elements"] += json.loads(out.read_text())

    progress.begin("duplicate frames")
    results["duplicates"] = []
    for line in ("intrinsicdecomp adaptive=false", "intrinsicdecomp"):
        out = work / "elements.json"
        follow([programs / "element-bench", "--still", "--sizes", "640x480", "--frames", "24", "--rounds", "1", "--json", out,
                line], progress, GST_PLUGIN_PATH=str(build / "gst"), GST_REGISTRY=str(work / "registry.bin"))
        results["duplicates"] += json.loads(out.read_text())

    progress.begin("extremes")
    extremes = build / "tests" / "extremes" / "extremes"
    results["extremes"] = None
    if extremes.exists():
        out = work / "extremes.json"
        out.unlink(missing_ok=True)
        follow([extremes, "--report", out], progress)
        if out.exists():
            results["extremes"] = json.loads(out.read_text())
    results["processor_seconds"] = {name: round(seconds, 1) for name, seconds in spent.items()}
    results["machine"]["load_after"] = os.getloadavg()[0]
    return results


def parts(full):
    """Names and relative durations, for the progress bar."""
    yield "data", 2
    for number in range(3 if full else 2):
        yield f"bench-methods scenes-own {number}", 25 if number == 0 else 9
        if number == 0:
            yield f"bench-methods scenes-other {number}", 200 if full else 15
        yield f"bench-peers scenes-own {number}", 12 if number == 0 else 6
        if number == 0:
            yield f"bench-peers scenes-other {number}", 100 if full else 10
    yield "elements", 10
    yield "duplicate frames", 3
    yield "extremes", 5
    yield "plots and page", 8


def write(results, path):
    """JSON with one row a line, so that differences are readable."""
    rows = ",\n".join("  " + json.dumps(r, separators=(",", ":")) for r in results["rows"])
    head = {k: v for k, v in results.items() if k != "rows"}
    text = json.dumps(head, indent=1)
    path.write_text(text[:-2] + ',\n "rows": [\n' + rows + "\n ]\n}\n")
