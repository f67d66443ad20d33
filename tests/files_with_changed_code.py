#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""files_with_changed_code.py BASE [FILE…]: prints those of the C++ files on the command line whose code differs from commit BASE.

Comments and white space do not count, except comments that direct clang-tidy (NOLINT). New files count.
"""

import re
import subprocess
import sys
from pathlib import Path

# Literals are found as well, because they may hold what looks like a comment; numbers, because they may hold a quote.
PARTS = re.compile(
    r"""R"(?P<mark>[^()\\\s]{0,16})\(.*?\)(?P=mark)"   # a raw string
      | "(?:\\.|[^"\\\n])*" | \b\d(?:'?\w)* | '(?:\\.|[^'\\\n])*'
      | (?P<comment>//[^\n]*|/\*.*?\*/)""",
    re.VERBOSE | re.DOTALL)


def code_of(text):
    """Returns the text without comments, and with single spaces."""
    def kept(part):
        comment = part.group("comment")
        return part.group() if comment is None or "NOLINT" in comment else " "
    return " ".join(PARTS.sub(kept, text).split())


def text_in(commit, file):
    """Returns the file's text in the commit; None if the commit does not have it."""
    shown = subprocess.run(["git", "show", f"{commit}:{file}"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    return shown.stdout.decode(errors="replace") if shown.returncode == 0 else None


def main(base, files):
    for file in files:
        before = text_in(base, file)
        if before is None or code_of(before) != code_of(Path(file).read_text(encoding="utf-8", errors="replace")):
            print(file)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
