#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""page_test.py PROGRAMS OUT: tests the page of `understudy view --web` in a real browser, without a screen.

The test opens the page by its link, rotates with the mouse, edits the transfer function, lights a surface, shows boxes, kills
a node and plays a series; screenshots go to OUT. Exits with status 77 if Chromium or its driver is missing.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

try:
    from selenium import webdriver
    from selenium.webdriver import ActionChains
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
except ImportError:
    print("skipped: apt install python3-selenium")
    sys.exit(77)

PROGRAMS, OUT = Path(sys.argv[1]), Path(sys.argv[2])
PATIENCE = 60
VOLUME = "synthetic:96x96x96:u8:lobes"
SERIES = ["synthetic:64x64x64:u8:lobes", "synthetic:64x64x64:u8:gyroid", "synthetic:64x64x64:u8:shells"]
ENGINE = Path("/usr/share/doc/tachyon/examples/scenes/vol/engine.256x256x110")


def browser():
    options = Options()
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1280,900",
                     "--force-device-scale-factor=1", "--hide-scrollbars"):
        options.add_argument(argument)
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


class Page:
    def __init__(self, link):
        self.driver = browser()
        self.driver.get(link)

    def shown(self):
        return self.driver.execute_script("return document.documentElement.dataset.shown ?? ''")

    def until(self, condition, what):
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, f"{what}: not within {PATIENCE} s; {self.driver.get_log('browser')}"
            time.sleep(0.05)

    def rests(self, what, after=""):
        """Waits for an image at rest that differs from `after`, and for its figures."""
        def rests_now():
            shown = self.shown()
            busy, figures = self.driver.execute_script(
                "const said = document.documentElement.dataset; return [said.busy, said.figures ?? '']")
            return busy == "no" and shown.endswith("still") and shown != after and shown.split()[0] == figures
        self.until(rests_now, what)

    def image(self):
        """The image's own pixels, as held by the browser."""
        return self.driver.execute_script("return document.getElementById('image').toDataURL('image/png')")

    def save(self, name):
        """Saves a screenshot, and returns the displayed image."""
        self.driver.save_screenshot(str(OUT / f"{name}.png"))
        return self.image()

    def element(self, name):
        return self.driver.find_element(By.ID, name)

    def text(self, name):
        return self.element(name).text


def nodes_of(view):
    text = subprocess.run(["ps", "-eo", "pid=,ppid=,comm="], stdout=subprocess.PIPE, text=True, check=True).stdout
    rows = [line.split(None, 2) for line in text.splitlines()]
    family = {view.pid}
    for _ in rows:
        family |= {int(pid) for pid, parent, _ in rows if int(parent) in family}
    return [int(pid) for pid, _, name in rows if int(pid) in family and name.startswith("understudy-node")]


def check(page, view):
    page.rests("the first image")
    images = {"first": page.save("1-first")}
    assert re.fullmatch(r"\d+ × \d+ lossless: .* from input to image .*", page.text("frame")), page.text("frame")
    page.until(lambda: "error 0." in page.text("exactness"), "the error of the first image")
    assert len(page.driver.find_elements(By.CLASS_NAME, "rank")) == 2
    assert "secret" not in page.driver.current_url, "the secret stays in no address"

    before = page.shown()
    canvas = page.element("image")
    ActionChains(page.driver, duration=20).move_to_element(canvas).click_and_hold().move_by_offset(120, 40).move_by_offset(
        60, -20).release().perform()
    page.rests("the turned image", before)
    images["turned"] = page.save("2-turned")

    # Drags a control point upwards from where it is drawn.
    before = page.shown()
    editor = page.element("editor")
    place = page.driver.execute_script("""
      const canvas = document.getElementById('editor').getBoundingClientRect();
      return [canvas.width, canvas.height]""")
    ActionChains(page.driver, duration=20).move_to_element_with_offset(editor, int(place[0] * 0.2), -10).click_and_hold(
        ).move_by_offset(0, -50).release().perform()
    page.rests("the edited transfer function", before)
    assert "opacity" in page.text("control-point-text")
    images["edited"] = page.save("3-edited")

    before = page.shown()
    page.driver.execute_script("[...document.querySelectorAll('#tables button')].find(b => b.textContent === 'rainbow').click()")
    page.rests("a built-in table", before)
    images["table"] = page.save("4-table")

    # The first point of a table of two is dragged to the last one.
    before = page.shown()
    page.driver.execute_script("[...document.querySelectorAll('#tables button')].find(b => b.textContent === 'grey').click()")
    page.rests("a table of two points", before)
    before = page.shown()
    ActionChains(page.driver, duration=20).move_to_element_with_offset(
        editor, int(12 - place[0] / 2), int(place[1] / 2 - 12)).click_and_hold().move_by_offset(int(place[0]) - 24, -60).release(
        ).perform()
    page.rests("a table that is nearly a step", before)
    before = page.shown()
    page.driver.execute_script("[...document.querySelectorAll('#tables button')].find(b => b.textContent === 'rainbow').click()")
    page.rests("a built-in table again", before)

    before = page.shown()
    page.element("shows-surface").click()
    page.rests("a surface", before)
    before = page.shown()
    page.element("light").click()
    page.element("shows-volume").click()
    page.rests("a surface in the light", before)
    page.element("shows-boxes").click()
    images["surface"] = page.save("5-surface")
    drawn = page.driver.execute_script("""
      const boxes = document.getElementById('boxes');
      return boxes.getContext('2d').getImageData(0, 0, boxes.width, boxes.height).data.some(value => value > 0)""")
    assert drawn, "no boxes are drawn"
    assert len(set(images.values())) == len(images), "two steps show the same image"

    # A reloaded page must show the same image again.
    page.driver.refresh()
    page.rests("the page once more")
    assert page.save("6-again") == images["surface"], "the page has forgotten what it showed"

    before = page.shown()
    os.kill(nodes_of(view)[-1], signal.SIGKILL)
    ActionChains(page.driver, duration=20).move_to_element(page.element("image")).click_and_hold().move_by_offset(
        10, 10).release().perform()
    page.until(lambda: "render nodes are gone" in page.text("banner-text") or page.text("banner-text").startswith("loading"),
               "a word that the nodes are gone")
    page.save("7-lost")
    page.rests("an image of new nodes", before)
    assert not page.element("banner").is_displayed()
    page.save("8-back")
    trouble = [entry for entry in page.driver.get_log("browser") if entry["level"] == "SEVERE"]
    assert not trouble, trouble


