# SPDX-License-Identifier: Apache-2.0
"""A private X server without a screen (Xvfb), for viewers that open a window."""

import os
import subprocess

START_SECONDS = 20


class VirtualDisplay:
    """with VirtualDisplay() as name: the viewers' DISPLAY is `name` while the block runs."""

    def __enter__(self):
        read, write = os.pipe()
        # -noreset: a server that resets when its last client leaves occasionally refuses the next one.
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x768x24", "+extension", "GLX",
             "-nolisten", "tcp", "-noreset"],
            pass_fds=[write], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        # The server writes its display number when it is ready, and closes the pipe if it cannot start.
        with os.fdopen(read) as number:
            display = number.readline().strip()
        if not display:
            self.server.wait(START_SECONDS)
            raise RuntimeError("Xvfb did not start; is it installed (apt install xvfb) and is /tmp writable?")
        return ":" + display

    def __exit__(self, *_):
        self.server.terminate()
        self.server.wait()
