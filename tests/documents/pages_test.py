#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rules for every page: lengths of pages, sentences and cells; links, anchors, images and named paths exist."""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import markdown  # noqa: E402
from markdown import ROOT  # noqa: E402

MOST_WORDS_OF_README = 900
MOST_WORDS_OF_ARCHITECTURE = 999
MOST_WORDS_OF_SENTENCE = 40
MOST_WORDS_OF_CELL = 40
# Options of osgvolume, cmake, GoogleTest and others.
FOREIGN_OPTIONS = set("--cpu-tf --shader --preset --build --target --gtest --install --prefix --strip --component".split())
PAGES = [markdown.read(path) for path in markdown.documents()]

# Names in backticks that look like paths of the project, but are made by a command or are the reader's own.
MADE = ("out/", "build/", "build-asan/", "build-tsan/", "build-fuzz/", "docs/doxygen/")
TOP = ("apps", "compositor", "docs", "examples", "interceptor", "spu", "tests", "volume")


def word_count(page):
    """Counts words as `wc -w` does."""
    return len(page.text.split())


class Pages(unittest.TestCase):
    def none(self, found):
        self.assertEqual(found, [], "\n" + "\n".join(found))

    def test_lengths_of_pages(self):
        by_name = {page.name: page for page in PAGES}
        self.assertLessEqual(word_count(by_name["README.md"]), MOST_WORDS_OF_README)
        architecture = [page for page in PAGES if page.name.startswith("docs/architecture/")]
        self.assertGreaterEqual(len(architecture), 5)
        self.none([f"{page.name}: {word_count(page)} words" for page in architecture
                   if word_count(page) > MOST_WORDS_OF_ARCHITECTURE])

    def test_sentences_are_short(self):
        self.none([f"{page.name}:{line}: {len(markdown.words(sentence))} words: {sentence}"
                   for page in PAGES for line, text in page.paragraphs for sentence in markdown.sentences(text)
                   if len(markdown.words(sentence)) > MOST_WORDS_OF_SENTENCE])

    def test_table_cells_are_short(self):
        self.none([f"{page.name}:{line}: {len(markdown.words(cell))} words: {cell}"
                   for page in PAGES for line, cell in page.cells
                   if len(markdown.words(cell)) > MOST_WORDS_OF_CELL])

    def test_links_resolve(self):
        anchors = {page.path: markdown.anchors(page) for page in PAGES}
        found = []
        for page in PAGES:
            for line, target, image in markdown.links(page):
                if re.match(r"[a-z]+:", target):
                    continue
                path, _, anchor = target.partition("#")
                file = (page.path.parent / path).resolve() if path else page.path
                if not file.exists() or (image and not file.is_file()):
                    found.append(f"{page.name}:{line}: {target} does not exist")
                elif not file.is_relative_to(ROOT):
                    found.append(f"{page.name}:{line}: {target} leaves the project")
                elif anchor and file in anchors and anchor not in anchors[file]:
                    found.append(f"{page.name}:{line}: {path or 'this page'} has no heading #{anchor}")
        self.none(found)

    def test_every_page_is_reached_from_the_readme(self):
        by_path = {page.path: page for page in PAGES}
        reached, waiting = set(), [ROOT / "README.md"]
        while waiting:
            path = waiting.pop()
            if path in by_path and path not in reached:
                reached.add(path)
                waiting += [(path.parent / target.partition("#")[0]).resolve()
                            for _, target, _ in markdown.links(by_path[path]) if not re.match(r"[a-z]+:|#", target)]
        self.none([f"{page.name}: no link leads here" for page in PAGES if page.path not in reached])

    def test_paths_in_backticks_exist(self):
        found = []
        for page in PAGES:
            of_page = {block.comment.removeprefix("file:").strip() for block in page.blocks}
            for name in re.findall(r"`([^`\s]+)`", page.text):
                path = re.sub(r"(:\d+|#.*)$", "", name).rstrip("/")
                if path.split("/")[0] not in TOP or "/" not in path or name.startswith(MADE) or path in of_page:
                    continue
                if not re.fullmatch(r"[\w./{},*-]+", path):
                    continue
                braces = re.fullmatch(r"(.*)\{(.*)\}(.*)", path)
                every = [braces[1] + part + braces[3] for part in braces[2].split(",")] if braces else [path]
                found += [f"{page.name}: `{one}` does not exist" for one in every if not list(ROOT.glob(one))]
        self.none(found)

    def test_json_parses(self):
        blocks = [(page, block) for page in PAGES for block in page.blocks if block.language == "json"]
        self.assertTrue(blocks)
        for page, block in blocks:
            with self.subTest(page=page.name, line=block.line):
                json.loads(block.text)
        for file in sorted((ROOT / "examples").rglob("*.json")):
            with self.subTest(file=file.name):
                json.loads(file.read_text(encoding="utf-8"))

    def test_code_is_fenced_not_indented(self):
        found, fenced = [], False
        for page in PAGES:
            before = ""
            for number, line in enumerate(page.text.splitlines(), 1):
                if markdown.FENCE.match(line):
                    fenced = not fenced
                elif not fenced and line.startswith("    ") and not before.strip():
                    found.append(f"{page.name}:{number}: indented code")
                before = line
        self.none(found)

    def test_diagrams_are_those_of_the_script(self):
        folder = ROOT / "docs" / "diagrams"
        with tempfile.TemporaryDirectory() as made:
            subprocess.run([sys.executable, "-B", folder / "draw.py", made], check=True)
            self.assertEqual(sorted(file.name for file in Path(made).iterdir()),
                             sorted(file.name for file in folder.glob("*.svg")))
            for file in Path(made).iterdir():
                self.assertEqual(file.read_text(encoding="utf-8"), (folder / file.name).read_text(encoding="utf-8"),
                                 f"{file.name}: run docs/diagrams/draw.py")

    def test_reasons_in_troubleshooting_stand_in_the_code(self):
        code = re.sub(r'"\s*\n\s*"', "", "\n".join(
            file.read_text(encoding="utf-8", errors="replace") for folder in ("spu", "compositor", "volume", "apps/understudy")
            for file in sorted((ROOT / folder).rglob("*")) if file.suffix in (".h", ".cc")))
        page = next(page for page in PAGES if page.name == "docs/troubleshooting.md")
        table = page.text[page.text.index("## Every reason"):page.text.index("## Nodes do not start")]
        reasons = {reason for row in table.splitlines() if row.startswith("| ")
                   for reason in re.findall(r"`([^`]+)`", row.split("|")[1]) if len(reason.split()) > 2}
        self.assertGreater(len(reasons), 80)
        self.none([f"docs/troubleshooting.md: `{reason}` does not stand in the code" for reason in sorted(reasons)
                   if reason.removeprefix("the fragment shader: ") not in code])
        plain = table.replace("`", "").replace("*", "")
        thrown = re.findall(r'Refusal\s*[{(]\s*(?:fmt::format\(\s*)?"([^"]{12,})"', code)
        longest = {reason: max((piece.strip(" ',:") for piece in re.split(r"\{[^}]*\}", reason)), key=len) for reason in thrown}
        self.none([f"docs/troubleshooting.md: no row explains `{reason}`"
                   for reason, piece in sorted(longest.items()) if piece not in plain])

    def test_options_exist(self):
        sources = [ROOT / "run"] + [file for folder in ("apps", "spu", "tests") for file in (ROOT / folder).rglob("*")
                                    if file.suffix in (".cc", ".h", ".py") and file.parent != Path(__file__).parent]
        code = "".join(file.read_text(encoding="utf-8", errors="replace") for file in sources)
        known = set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", code)) | FOREIGN_OPTIONS
        found = []
        for page in PAGES:
            texts = re.findall(r"`[^`\n]*`", page.text) + [block.text for block in page.blocks if block.language in ("bash", "console")]
            found += [f"{page.name}: no program has {option}" for text in texts
                      for option in re.findall(r"(?<![\w-])--[a-z][a-z-]+", text) if option not in known]
        self.none(found)

    def test_examples_are_used_and_parse(self):
        text = "".join(page.text for page in PAGES)
        for file in sorted((ROOT / "examples").iterdir()):
            with self.subTest(file=file.name):
                self.assertIn(f"examples/{file.name}", text)
                if file.is_file() and file.read_text(encoding="utf-8").startswith("#!/bin/bash"):
                    subprocess.run(["bash", "-n", file], check=True)

    def test_every_block_says_its_language(self):
        self.none([f"{page.name}:{block.line}: a code block without a language"
                   for page in PAGES for block in page.blocks if not block.language])


if __name__ == "__main__":
    unittest.main()
