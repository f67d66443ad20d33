"""Adds the licence line where it is missing: license_lines.py. Every source, header, script and CMake file has one."""

import pathlib
import subprocess

LINE = "SPDX-License-Identifier: Apache-2.0"
COMMENTS = {".cc": "// {}", ".h": "// {}", ".js": "// {}", ".css": "/* {} */", ".html": "<!-- {} -->", ".py": "# {}",
            ".sh": "# {}", ".cmake": "# {}", ".yml": "# {}"}


def comment_of(path):
    if path.name == "CMakeLists.txt" or path.name == "run" and path.suffix == "":
        return "# {}"
    return COMMENTS.get(path.suffix)


def with_line(text, comment):
    lines = text.split("\n")
    # A script's interpreter line and a page's doctype must come first.
    at = 1 if lines[0].startswith(("#!", "<!")) else 0
    return "\n".join(lines[:at] + [comment.format(LINE)] + lines[at:])


def main():
    for name in subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.splitlines():
        path = pathlib.Path(name)
        comment = comment_of(path)
        if comment is None or path.is_symlink():
            continue
        text = path.read_text()
        if LINE not in text[:300]:
            path.write_text(with_line(text, comment))


if __name__ == "__main__":
    main()
