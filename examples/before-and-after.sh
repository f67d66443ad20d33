#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Runs a viewer bare and under Understudy, and prints what was substituted and the median time of a frame.
#
#   before-and-after.sh FOLDER viewer args…
#
# Writes report.json and the output of both runs (bare.log, understudy.log) to FOLDER.
set -eu
folder=$1
shift
mkdir -p "$folder"
"$@" >"$folder/bare.log" 2>&1
understudy run --explain --report "$folder/report.json" -- "$@" >"$folder/understudy.log" 2>&1
tail -n 1 "$folder/understudy.log"
python3 - "$folder/report.json" <<'PYTHON'
import json
import sys

report = json.load(open(sys.argv[1], encoding="utf-8"))
times = report["time_ms"]
print(f"median of substituted frames: {times['substituted_median']} ms, of other frames: {times['application_median']} ms")
for volume in report["volumes"]:
    print(volume["size"], "left because:", volume["left_because"] or "it was not left")
PYTHON
