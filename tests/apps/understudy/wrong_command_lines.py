#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""wrong_command_lines.py UNDERSTUDY: runs hundreds of invalid command lines that are derived from the existing options. Each
must end with a proper exit status, name the invalid word, and list the valid words if the option has a fixed set."""

import os
import random
import re
import subprocess
import sys
import tempfile

UNDERSTUDY = os.path.abspath(sys.argv[1])
SEED = 20


def completion():
    """Maps (subcommand, option) to the option's valid words; an empty list: any word."""
    text = subprocess.run([UNDERSTUDY, "completion", "bash"], check=True, capture_output=True, text=True).stdout
    table = {}
    for names, words in re.findall(r"^    ('[^)]*)\) words='([^']*)'; files=", text, re.MULTILINE):
        for subcommand, option in re.findall(r"'(\w+) ([^']+)'", names):
            table[(subcommand, option)] = words.split()
    return table


def misspelt(word, rng):
    """`word` with one letter omitted, doubled, or swapped with the next one; the leading dashes stay."""
    at = rng.randrange(3, len(word) - 1)
    return rng.choice([word[:at] + word[at + 1:], word[:at] + word[at] + word[at:],
                       word[:at] + word[at + 1] + word[at] + word[at + 2:]])


def command_lines(table):
    """Yields (command line, words that the error message must contain)."""
    rng = random.Random(SEED)
    options = sorted(table)
    rest = {"run": ["--", "true"], "render": ["synthetic:4x4x4"], "compare": ["a", "b"]}
    for subcommand, option in options:
        if not option.startswith("--") or option == "--tf":
            continue
        for _ in range(2):
            wrong = misspelt(option, rng)
            if (subcommand, wrong) not in table:
                yield [subcommand, wrong, *rest.get(subcommand, [])], [wrong]
        if table[(subcommand, option)]:
            for word in ("none-such", rng.choice(table[(subcommand, option)])[:-1] + "~"):
                yield [subcommand, option, word, *rest.get(subcommand, [])], [word, *table[(subcommand, option)]]
                yield [subcommand, f"{option}={word}", *rest.get(subcommand, [])], [word]
    for option, wrong in (("-n", "x"), ("-n", "-3"), ("--error", "5"), ("--error", "1/0"), ("--time", "30min"), ("--time", "-1ms"),
                          ("--verify", "often"), ("--frame-latency", "2"), ("--report", "/no/such/folder/r.json"),
                          ("--trace", "/no/such/folder/t"), ("--hostfile", "/no/such/hosts"), ("--chain", "volume)"),
                          ("--chain", "volme"), ("--chain", "track volume(frobnicate=1) driver"), ("--chain", "driver driver")):
        yield ["run", option, wrong, "--", "true"], ["chain, character" if option == "--chain" else wrong]
    for option, wrong in (("--size", "0x5"), ("--size", "big"), ("--camera", "1,2"), ("--step", "0"), ("--step", "nan"),
                          ("--tf", "heat"), ("--surface", "x"), ("--surface", "140%"), ("--type", "u12"), ("--spacing", "1"),
                          ("--range", "5"), ("--out", "image.jpg"), ("--out", "/no/such/folder/i.png"), ("--light-from", "1"),
                          ("--material", "1,2"), ("--termination", "2"), ("--frames", "0")):
        words = ["render", "synthetic:4x4x4", "--light", "all", option, wrong] + (["--out", "i.png"] if option != "--out" else [])
        yield words, [wrong if option != "--spacing" else "--spacing"]
    for words, said in ((["run", "viewer", "file"], ["--"]), (["run"], ["viewer"]), (["render"], ["VOLUME"]), ([], ["run"]),
                        (["render", "/no/such/file.nrrd", "--out", "i.png"], ["/no/such/file.nrrd"]), (["run", "--"], ["viewer"]),
                        (["run", "--", "/no/such/viewer"], ["/no/such/viewer"]), (["replay", "/no/trace"], ["/no/trace"]),
                        (["compare", "a.png"], ["required"]), (["view", "/no/such/file"], ["/no/such/file"]),
                        (["print", "/no/trace"], ["/no/trace"]), (["key", "/no/such/folder/k"], ["/no/such/folder/k"])):
        yield words, said


def main():
    lines = list(command_lines(completion()))
    if len(lines) < 300:
        sys.exit(f"only {len(lines)} command lines were made")
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        for words, said in lines:
            done = subprocess.run([UNDERSTUDY, *words], capture_output=True, text=True, timeout=60, cwd=folder, check=False,
                                  stdin=subprocess.DEVNULL)
            text = " ".join((done.stderr + done.stdout).split())
            missing = [word for word in said if word not in text]
            if done.returncode <= 0 or done.returncode >= 128 or missing:
                failures.append(f"{' '.join(words)}: status {done.returncode}, says nothing of {missing}: {text[:200]}")
    print("\n".join(failures))
    print(f"{len(lines)} command lines, {len(failures)} answered badly")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
