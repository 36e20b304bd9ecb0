#!/bin/sh
# firmware_on_vcan.sh KOBOSHI: runs firmware and board as two processes on vcan0. cansend enables the drives, and
# candump shows that the robot stands. Both run at a tenth of real time: User-mode Linux has one processor and slow
# system calls. Needs a vcan0: see with_vcan.sh.
set -eu

koboshi=$1

"$koboshi" board --can socketcan:vcan0 --speed 0.1 --set physics.stepper=lumped >/mnt/board 2>&1 &
board=$!
until grep -q 'CAN bus on' /mnt/board; do
  kill -0 "$board" || { cat /mnt/board; exit 1; }
  sleep 0.05
done
"$koboshi" firmware scenarios/squat.yaml --can socketcan:vcan0 --speed 0.1 >/mnt/firmware 2>&1 &
firmware=$!
# reach HEX COMMAND...: repeats the command until the controller's telemetry shows this state. The controller refuses to
# enable the drives until its attitude estimate has settled.
reach() {
  state=$1
  shift
  for _ in $(seq 300); do
    "$@"
    candump -T 1000 -n 1 vcan0,181:7FF | grep -q "\[8\]  $state" && return
  done
  echo "the controller is not in state $state:" && candump -T 1000 -n 3 vcan0,181:7FF
  cat /mnt/firmware /mnt/board
  exit 1
}
reach 01 true
reach 04 cansend vcan0 201#010000
"$koboshi" can stats --can socketcan:vcan0 --duration 5
kill -INT "$firmware"
wait "$firmware"
kill -INT "$board"
wait "$board"
cat /mnt/firmware /mnt/board
