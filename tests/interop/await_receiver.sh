#!/bin/sh
# await_receiver.sh PID: waits until a program receives from vcan0. Fails if the process PID ends before.
set -eu

# A device without receivers is listed, too, as "(vcan0: no entry)".
until grep -q '^ *vcan0' /proc/net/can/rcvlist_all; do
  kill -0 "$1" 2>/dev/null || { echo "await_receiver.sh: the receiver has ended" >&2; exit 1; }
  sleep 0.05
done
