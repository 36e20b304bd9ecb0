#!/bin/sh
# run_on_vcan.sh KOBOSHI [SECONDS [SPEED [STEPPER]]]: a walk by the clock on the wall, on vcan0; candump hears as many frames as the run
# says that it sent. Needs a vcan0: see with_vcan.sh. By hand with a minute of walking, for docs/experiment/bus.md.
set -eu

koboshi=$1
seconds=${2:-3}
speed=${3:-1}
stepper=${4:-lumped}

# There may be one processor for both, and candump takes half of it: it goes first, and may be some seconds late.
nice -n -20 candump -r 67108864 -L vcan0 >/mnt/can.log &
candump=$!
until grep -q vcan0 /proc/net/can/rcvlist_all; do sleep 0.05; done
"$koboshi" run scenarios/walk.yaml --set physics.stepper="$stepper" --can socketcan:vcan0 --speed "$speed" --duration "$seconds" --out /mnt/run
heard=-1
until [ "$heard" -eq "$(wc -l </mnt/can.log)" ]; do  # it may be behind
  heard=$(wc -l </mnt/can.log)
  sleep 1
done
kill "$candump"

/usr/bin/python3 -B "$(dirname "$0")/compare_heard.py" /mnt/run/timing.json "$heard"
