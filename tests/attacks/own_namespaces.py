# SPDX-License-Identifier: Apache-2.0
"""Network, mount and process namespaces for a program that must be isolated from the rest of the machine."""

import os
import subprocess
import sys

SKIPPED = 77
INSIDE = "IN_OWN_NAMESPACES"


def go_on_inside(*preparation):
    """Continues as root in separate namespaces, after running the commands in `preparation`. Ends the program with SKIPPED if
    namespaces are not permitted."""
    if os.environ.get(INSIDE):
        for command in preparation:
            subprocess.run(command, check=True)
        return
    as_root = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
    command = ["unshare", "--net", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc", *as_root]
    if subprocess.run([*command, "true"], check=False, stderr=subprocess.DEVNULL).returncode != 0:
        print("no namespaces of its own can be made here")
        sys.exit(SKIPPED)
    sys.exit(subprocess.run([*command, sys.executable, "-B", *sys.argv], check=False, env=os.environ | {INSIDE: "yes"}).returncode)
