#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the bash and console blocks of one page in order, in one shell, in a folder that looks like the checkout.

    run_code_blocks.py BUILD PAGE [--slow]
    run_code_blocks.py --list

The folder is temporary. It has links to everything in the checkout and to BUILD (as build/), an X server without a screen,
a HOME of its own, and BUILD/bin on PATH. A block fails if one of its commands does. In a console block, lines after "$ "
are commands; each line under a command must begin a line of its output, where numbers match any numbers and … any text.

A comment directly before a block says how it is treated:

    <!-- not run: REASON -->   never run here; --list names these blocks
    <!-- slow: REASON -->      only with --slow, which runs all other blocks too
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import markdown  # noqa: E402
from markdown import ROOT  # noqa: E402

sys.path.insert(0, str(ROOT / "apps" / "demo"))
from display import VirtualDisplay  # noqa: E402

SHELLS = ("bash", "console")
SECONDS = 280  # a test's limit is 300
MOST_NOT_RUN = 21
# osgvolume does not end by itself: OpenSceneGraph ends it after this many frames, in a small window.
ENDING = {"OSG_RUN_FRAME_COUNT": "12", "OSG_WINDOW": "0 0 256 256", "UNDERSTUDY_SPEED_GUARD": "off"}


def reason_not_to_run(block):
    return block.comment.removeprefix("not run:").strip() if block.comment.startswith("not run:") else None


def runs(block, slow):
    return block.language in SHELLS and reason_not_to_run(block) is None and (slow or not block.comment.startswith("slow:"))


def console_steps(text):
    """Returns (command, lines that it prints) of a console block; a command continues after a backslash."""
    steps, continued = [], False
    for line in text.splitlines():
        if continued:
            steps[-1][0] += "\n" + line
        elif line.startswith("$ "):
            steps.append([line[2:], []])
        else:
            steps[-1][1].append(line)
            continue
        continued = line.endswith("\\")
    return steps


def script_of(page, folder, slow):
    """Returns one shell script, and what its console commands must print: (line, command, file, lines)."""
    parts = ["set -eu -o pipefail\n"]
    expected = []
    for block in page.blocks:
        if not runs(block, slow):
            continue
        where = f"{page.name}:{block.line}"
        parts.append(f"trap 'echo \"{where}: a command of this block failed\" >&2' ERR\necho \"== {where} after $SECONDS s\" >&2\n")
        if block.language == "bash":
            parts.append(block.text)
            continue
        for command, lines in console_steps(block.text):
            printed = folder / f"console-{len(expected)}"
            expected.append((where, command, printed, lines))
            parts.append(f"{{ {command}\n}} >'{printed}' 2>&1 || {{ cat '{printed}' >&2; echo '{where}: failed' >&2; exit 1; }}\n")
    return "".join(parts), expected


def pattern_of(line):
    escaped = re.escape(line.strip()).replace(re.escape("…"), ".*")
    return re.compile(re.sub(r"\d+(?:\\\.\d+)?(?:e-?\d+)?", r"[\\d.e+-]+", escaped))


def missing_lines(lines, printed):
    """Returns those of `lines` that `printed` does not contain in this order."""
    rest, missing = [line.strip() for line in printed.splitlines()], []
    for line in lines:
        if line.strip() in ("", "…"):
            continue
        pattern = pattern_of(line)
        place = next((n for n, text in enumerate(rest) if pattern.match(text)), None)
        if place is None:
            missing.append(line)
        else:
            rest = rest[place + 1:]
    return missing


def furnish(checkout, build):
    for entry in ROOT.iterdir():
        if not entry.name.startswith((".", "build", "out")):
            (checkout / entry.name).symlink_to(entry)
    (checkout / "build").symlink_to(build)


def environment(folder, build, display):
    private = folder / "runtime"
    private.mkdir(mode=0o700)
    home = folder / "home"
    home.mkdir()
    inherited = {name: value for name, value in os.environ.items() if not name.startswith(("UNDERSTUDY_", "SLURM_"))}
    return {**inherited, **ENDING, "PATH": f"{build / 'bin'}:{os.environ['PATH']}", "HOME": str(home),
            "XDG_RUNTIME_DIR": str(private), "DISPLAY": display}


def run_script(script, checkout, variables):
    shell = subprocess.Popen(["bash", "-c", script], cwd=checkout, env=variables, stdin=subprocess.DEVNULL,
                             start_new_session=True)
    try:
        return shell.wait(SECONDS)
    except subprocess.TimeoutExpired:
        print(f"time is up after {SECONDS} s", file=sys.stderr)
        return 1
    finally:
        end_group(shell.pid)


def end_group(group):
    """Ends the servers that a block has started in the background; they have ten seconds to end their own children."""
    for ending in (signal.SIGTERM, signal.SIGKILL):
        for _ in range(100):
            try:
                os.killpg(group, ending)
            except ProcessLookupError:
                return
            time.sleep(0.1)


def run_page(build, path, slow):
    page = markdown.read(path)
    if not any(runs(block, slow) for block in page.blocks):
        return 0
    folder = Path(tempfile.mkdtemp(prefix="documents-"))
    try:
        checkout = folder / "checkout"
        checkout.mkdir()
        furnish(checkout, build)
        script, expected = script_of(page, folder, slow)
        with VirtualDisplay() as display:
            if run_script(script, checkout, environment(folder, build, display)) != 0:
                return 1
        status = 0
        for where, command, printed, lines in expected:
            text = printed.read_text(encoding="utf-8", errors="replace")
            for line in missing_lines(lines, text):
                status = 1
                print(f"{where}: `{command}` does not print\n  {line}\nbut\n{text}", file=sys.stderr)
        return status
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def list_not_run():
    """Lists every block that no test runs, with the reason; at most MOST_NOT_RUN are allowed."""
    status = count = 0
    for path in markdown.documents():
        page = markdown.read(path)
        for block in page.blocks:
            reason = reason_not_to_run(block)
            if reason is None or block.language not in SHELLS:
                continue
            count += 1
            print(f"{page.name}:{block.line}: {reason}")
            status |= not reason
    print(f"{count} blocks are not run, {MOST_NOT_RUN} may be")
    return int(status or count > MOST_NOT_RUN)


def main():
    if sys.argv[1:] == ["--list"]:
        return list_not_run()
    build, path, *options = sys.argv[1:]
    return run_page(Path(build).resolve(), (ROOT / path).resolve(), "--slow" in options)


if __name__ == "__main__":
    sys.exit(main())
