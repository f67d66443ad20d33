#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""report_schema_test.py PROGRAMS: validates reports of runs with and without nodes, budgets and GL servers against
docs/schema, key by key: a report may not contain keys that its schema does not name."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import jsonschema

SCHEMAS = Path(__file__).resolve().parents[3] / "docs" / "schema"
PROGRAMS = Path(sys.argv.pop(1)).resolve()
VOLUME = "synthetic:32x32x32:u8:shells"


def validator(name):
    schemas = {path.name: json.loads(path.read_text()) for path in SCHEMAS.glob("*.json")}
    for schema in schemas.values():
        jsonschema.Draft202012Validator.check_schema(schema)
    # Merged into one schema without references to files, because versions of jsonschema resolve references differently.
    whole = schemas[name]
    origin = schemas["origin.schema.json"]
    whole["properties"]["origin"] = {key: value for key, value in origin.items() if not key.startswith("$")}
    whole["$defs"] = {**origin["$defs"], **whole["$defs"]}
    return jsonschema.Draft202012Validator(whole)


class Reports(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.volume = self.folder / "ball.16x16x16.raw"
        self.volume.write_bytes(bytes(max(0, 255 - 4 * ((x - 8) ** 2 + (y - 8) ** 2 + (z - 8) ** 2))
                                      for z in range(16) for y in range(16) for x in range(16)))

    def understudy(self, *words):
        environment = {**os.environ, "UNDERSTUDY_SPEED_GUARD": "off", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                       "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        done = subprocess.run([PROGRAMS / "understudy", *map(str, words)], env=environment, capture_output=True, text=True,
                              timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def check(self, schema, command, *words):
        path = self.folder / "report.json"
        self.understudy(command, "--report", path, *words)
        report = json.loads(path.read_text())
        errors = [f"{list(error.absolute_path)}: {error.message}" for error in validator(schema).iter_errors(report)]
        self.assertEqual(errors, [])
        self.assertEqual(report["origin"]["command"][1], command)
        return report

    def run_viewer(self, *options):
        return self.check("run-report.schema.json", "run", *options, "--", PROGRAMS / "understudy-viewer", self.volume,
                          "--offscreen", "--frames", "3", "--orbit", "5", "--window-size", "64", "64")

    def test_a_run_in_the_viewer(self):
        self.assertEqual(len(self.run_viewer("--verify=1")["volumes"]), 1)

    @unittest.skipUnless((PROGRAMS / "understudy-node").exists(), "built without MPI")
    def test_a_run_with_nodes_and_a_budget(self):
        self.assertEqual(self.run_viewer("-n", "2", "--error", "0.01")["nodes"], 2)

    def test_a_run_by_a_gl_server(self):
        self.assertIsNotNone(self.run_viewer("--remote")["server_connection"])

    def test_a_run_without_a_volume(self):
        self.assertEqual(self.check("run-report.schema.json", "run", "--", "true")["volumes"], [])

    def test_a_rendering_here_and_by_nodes(self):
        nodes = ("-n", "2") if (PROGRAMS / "understudy-node").exists() else ()
        for options in ((), (*nodes, "--surface", "50%", "--light", "surfaces")):
            self.check("render-report.schema.json", "render", VOLUME, "--transfer-function", "ct", "--size", "64x64",
                       "--out", self.folder / "image.png", *options)


if __name__ == "__main__":
    unittest.main(verbosity=2)
