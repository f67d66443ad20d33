# SPDX-License-Identifier: Apache-2.0
"""A table of what phases took. Reads lines "NAME|SECONDS|USER SYSTEM": how far the clock and the processors' time were when
each began, the last one ending the one before. USER and SYSTEM are bash's, as in 12m3.456s."""

import sys


def seconds(text):
    minutes, rest = text.rstrip("s").split("m")
    return 60 * float(minutes) + float(rest)


def main():
    rows = [line.rstrip("\n").split("|") for line in sys.stdin]
    print(f"{'':64} minutes  CPU-minutes")
    for (name, start, cpu_start), (_, end, cpu_end) in zip(rows, rows[1:]):
        clock = int(end) - int(start)
        cpu = sum(map(seconds, cpu_end.split())) - sum(map(seconds, cpu_start.split()))
        print(f"{name[:64]:64} {clock / 60:7.1f}  {cpu / 60:11.1f}")


if __name__ == "__main__":
    main()
