#!/bin/sh
# board_by_slcand.sh KOBOSHI EDS: attaches the simulated board as a serial CAN adapter with slcand and runs a python-can
# master on the interface. Runs in User-mode Linux (in_uml.sh): on other kernels slcand creates the interface outside
# all network namespaces.
set -eu
trap 'cat /mnt/board' EXIT  # also after a failure

insmod /usr/lib/uml/modules/*/kernel/drivers/net/can/slcan/slcan.ko
mkdir -p /dev/pts
mount -t devpts devpts /dev/pts
"$1" board --can slcan >/mnt/board 2>&1 &
board=$!
until grep -q 'CAN bus on' /mnt/board; do
  kill -0 "$board" || { echo "the board has ended"; exit 1; }
  sleep 0.05
done
slcand -o -s8 -F "$(sed -n 's/CAN bus on //p' /mnt/board)" slcan0 >/mnt/slcand 2>&1 &
until ip link show slcan0 >/dev/null 2>&1; do
  kill -0 $! || { cat /mnt/slcand; exit 1; }
  sleep 0.05
done
ip link set slcan0 up
/usr/bin/python3 -B "$(dirname "$0")/board_master.py" "$2" socketcan slcan0 4
kill -INT "$board"
wait "$board"
