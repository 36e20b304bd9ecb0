#!/bin/sh
# run_by_udp.sh KOBOSHI [SECONDS]: a walk in real time over UDP multicast in a separate network namespace. python-can
# must receive as many frames as the run reports as sent. docs/experiment/bus.md uses it with a minute of walking, as
# root, because only root may enlarge the listener's buffer enough.
set -eu

if [ "${3:-}" != inside ]; then
  exec "$(dirname "$0")/in_network.sh" "$0" "$1" "${2:-3}" inside
fi
koboshi=$1
seconds=$2
folder=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$folder"' EXIT

/usr/bin/python3 -B - "$folder" <<'PYTHON' &
import os
import pathlib
import socket
import sys

import can

SO_RCVBUFFORCE = 33  # asm-generic/socket.h
BUFFER_BYTES = 16 << 20  # holds several seconds of frames, like candump -r in run_on_vcan.sh

folder = pathlib.Path(sys.argv[1])
heard = 0
with can.Bus(interface="udp_multicast", channel="239.74.163.2") as bus:
    with socket.socket(fileno=os.dup(bus.fileno())) as receiver:
        receiver.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, BUFFER_BYTES)
    (folder / "listens").touch()
    while bus.recv(timeout=3 if heard else 60) is not None:  # until the bus falls silent
        heard += 1
(folder / "heard").write_text(str(heard))
PYTHON
listener=$!
until [ -e "$folder/listens" ]; do
  kill -0 "$listener"
  sleep 0.05
done
"$koboshi" run scenarios/walk.yaml --can udp:239.74.163.2:43113 --duration "$seconds" --out "$folder/run"
wait "$listener"

/usr/bin/python3 -B "$(dirname "$0")/compare_heard.py" "$folder/run/timing.json" "$(cat "$folder/heard")"
