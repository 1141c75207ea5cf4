#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Prints what failed and what was skipped in the last `meson test` of build folders, and as the last line
"N passed, N failed". Exit status 1 where one failed or none ran.

The cases of GoogleTest programs count one by one. A program that ended badly without a failed case (a crash, a
timeout, a leak found at its end) counts as one failure more.
"""
import collections
import json
import pathlib
import re
import sys
import xml.etree.ElementTree as ET

Cases = collections.namedtuple("Cases", "passed failed skipped")


def last_lines(text, count=3):
    """The end of what a failed test said, indented below its name."""
    return "".join("\n    " + line[:160] for line in (text or "").strip().splitlines()[-count:])


def running(text):
    """The case of GoogleTest that a program which ended badly was running, for its line; empty without one."""
    found = re.findall(r"^\[ RUN      \] (\S+)", text or "", re.M)
    return f" in {found[-1]}" if found else ""


def cases_of_programs(junit):
    """Cases by the name of the program; meson calls their suites "PROJECT.PROJECT / PROGRAM.SUITE"."""
    programs = collections.defaultdict(lambda: Cases([], [], []))
    for suite in junit.iter("testsuite"):
        _, slash, rest = suite.get("name").partition(" / ")
        if not slash:
            continue  # programs without cases: all of them share the suite PROJECT
        cases = programs[rest.split(".")[0]]
        for case in suite.iter("testcase"):
            name = case.get("classname") + "." + case.get("name")
            if case.find("failure") is not None or case.find("error") is not None:
                fault = case.find("failure") if case.find("failure") is not None else case.find("error")
                cases.failed.append(name + last_lines(fault.text or fault.get("message")))
            elif case.find("skipped") is not None:
                cases.skipped.append(name)
            else:
                cases.passed.append(name)
    return programs


def count(folder):
    """Prints the faults of a build folder; returns how many tests passed and failed."""
    logs = pathlib.Path(folder) / "meson-logs"
    if not (logs / "testlog.json").exists():
        print("FAILED", folder, "ran no test")
        return 0, 1
    # A test that is killed leaves its log's colors, which no XML may have.
    junit = re.sub(rb"[\x00-\x08\x0b\x0c\x0e-\x1f]", b"", (logs / "testlog.junit.xml").read_bytes())
    programs = cases_of_programs(ET.fromstring(junit))
    passed = failed = 0
    for line in (logs / "testlog.json").read_text().splitlines():
        run = json.loads(line)
        program = run["name"].split(" / ")[-1]
        cases = programs.get(program, Cases([], [], []))
        for name in cases.skipped:
            print("SKIPPED", folder, program, name)
        for name in cases.failed:
            print("FAILED", folder, program, name)
        passed += len(cases.passed)
        failed += len(cases.failed)
        if run["result"] == "SKIP":
            print("SKIPPED", folder, program)
        elif run["result"] not in ("OK", "EXPECTEDFAIL"):
            if not cases.failed:
                print("FAILED", folder, program, f"({run['result']}, exit status {run['returncode']}){running(run.get('stdout'))}" + last_lines(run.get("stderr"), 30))
                failed += 1
        elif program not in programs:
            passed += 1
    return passed, failed


def main():
    counts = [count(folder) for folder in sys.argv[1:]]
    passed, failed = (sum(column) for column in zip(*counts))
    print(f"{passed} passed, {failed} failed")
    sys.exit(1 if failed or not passed else 0)


main()
