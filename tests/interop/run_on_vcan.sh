#!/bin/sh
# run_on_vcan.sh KOBOSHI [SECONDS [SPEED [STEPPER]]]: a walk in real time on vcan0. candump must receive as many frames
# as the run reports as sent. Needs a vcan0: see with_vcan.sh. docs/experiment/bus.md uses it with a minute of walking.
set -eu

koboshi=$1
seconds=${2:-3}
speed=${3:-1}
stepper=${4:-lumped}

# On a single processor candump takes half of it. It therefore gets the highest priority and may finish seconds late.
nice -n -20 candump -r 67108864 -L vcan0 >/mnt/can.log &
candump=$!
"$(dirname "$0")/await_receiver.sh" "$candump"
"$koboshi" run scenarios/walk.yaml --set physics.stepper="$stepper" --can socketcan:vcan0 --speed "$speed" --duration "$seconds" --out /mnt/run
compare() {
  /usr/bin/python3 -B "$(dirname "$0")/compare_heard.py" /mnt/run/timing.json "$(wc -l </mnt/can.log)"
}
# candump may lag by seconds on a loaded machine; a second later it must still have heard no more.
tries=0
until compare >/mnt/compared 2>&1 || [ "$tries" -eq 60 ]; do
  kill -0 "$candump" || { echo "run_on_vcan.sh: candump has ended"; exit 1; }
  tries=$((tries + 1))
  sleep 1
done
sleep 1
kill "$candump"
compare
