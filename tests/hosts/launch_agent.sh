#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# launch_agent.sh [OPTIONS] HOST COMMAND…: what ssh is to hosts, for hosts that are network namespaces. As with ssh, the
# command is one line for a shell, gets an environment of its own, and nothing runs on a host that the network does not
# reach: somebody must answer there, if only by refusing the connection. The launcher's folder is not there.
while [[ $1 == -* ]]; do shift; done
host=$1
shift
answer=$(timeout 20 bash -c ": <>/dev/tcp/$host/22" 2>&1)
if [[ $answer != *refused* ]]; then
  echo "launch_agent: ${answer##*: }" >&2
  exit 255
fi
# All that is taken along is the mark by which a test finds its processes again; beside it lies the test's own folder
# for temporary files.
exec ip netns exec "$host" env -i PATH="$PATH" HOME=/ XDG_RUNTIME_DIR="$XDG_RUNTIME_DIR" \
  TMPDIR="${XDG_RUNTIME_DIR%/*}/tmp" unshare --uts --mount \
  sh -c "hostname $host && mount -t tmpfs none '$XDG_RUNTIME_DIR' && $*"
