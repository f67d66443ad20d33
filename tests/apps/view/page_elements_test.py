#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every element that a script of the page names by its id must exist: a missing element stops the whole script."""

import re
import sys
import unittest
from pathlib import Path

PAGE = Path(__file__).resolve().parents[3] / "apps" / "understudy" / "view" / "page"


class PageElements(unittest.TestCase):
    def test_scripts_name_what_is_there(self):
        there = set(re.findall(r'\bid="([^"]+)"', (PAGE / "index.html").read_text(encoding="utf-8")))
        named = {}
        for script in sorted(PAGE.glob("*.js")):
            for name in re.findall(r"\b(?:element|getElementById)\('([^']+)'\)", script.read_text(encoding="utf-8")):
                named.setdefault(name, script.name)
        self.assertGreater(len(named), 20)
        self.assertEqual({name: script for name, script in named.items() if name not in there}, {})


if __name__ == "__main__":
    sys.exit(unittest.main())
