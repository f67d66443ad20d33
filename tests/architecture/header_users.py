# SPDX-License-Identifier: Apache-2.0
"""How many objects are compiled again when a header changes: header_users.py BUILD_FOLDER [--check]

Reads what ninja has recorded about the last build. Prints the headers that most objects include; with --check, exits
with 1 if more objects include a header than its limit allows.
"""

import collections
import pathlib
import subprocess
import sys

USUAL_LIMIT = 60
NAMED_LIMIT = 200

# At most ten: basic types of volume/, a few lines each, of which every request, image and message consists.
NAMED = {f"volume/{name}.h" for name in (
    "blending_operator", "classification", "description", "rect", "rgba", "texel_box", "texel_type", "texture_filter",
    "texture_space", "volume_id")}


def users_of_headers(build, root):
    """Counts the objects that include each header of the project, by path."""
    listing = subprocess.run(["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True, check=True).stdout
    users = collections.Counter()
    for block in listing.split("\n\n"):
        lines = block.splitlines()
        if not lines or not lines[0].split(":")[0].endswith(".o"):
            continue
        read = {(pathlib.Path(build) / line.strip()).resolve() for line in lines[1:]}
        users.update(path.relative_to(root) for path in read if path.suffix == ".h" and path.is_relative_to(root))
    return users


def main():
    build = sys.argv[1]
    root = pathlib.Path(__file__).resolve().parents[2]
    users = users_of_headers(build, root)
    own = {str(path): count for path, count in users.items() if not path.is_relative_to(pathlib.Path("build"))}
    print("| Header | Objects |\n| --- | --- |")
    for path, count in sorted(own.items(), key=lambda row: -row[1])[:25]:
        print(f"| {path} | {count} |")
    too_many = {path: count for path, count in own.items()
                if count > (NAMED_LIMIT if path in NAMED else USUAL_LIMIT)}
    for path, count in sorted(too_many.items()):
        print(f"{path}: {count} objects read it: split it, or declare in advance what need not be defined")
    sys.exit(1 if too_many and "--check" in sys.argv[2:] else 0)


if __name__ == "__main__":
    main()
