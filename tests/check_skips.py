# SPDX-License-Identifier: Apache-2.0
"""Fails when a test was skipped that tests/skips.txt does not list: check_skips.py LIST RESULTS.xml"""

import fnmatch
import pathlib
import sys
import xml.etree.ElementTree


def listed_skips(path):
    """The patterns of the list, each with its reason."""
    rows = {}
    for line in pathlib.Path(path).read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        pattern, bar, reason = (part.strip() for part in line.partition("|"))
        if not bar or not reason:
            sys.exit(f"{path}: '{line}' names no reason: write NAME | REASON")
        rows[pattern] = reason
    return rows


def skipped_tests(path):
    """The tests that ctest's results call skipped, each with what it said."""
    found = {}
    for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        if case.get("status") == "notrun" or case.find("skipped") is not None:
            found[case.get("name")] = case.findtext("system-out") or ""
    return found


def last_words(output):
    """The line in which GoogleTest says why."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    told = [lines[at + 1] for at, line in enumerate(lines[:-1]) if line.endswith(": Skipped")]
    return told[0] if told else (lines[-1] if lines else "no output")


def main():
    _, list_file, results = sys.argv
    listed = listed_skips(list_file)
    skipped = skipped_tests(results)
    unlisted = {}
    for name, output in sorted(skipped.items()):
        pattern = next((one for one in listed if fnmatch.fnmatchcase(name, one)), None)
        if pattern is None:
            unlisted[name] = output
        else:
            print(f"skipped: {name}: {listed[pattern]}")
    for name, output in unlisted.items():
        print(f"SKIPPED, and not in {list_file}: {name}: {last_words(output)}")
    sys.exit(1 if unlisted else 0)


if __name__ == "__main__":
    main()
