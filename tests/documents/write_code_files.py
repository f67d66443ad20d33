#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the C++ blocks of a page to files, so that the code on the page is the code that is compiled.

    write_code_files.py PAGE FOLDER

A comment directly before a block names its file: <!-- file: spu/wireframe/wireframe.h -->. Every C++ block must have one."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import markdown  # noqa: E402


def main():
    page, folder = markdown.read(Path(sys.argv[1]).resolve()), Path(sys.argv[2])
    for block in page.blocks:
        if block.language != "cpp":
            continue
        if not block.comment.startswith("file:"):
            sys.exit(f"{page.name}:{block.line}: no comment <!-- file: PATH --> before this block")
        file = folder / block.comment.removeprefix("file:").strip()
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(block.text, encoding="utf-8")


if __name__ == "__main__":
    main()
