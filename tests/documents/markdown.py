# SPDX-License-Identifier: Apache-2.0
"""Parses the project's documents into text, table cells, fenced code, links and headings.

Without a Markdown library: the pages use a small part of Markdown, and the tests must not need a package."""

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^\s*```(\S*)\s*$")
COMMENT = re.compile(r"^\s*<!--\s*(.*?)\s*-->\s*$")
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
CODE = re.compile(r"`+[^`]*`+")


@dataclass
class Block:
    """Fenced code, the line of its fence and the comment directly before it."""
    language: str
    line: int
    comment: str
    text: str = ""


@dataclass
class Page:
    path: Path
    text: str
    paragraphs: list = field(default_factory=list)  # (line, text): each is one heading, list item or paragraph
    cells: list = field(default_factory=list)       # (line, text)
    blocks: list = field(default_factory=list)
    headings: list = field(default_factory=list)

    @property
    def name(self):
        return str(self.path.relative_to(ROOT))


def documents():
    """Returns README and the other pages of the root, and all of docs/."""
    return [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]


def read(path):
    page = Page(path, path.read_text(encoding="utf-8"))
    block, comment, paragraph = None, "", []

    def close():
        if paragraph:
            page.paragraphs.append((paragraph[0][0], " ".join(text for _, text in paragraph)))
            paragraph.clear()

    for number, line in enumerate(page.text.splitlines(), 1):
        fence = FENCE.match(line)
        if block is not None:
            if fence and not fence[1]:
                page.blocks.append(block)
                block = None
            else:
                block.text += line + "\n"
            continue
        if fence:
            close()
            block, comment = Block(fence[1], number, comment), ""
            continue
        remark = COMMENT.match(line)
        if line.strip():
            comment = remark[1] if remark else ""
        if not line.strip() or remark:
            close()
        elif line.lstrip().startswith("|"):
            close()
            if not re.fullmatch(r"[\s|:-]+", line):
                page.cells += [(number, cell.strip()) for cell in re.split(r"(?<!\\)\|", line.strip().strip("|"))]
        elif line.startswith("#"):
            close()
            page.headings.append(line.lstrip("#").strip())
            page.paragraphs.append((number, page.headings[-1]))
        else:
            if re.match(r"\s*([-*+]|\d+\.)\s", line):
                close()
            paragraph.append((number, line.strip()))
    close()
    assert block is None, f"{page.name}:{block.line}: the code block is not closed"
    return page


def words(text):
    """Returns words as a reader counts them: code is one word, a link is its text."""
    text = LINK.sub(lambda link: "" if link[1] else link[2], text)
    return [word for word in CODE.sub("code", text).split() if re.search(r"\w", word)]


def sentences(text):
    text = LINK.sub(lambda link: "" if link[1] else link[2], text)
    return re.split(r"(?<=[.!?])[)\"*]*\s+", CODE.sub("code", text))


def links(page):
    """Yields (line, target, is an image) of every link outside code."""
    inside = None
    for number, line in enumerate(page.text.splitlines(), 1):
        fence = FENCE.match(line)
        if fence:
            inside = None if inside else number
        elif not inside:
            for link in LINK.finditer(CODE.sub(lambda code: "`" + "." * len(code[0]) + "`", line)):
                yield number, link[3], bool(link[1])


def anchors(page):
    """Returns the anchors of a page's headings, as GitHub names them."""
    found = set()
    for heading in page.headings:
        heading = LINK.sub(lambda link: link[2], heading).replace("`", "")
        name = re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")
        count = 0
        while (candidate := name if not count else f"{name}-{count}") in found:
            count += 1
        found.add(candidate)
    return found
