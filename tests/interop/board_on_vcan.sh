#!/bin/sh
# board_on_vcan.sh KOBOSHI EDS: runs the simulated board on vcan0. A python-can master boots its drives, and enables and
# moves some of them, while candump records. Needs a vcan0: see with_vcan.sh.
set -eu
trap 'cat /mnt/board' EXIT  # also after a failure

koboshi=$1
eds=$2
here=$(dirname "$0")
log=$(mktemp -p /mnt)

candump -r 16777216 -L vcan0 >"$log" &
"$here/await_receiver.sh" "$!"
"$koboshi" board --can socketcan:vcan0 >/mnt/board 2>&1 &
board=$!
until grep -q 'CAN bus on' /mnt/board; do
  kill -0 "$board" || { echo "the board has ended"; exit 1; }
  sleep 0.05
done
/usr/bin/python3 -B "$here/board_master.py" "$eds" socketcan vcan0 4
kill -INT "$board"
wait "$board"
sleep 0.2
echo "$(wc -l <"$log") frames in candump"