def pending(link):
    """Without the secret, the page must ask for it and show no image."""
    page = Page(link.split("#")[0])
    try:
        page.until(lambda: page.element("ask").is_displayed(), "the question for the secret")
        page.element("secret").send_keys("0" * 32)
        page.driver.execute_script("document.querySelector('#ask button').click()")
        page.until(lambda: "not this session" in page.text("ask-reason"), "the refusal")
        page.save("9-without-secret")
        assert page.shown() == ""
    finally:
        page.driver.quit()


def check_time(page, _view):
    """Checks the time steps of a series: the slider, the button for the next step, and Play, which wraps to the first step."""
    page.rests("the first step")

    def step():
        return int(page.driver.execute_script("return document.documentElement.dataset.timeStep"))

    names, images = {}, {}
    for wanted in range(len(SERIES)):
        if wanted > 0:
            before = page.shown()
            page.driver.execute_script("document.getElementById('later').click()")
            page.rests(f"step {wanted}", before)
        assert step() == wanted
        names[wanted], images[wanted] = page.text("name"), page.save(f"time-{wanted}")
    assert len(set(images.values())) == len(SERIES), "two steps show the same image"
    before = page.shown()
    page.driver.execute_script("""
      const slider = document.getElementById('time-step');
      slider.value = 0;
      slider.dispatchEvent(new Event('input'));""")
    page.rests("the first step again", before)
    assert page.image() == images[0]
    assert page.text("name") == names[0]
    page.element("play").click()
    assert page.text("play") == "Pause"
    seen = set()
    page.until(lambda: seen.add(step()) or len(seen) == len(SERIES), "every step, while it plays")
    page.until(lambda: step() == 0, "the first step after the last")
    page.element("play").click()
    page.rests("an image at rest after playing")
    assert page.image() == images[step()]
    trouble = [entry for entry in page.driver.get_log("browser") if entry["level"] == "SEVERE"]
    assert not trouble, trouble


def look(words, checks):
    """Runs `checks` on the page of `understudy view` with these arguments, then opens the page without the secret."""
    view = subprocess.Popen([str(PROGRAMS / "understudy"), "view", "--web", "0", *words], stdout=subprocess.PIPE, text=True)
    try:
        link = re.search(r"http://\S+", view.stdout.readline()).group()
        page = Page(link)
        try:
            checks(page, view)
        finally:
            page.driver.quit()
        pending(link)
    finally:
        view.terminate()
        view.wait()


def main():
    for program in ("chromium", "chromedriver"):
        if not shutil.which(program):
            print(f"skipped: {program} is missing; apt install chromium chromium-driver")
            return 77
    OUT.mkdir(parents=True, exist_ok=True)
    volume = ["--volume-size", "256", "256", "110", "--type", "u8", "--transfer-function", "engine", str(ENGINE)] if ENGINE.exists() else [VOLUME]
    look(["-n", "2", *volume], check)
    look(["--transfer-function", "rainbow", *SERIES], check_time)
    print(f"screenshots: {OUT}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
