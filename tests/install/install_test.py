#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""install_test.py BUILD: what `cmake --install` installs runs from any place, without the build, and other programs build with it."""

import os
import re
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(sys.argv.pop(1)).resolve()
ENVIRONMENT = {"PATH": "/usr/bin:/bin", "HOME": "/nonexistent", "OMPI_ALLOW_RUN_AS_ROOT": "1",
               "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "UNDERSTUDY_SPEED_GUARD": "off"}
# Environment Modules on Debian and on Fedora, and Lmod.
MODULES = ("/usr/share/modules/init/bash", "/usr/share/Modules/init/bash", "/usr/share/lmod/lmod/init/bash")
# With the characters that separate entries of the loader's lists.
AWKWARD = "a prefix:with both"


def output_of(*command, environment=None, **more):
    done = subprocess.run([str(word) for word in command], env=environment or ENVIRONMENT, text=True, capture_output=True,
                          timeout=240, check=False, **more)
    if done.returncode != 0:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def install(prefix, *components):
    for component in components:
        output_of("cmake", "--install", BUILD, "--prefix", prefix, "--strip", "--component", component, environment=os.environ)


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.prefix = cls.folder / AWKWARD
        install(cls.folder / "first place", "runtime")
        (cls.folder / "first place").rename(cls.prefix)
        cls.volume = cls.folder / "ball.16x16x16.raw"
        cls.volume.write_bytes(bytes(max(0, 255 - 4 * ((x - 8) ** 2 + (y - 8) ** 2 + (z - 8) ** 2))
                                     for z in range(16) for y in range(16) for x in range(16)))
        cls.development = cls.folder / "development"
        install(cls.development, "development")

    def understudy(self, *words):
        return output_of(self.prefix / "bin" / "understudy", *words, cwd=self.folder)

    def run_viewer(self, *options):
        return self.understudy("run", "--require", *options, "--", self.prefix / "bin" / "understudy-viewer", self.volume,
                               "--offscreen", "--frames", "3", "--window-size", "64", "64")

    def test_version_names_the_folder(self):
        said = self.understudy("--version")
        self.assertRegex(said, r"^understudy \d+\.\d+\.\d+ \(")
        self.assertIn(str(self.prefix / "lib"), said)

    def test_viewer_is_substituted_by_each_injection_method(self):
        for injection in ("audit", "preload", "folder"):
            with self.subTest(injection):
                self.assertIn("3 substituted", self.run_viewer("--injection", injection))

    def test_viewer_is_substituted_by_nodes(self):
        if not (self.prefix / "bin" / "understudy-node").exists():
            self.skipTest("built without MPI")
        self.assertIn("3 substituted (2 nodes)", self.run_viewer("-n", "2"))

    def test_module_is_loaded_and_unloaded(self):
        start = next((path for path in MODULES if os.path.exists(path)), None)
        if start is None:
            self.skipTest("neither Environment Modules nor Lmod is installed")
        first, place = self.folder / "first module", self.folder / "moved module"
        install(first, "runtime", "modulefile")
        first.rename(place)
        script = ('source "$1"; module use "$2/share/modulefiles"; module load understudy; understudy --version; '
                  'echo "man $MANPATH"; module unload understudy; command -v understudy || echo gone')
        said = output_of("bash", "-c", script, "bash", start, place)
        self.assertRegex(said, r"(?m)^understudy \d")
        # Ends with an empty entry, which stands for the system's pages.
        self.assertIn(f"man {place}/share/man:\n", said)
        self.assertTrue(said.endswith("gone\n"), said)

    def test_no_installed_file_names_the_build(self):
        for place in (self.prefix, self.development):
            for path in place.rglob("*"):
                # Archives contain the paths of their sources, for debuggers.
                if path.is_file() and not path.is_symlink() and path.suffix != ".a":
                    self.assertNotIn(str(BUILD).encode(), path.read_bytes(), path)

    def test_programs_alone_are_executable(self):
        for path in self.prefix.rglob("*"):
            # Libraries are executable on some distributions, and not on others.
            if path.is_file() and not path.is_symlink() and ".so" not in path.name:
                self.assertEqual(bool(path.stat().st_mode & stat.S_IXUSR), path.parent.name == "bin", path)

    def test_pages_and_completions_know_every_subcommand(self):
        help_text = self.understudy("--help")
        subcommands = re.findall(r"^  (\w+)  ", help_text[help_text.index("Subcommands:"):], re.MULTILINE)
        self.assertGreater(len(subcommands), 10)
        for page in ("man/man1/understudy.1", "bash-completion/completions/understudy", "zsh/vendor-completions/_understudy",
                     "fish/vendor_completions.d/understudy.fish"):
            text = (self.prefix / "share" / page).read_text()
            for subcommand in subcommands:
                self.assertRegex(text, rf"\b{subcommand}\b", page)

    def test_bash_completes_the_command_line(self):
        def completed(*words):
            script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _understudy; echo "${COMPREPLY[@]}"')
            page = self.prefix / "share/bash-completion/completions/understudy"
            return output_of("bash", "-c", script, "bash", page, "understudy", *words).split()

        self.assertEqual(completed("repl"), ["replay"])
        self.assertEqual(completed("run", "--gath"), ["--gather"])
        self.assertEqual(completed("run", "--gather", ""), ["direct", "root"])
        self.assertEqual(completed("render", str(self.volume)[:-2]), [str(self.volume)])
        self.assertIn("true", completed("run", "--", "tru"))

    def test_a_program_is_built_with_the_cmake_package(self):
        build = self.folder / "cmake"
        output_of("cmake", "-S", ROOT / "examples/raycast", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.development}",
                  "-DCMAKE_BUILD_TYPE=Debug", environment=os.environ)
        output_of("cmake", "--build", build, environment=os.environ)
        self.check_image(build / "raycast")

    def test_a_program_is_built_with_pkg_config(self):
        settings = {**os.environ, "PKG_CONFIG_PATH": str(self.development / "lib/pkgconfig")}
        words = output_of("pkg-config", "--cflags", "--libs", "understudy-raycast", environment=settings).split()
        program = self.folder / "pkg-config-program"
        output_of("c++", ROOT / "examples/raycast/main.cc", *words, "-o", program, environment=settings)
        self.check_image(program)

    def check_image(self, program):
        image = subprocess.run([program], check=True, capture_output=True, timeout=60).stdout
        self.assertTrue(image.startswith(b"P6 400 300 255\n"))
        pixels = image[-3 * 400 * 300:]
        self.assertGreater(sum(byte > 40 for byte in pixels), 3000, "the shells show in the middle")
        self.assertEqual(pixels[0], 0, "and not in the corner")

    def test_a_unit_is_built_apart_and_named_in_a_chain(self):
        build = self.folder / "unit"
        output_of("cmake", "-S", ROOT / "examples/spu", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.development}",
                  environment=os.environ)
        output_of("cmake", "--build", build, environment=os.environ)
        plugins = self.prefix / "lib" / "understudy" / "plugins"
        environment = {**ENVIRONMENT, "UNDERSTUDY_PLUGINS": str(build)}
        units = output_of(self.prefix / "bin" / "understudy", "units", environment=environment)
        self.assertRegex(units, r"wireframe +draws the edges of polygons alone")

        def draw(image, *options, **more):
            return output_of(self.prefix / "bin" / "understudy", "run", *options, "--", self.prefix / "bin" / "understudy-viewer",
                             self.volume, "--offscreen", "--frames", "2", "--window-size", "64", "64", "--screenshot", image,
                             cwd=self.folder, **more)

        draw("solid.png", "--chain", "track driver")
        draw("by_name.png", "--chain", "wireframe(width=2) track driver", environment=environment)
        draw("by_file.png", "--chain", "unit/wireframe.so(width=2) track driver")
        shutil.copytree(build, plugins, ignore=lambda folder, names: [name for name in names if not name.endswith(".so")])
        draw("installed.png", "--chain", "wireframe(width=2) track driver")
        shutil.rmtree(plugins)
        images = {path.stem: path.read_bytes() for path in self.folder.glob("*.png")}
        self.assertNotEqual(images["by_name"], images["solid"])
        self.assertEqual(images["by_name"], images["by_file"])
        self.assertEqual(images["by_name"], images["installed"])

    def test_what_is_no_unit_of_this_version_is_refused_with_a_reason(self):
        def refusal(source, *flags):
            (self.folder / "other.cc").write_text(source)
            output_of("c++", "-shared", "-fPIC", "-std=c++20", *flags, self.folder / "other.cc", "-o", self.folder / "other.so",
                      environment=os.environ)
            done = subprocess.run([self.prefix / "bin" / "understudy", "run", "--chain", "./other.so driver", "--", "true"],
                                  cwd=self.folder, env=ENVIRONMENT, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 2, done.stderr)
            return done.stderr

        self.assertIn("exports no `understudy_unit`", refusal("int nothing;\n"))
        later = ("#include <spu/plugin/unit_plugin.h>\nUNDERSTUDY_EXPORT_UNIT{.interface = 99, .name = \"other\", .help = \"\"};\n")
        include = f"-I{self.development}/include/understudy"
        self.assertIn("another version of Understudy", refusal(later, include))
        self.assertIn("leaves out its name, help or make()", refusal(later.replace(".interface = 99, ", ""), include))

    def test_an_unknown_component_is_named(self):
        project = self.folder / "unknown"
        project.mkdir()
        (project / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(unknown LANGUAGES CXX)\n"
                                                "find_package(Understudy REQUIRED COMPONENTS raycats)\n")
        done = subprocess.run(["cmake", "-S", project, "-B", project / "out", f"-DCMAKE_PREFIX_PATH={self.development}"],
                              capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no 'raycats'", " ".join(done.stderr.split()))


if __name__ == "__main__":
    unittest.main(verbosity=2)
