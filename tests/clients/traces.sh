#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Records and plays real viewers. Native replays must equal replays through pack and unpack bit for bit, and show what
# the viewer itself showed; if a live run on two ranks substitutes, a replay on two ranks must substitute as well.
#   traces.sh BUILD/bin VIEWER_SCRIPT [NAME...]      NAME: osgvolume pyqtgraph pymol vtk
# VIEWER_SCRIPT NAME OUT.png FRAMES runs a viewer with the command in $WITH before it, and saves what the viewer shows.
# Exit status 77: no viewer is installed.
set -u
programs=$(realpath "$1") viewer=$(realpath -m "$2") tried=0 failed=0
[ -x "$viewer" ] || { echo "traces.sh: no script at $viewer that runs viewers"; exit 77; }
shift 2
names=("$@")
((${#names[@]} > 0)) || names=(osgvolume pyqtgraph pymol vtk)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
understudy=$programs/understudy

declare -A needs=([osgvolume]='command -v osgvolume' [pyqtgraph]='/usr/bin/python3 -c "import pyqtgraph, OpenGL"'
  [pymol]='command -v pymol' [vtk]='/usr/bin/python3 -c "import vtk"')
# Which of the saved images is the viewer's screenshot: the frame in its window, or the pixels that it read back.
declare -A shot=([osgvolume]=frame [pyqtgraph]=frame [pymol]=read [vtk]=read)

fail() { echo "traces.sh: $*" >&2; failed=1; }

# Whether slices of a volume were substituted. Frames may end in a different context than the one that drew them.
substitutes() {
  python3 -c 'import json, sys
volumes = json.load(open(sys.argv[1]))["volumes"]
print("yes" if any(volume["draws"]["substituted"] > 0 for volume in volumes) else "no")' "$1"
}

# psnr A B: the PSNR in dB of the lower left part common to both; osgvolume's viewport is larger than its window.
psnr() {
  local size
  size=$(identify -format '%wx%h' "$2")
  convert "$1" -alpha off -gravity SouthWest -crop "$size+0+0" +repage "$work/cropped.png"
  convert "$2" -alpha off "$work/plain.png"
  "$understudy" compare "$work/cropped.png" "$work/plain.png" | sed -n 's/^PSNR \([0-9inf.]*\) dB$/\1/p'
}

for name in "${names[@]}"; do
  if ! eval "${needs[$name]}" >/dev/null 2>&1; then
    echo "traces.sh: $name is not installed; ./run test --full installs it"
    continue
  fi
  tried=1
  folder=$work/$name
  trace=$folder/trace.ust
  mkdir "$folder"
  RES=half WITH="$understudy run --chain driver --trace $trace --" "$viewer" "$name" "$folder/live.png" 5 \
    >"$folder/log" 2>&1 || { cat "$folder/log"; fail "$name could not be recorded"; continue; }
  "$understudy" replay --native --save-frames "$folder/native" "$trace" || fail "$name: native replay"
  "$understudy" replay --chain 'pack unpack track driver' --save-frames "$folder/packed" "$trace" ||
    fail "$name: replay through pack and unpack"
  diff -rq "$folder/native" "$folder/packed" || fail "$name: pack and unpack change images"
  last=$(ls "$folder/native/${shot[$name]}"_*.png | tail -n 1)
  decibels=$(psnr "$last" "$folder/live.png")
  echo "$name: $(ls "$folder/native" | wc -l) images, $decibels dB against its screenshot"
  [ "$decibels" = inf ] || [ "${decibels%.*}" -ge 50 ] 2>/dev/null || fail "$name: the replay shows something else"

  RES=half WITH="$understudy run -n 2 --report $folder/live.json --" "$viewer" "$name" "$folder/live2.png" 5 \
    >"$folder/log" 2>&1 || { cat "$folder/log"; fail "$name could not be run on two ranks"; continue; }
  "$understudy" replay -n 2 --report "$folder/replay.json" "$trace" || fail "$name: replay on two ranks"
  live=$(substitutes "$folder/live.json") replayed=$(substitutes "$folder/replay.json")
  echo "$name: substituted live: $live, replayed: $replayed"
  [ "$live" = "$replayed" ] || fail "$name: live run and replay differ in what is substituted"
done
((tried)) || exit 77
exit $failed
