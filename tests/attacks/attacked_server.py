# SPDX-License-Identifier: Apache-2.0
"""Starts `understudy serve` with one node at a local port, for programs that attack it."""

import re
import subprocess
import time


def server(program, folder, *options, **variables):
    """Starts the server; its secret and its output are in `folder`, as `secret` and `log`."""
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(folder)} | variables
    log = (folder / "log").open("wb")
    return subprocess.Popen(
        [program, "serve", "-n", "1", "--socket", folder / "nodes.sock", "--listen", ":0", "--secret-file", folder / "secret", *options],
        stdout=log, stderr=log, env=environment, cwd=folder)


def said(folder):
    return (folder / "log").read_text(errors="replace")


def port_of(process, folder):
    for _ in range(600):
        found = re.search(r"also at 127\.0\.0\.1:([0-9]+)", said(folder))
        if found:
            return int(found[1])
        if process.poll() is not None:
            break
        time.sleep(0.1)
    raise SystemExit(f"the server does not listen:\n{said(folder)}")


def comes_to_say(folder, words, after=0):
    """Waits until the server's output after the first `after` characters contains `words`; returns whether it does."""
    for _ in range(600):
        if words in said(folder)[after:]:
            return True
        time.sleep(0.1)
    return False
