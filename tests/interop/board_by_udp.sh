#!/bin/sh
# board_by_udp.sh KOBOSHI EDS: runs the simulated board on python-can's udp_multicast in a separate network namespace. A
# python-can master boots, enables and moves its drives.
set -eu

if [ "${3:-}" != inside ]; then
  exec timeout 200 "$(dirname "$0")/in_network.sh" "$0" "$1" "$2" inside
fi
folder=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$folder"' EXIT  # stops the board on any exit

"$1" board --can udp:239.74.163.2:43113 >"$folder/board" 2>&1 &
board=$!
until grep -q 'CAN bus on' "$folder/board"; do
  kill -0 "$board" || { cat "$folder/board"; exit 1; }
  sleep 0.05
done
/usr/bin/python3 -B "$(dirname "$0")/board_master.py" "$2" udp_multicast 239.74.163.2
kill -INT "$board"
wait "$board"
cat "$folder/board"
