#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# network.sh SWITCH MICROSECONDS HOSTS FOLDER [RATE]: makes HOSTS hosts, host1 and so on, as network namespaces,
# each with one connection of 1 Gbit/s, or of RATE, to a switch that forwards frames after a delay of
# MICROSECONDS. For a process in its own namespaces (mounts, network), which alone sees all of this; it
# disappears with them. FOLDER gets the hosts' names, and the output of the switch.
set -e
switch=$1 delay=$2 hosts=$3 folder=$4 rate=${5:-1gbit}

mount -t tmpfs none /run
ip link set lo up
echo "127.0.0.1 localhost" >"$folder/names"
ports=
for number in $(seq "$hosts"); do
  host=host$number
  ip netns add "$host"
  ip link add "port$number" type veth peer name eth0 netns "$host"
  ip link set "port$number" up
  ip -n "$host" addr add "10.77.0.$number/24" dev eth0
  ip -n "$host" link set lo up
  ip -n "$host" link set eth0 up
  ip netns exec "$host" tc qdisc add dev eth0 root tbf rate "$rate" burst 256kb latency 50ms
  echo "10.77.0.$number $host" >>"$folder/names"
  ports="$ports port$number"
done
mount --bind "$folder/names" /etc/hosts
# shellcheck disable=SC2086 # one word a port
setsid "$switch" "$delay" $ports >"$folder/switch.log" 2>&1 </dev/null &
# The caller may kill this script's process group once it has ended: by then the switch has left it.
until grep -q "^ready" "$folder/switch.log"; do
  kill -0 $! || { cat "$folder/switch.log" >&2; exit 1; }
  sleep 0.01
done
