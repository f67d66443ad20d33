#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# launch_agent.sh [OPTIONS] HOST COMMAND...: replaces ssh for hosts that are network namespaces. As with ssh,
# the command is one line for a shell and gets its own environment, and nothing runs on a host that the network
# does not reach: the host must answer, if only by refusing the connection. The launcher's folder is hidden.
while [[ $1 == -* ]]; do shift; done
host=$1
shift
answer=$(timeout 20 bash -c ": <>/dev/tcp/$host/22" 2>&1)
if [[ $answer != *refused* ]]; then
  echo "launch_agent: ${answer##*: }" >&2
  exit 255
fi
# Passes on PATH, and the folder by which a test recognizes its processes; the test's own folder for temporary
# files is beside that one.
exec ip netns exec "$host" env -i PATH="$PATH" HOME=/ XDG_RUNTIME_DIR="$XDG_RUNTIME_DIR" \
  TMPDIR="${XDG_RUNTIME_DIR%/*}/tmp" unshare --uts --mount \
  sh -c "hostname $host && mount -t tmpfs none '$XDG_RUNTIME_DIR' && $*"
