#!/bin/sh
# foreign_on_vcan.sh KOBOSHI: `koboshi can dump` shows the frames of every format that others send on vcan0, and goes on.
# Needs a vcan0: see with_vcan.sh.
set -eu
koboshi=$1
ip link set vcan0 down
ip link set vcan0 mtu 72 # of CAN FD
ip link set vcan0 up
"$koboshi" can dump --can socketcan:vcan0 --count 12 >/mnt/seen &
dump=$!
while kill -0 $dump 2>/dev/null; do # it may not listen yet
  for frame in 18FEF100#0102 123##1AABB 18FEF100##0AA 701#R 20000004#0001000000000000 181#00; do cansend vcan0 $frame; done
done
wait $dump
for line in '18FEF100#0102  *29-bit identifier' '123##1AABB  *CAN FD, bit rate switch' \
  '18FEF100##0AA  *CAN FD, 29-bit identifier' '701#R  *remote request of node 1' \
  '20000004#0001000000000000  error frame: controller (receive overflow)' '181#00'; do
  grep -q "$line" /mnt/seen || { echo "no '$line' in"; cat /mnt/seen; exit 1; } >&2
done
