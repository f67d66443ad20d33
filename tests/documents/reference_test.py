#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the reference of the headers with Doxygen (docs/Doxyfile), and allows no warning.

    reference_test.py FOLDER      writes the pages to FOLDER; UNDERSTUDY_VERSION is their version"""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FEWEST_PAGES = 500


def main():
    folder = Path(sys.argv[1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    settings = (ROOT / "docs" / "Doxyfile").read_text(encoding="utf-8") + f'OUTPUT_DIRECTORY = "{folder}"\n'
    done = subprocess.run(["doxygen", "-"], cwd=ROOT, input=settings, text=True, capture_output=True, check=False)
    pages = len(list((folder / "html").glob("*.html")))
    print(done.stdout + done.stderr + f"{pages} pages in {folder / 'html'}")
    return int(done.returncode != 0 or done.stderr.strip() != "" or pages < FEWEST_PAGES)


if __name__ == "__main__":
    sys.exit(main())
