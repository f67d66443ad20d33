#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""module_test.py BUILD: compares the Python module with the commands and with itself."""

import os
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy

BUILD = Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(BUILD / "python"))
os.environ["UNDERSTUDY_BIN"] = str(BUILD / "bin")
os.environ["UNDERSTUDY_SPEED_GUARD"] = "off"
import understudy  # noqa: E402

SIZE = (64, 48)


def ball(shape=(20, 24, 28)):
    """Bytes that decrease from the middle outwards, at a different rate along each axis."""
    z, y, x = (numpy.linspace(-1, 1, count).reshape(form) for count, form in zip(shape, ((-1, 1, 1), (1, -1, 1), (1, 1, -1))))
    return (255 * numpy.clip(1.1 - numpy.sqrt(x * x + 2 * y * y + 3 * z * z), 0, 1)).astype(numpy.uint8)


class Images(unittest.TestCase):
    def setUp(self):
        self.array = ball()
        self.image = understudy.render(self.array, "engine", size=SIZE)

    def near(self, image, tolerance):
        self.assertLessEqual(float(numpy.abs(image - self.image).max()), tolerance)

    def test_is_premultiplied_floats_of_the_size(self):
        self.assertEqual((self.image.shape, self.image.dtype), ((48, 64, 4), numpy.float32))
        self.assertGreater(self.image[24, 32, 3], 0.5, "the middle is dense")
        self.assertEqual(float(self.image[0, 0].max()), 0, "the corner is empty")
        self.assertTrue((self.image[..., :3] <= self.image[..., 3:] + 1e-6).all())

    def test_is_the_command_s_image(self):
        with tempfile.TemporaryDirectory() as folder:
            raw, floats = Path(folder) / "ball.28x24x20.raw", Path(folder) / "image.pfm"
            raw.write_bytes(self.array.tobytes())
            subprocess.run([understudy.program(), "render", raw, "--tf", "engine", "--size", "64x48", "--out", f"{folder}/i.png",
                            "--save-float", floats], check=True, stdout=subprocess.DEVNULL)
            header, size, scale, pixels = floats.read_bytes().split(b"\n", 3)
            self.assertEqual((size, float(scale) < 0), (b"64 48", True))
            channels = 4 if header in (b"PF4", b"Pf4") else len(pixels) // (64 * 48 * 4)
            rows = numpy.frombuffer(pixels, dtype="<f4").reshape(48, 64, channels)[::-1]
            self.assertTrue(numpy.array_equal(rows[..., :3], self.image[..., :3]))

    def test_every_type_shows_the_same(self):
        for name in ("uint16", "int16", "int32", "uint64", "float32", "float64", ">i2", ">f4"):
            with self.subTest(name):
                values = self.array.astype(name)
                self.near(understudy.render(values * 3 - 100 if values.dtype.kind != "u" else values * 3, "engine", size=SIZE), 3e-5)

    def test_views_show_what_they_view(self):
        self.near(understudy.render(numpy.asfortranarray(self.array), "engine", size=SIZE), 0)
        double = numpy.repeat(self.array, 2, axis=0)
        self.near(understudy.render(double[::2], "engine", size=SIZE), 0)

    def test_does_not_copy_what_it_need_not(self):
        base = ball((64, 64, 64))
        volume = understudy.Volume(base)
        self.assertEqual(sys.getrefcount(base), 3, "the volume holds the array itself")
        del volume
        self.assertEqual(sys.getrefcount(base), 2)

    def test_volume_is_kept_between_images(self):
        volume = understudy.Volume(self.array)
        for settings in ({"light": "all"}, {"method": "pre-integrated"}, {"operator": "max"}, {"texels": "f32"}):
            other = volume.render("engine", size=SIZE, **settings)
            self.assertTrue(numpy.array_equal(other, understudy.render(self.array, "engine", size=SIZE, **settings)), settings)
        self.near(volume.render("engine", size=SIZE), 0)

    def test_nodes_make_the_same_image(self):
        with understudy.Nodes(2) as nodes:
            self.near(understudy.Volume(self.array, nodes=nodes).render("engine", size=SIZE), 1e-5)
        self.assertFalse(nodes.running())

    def test_tables_are_arrays_or_dicts(self):
        table = numpy.array([[1, 0, 0, 0], [1, 0, 0, 0.2], [1, 0, 0, 0.4]])
        image = understudy.render(self.array, table, size=SIZE)
        self.assertGreater(image[24, 32, 0], 0.5)
        self.assertEqual(float(image[..., 1:3].max()), 0)
        points = [{"at": at, "colour": [1, 0, 0], "opacity": 0.4 * at} for at in (0, 0.5, 1)]
        self.assertTrue(numpy.array_equal(image, understudy.render(self.array, {"knots": points}, size=SIZE)))

    def test_surfaces_and_spacing(self):
        surface = understudy.render(self.array, surfaces=["40%,#ff0000"], show_volume=False, size=SIZE)
        self.assertGreater(surface[24, 32, 0], 0.99)
        flat = understudy.render(self.array, surfaces=["40%,#ff0000"], show_volume=False, size=SIZE, spacing=(1, 1, 0.2))
        self.assertLess((flat[..., 3] > 0).sum(), (surface[..., 3] > 0).sum())

    def test_threads_may_share_a_volume(self):
        volume = understudy.Volume(self.array)
        expected = {texels: volume.render("engine", size=SIZE, texels=texels) for texels in ("u8", "f32")}
        wrong = []

        def render(texels):
            for _ in range(10):
                if not numpy.array_equal(volume.render("engine", size=SIZE, texels=texels), expected[texels]):
                    wrong.append(texels)

        threads = [threading.Thread(target=render, args=(texels,)) for texels in ("u8", "f32", "u8")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_over_is_eight_bits(self):
        shown = understudy.over(self.image, (1, 1, 1))
        self.assertEqual((shown.dtype, shown[0, 0].tolist()), (numpy.uint8, [255, 255, 255]))


class Mistakes(unittest.TestCase):
    def test_arrays_that_are_no_volumes(self):
        for array in (numpy.zeros((3, 3)), numpy.zeros((0, 3, 3)), numpy.zeros((2, 2, 2), complex), [[["a"]]]):
            self.assertRaises(ValueError, understudy.Volume, array)
        self.assertRaisesRegex(ValueError, "three positive", understudy.Volume, ball(), spacing=(1, 0, 1))

    def test_settings_that_are_wrong_name_what_is_right(self):
        volume = understudy.Volume(ball())
        for settings, words in (({"camera": (1, 2)}, "3 numbers"), ({"size": (0, 5)}, "must be 1 to"), ({"operator": "sum"}, "'add'"),
                                ({"transfer_function": "heat"}, "one of grey"), ({"surfaces": ["x"]}, "not a number"),
                                ({"step": 0}, "positive"), ({"transfer_function": numpy.zeros((3, 3))}, r"\(N, 4\)"),
                                ({"transfer_function": {"knots": 5}}, "knots"), ({"light": "sun"}, "'surfaces'"),
                                ({"transfer_function": numpy.full((3, 4), numpy.nan)}, "not finite"),
                                ({"value_range": (0, 1)}, "belongs to")):
            with self.subTest(settings):
                self.assertRaisesRegex(ValueError, words, volume.render, **settings)

    def test_nodes_come_back_after_a_rank_was_killed(self):
        with understudy.Nodes(1) as nodes:
            volume = understudy.Volume(ball(), nodes=nodes)
            before = volume.render(size=SIZE)
            ranks = subprocess.run(["pgrep", "-f", f"understudy-node --control {Path(nodes.socket).parent}"], check=False,
                                   capture_output=True, text=True).stdout.split()
            for rank in ranks:
                subprocess.run(["kill", "-9", rank], check=False)
            self.assertRaises(understudy.NodesLost, volume.render, size=SIZE)
            after = None
            for _ in range(200):
                try:
                    after = volume.render(size=SIZE)
                    break
                except understudy.NodesLost:
                    time.sleep(0.1)
            self.assertTrue(numpy.array_equal(before, after))

    def test_lost_nodes(self):
        with understudy.Nodes(1) as nodes:
            volume = understudy.Volume(ball(), nodes=nodes)
            volume.render(size=SIZE)
            nodes.close()
            self.assertRaises(understudy.NodesLost, volume.render, size=SIZE)
        self.assertRaises(understudy.NodesLost, understudy.Nodes, 0)


class Viewers(unittest.TestCase):
    def test_report_of_a_run(self):
        with tempfile.TemporaryDirectory() as folder:
            raw = Path(folder) / "ball.28x24x20.raw"
            raw.write_bytes(ball().tobytes())
            report = understudy.run([understudy.program("understudy-viewer"), raw, "--offscreen", "--frames", "3", "--window-size",
                                     "64", "64"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.assertEqual((report.frames_substituted, report.volumes[0].draws.substituted, report.exit_status), (3, 3, 0))
        self.assertRaisesRegex(AttributeError, "frames_substituted", lambda: report.frames_shown)

    def test_status_of_a_run(self):
        self.assertRaises(subprocess.CalledProcessError, understudy.run, ["false"], stderr=subprocess.DEVNULL)
        self.assertEqual(understudy.run(["false"], check=False, stderr=subprocess.DEVNULL).exit_status, 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
