#!/bin/sh
# firmware_on_vcan.sh KOBOSHI: runs firmware and board as two processes on vcan0. cansend enables the drives, and
# candump shows that the robot stands. Both run at a tenth of real time: User-mode Linux has one processor and slow
# system calls. Needs a vcan0: see with_vcan.sh. Prints what both have written and, after a failure, the step that failed.
set -eu

koboshi=$1
# begin STEP: names the step, also in the output of a test that is killed.
begin() {
  step=$1
  echo "== $step"
}
report() {
  status=$?
  for program in board firmware; do
    sed "s/^/$program: /" "/mnt/$program" || true
  done
  [ "$status" -eq 0 ] || echo "firmware_on_vcan.sh: $step: status $status"
}
trap report EXIT
begin "starting the board"

fail() {
  echo "firmware_on_vcan.sh: $*"
  exit 1
}

# Ends the test if one of the programs has ended by itself.
check_running() {
  kill -0 "$board" || fail "the board has ended"
  [ -z "$firmware" ] || kill -0 "$firmware" || fail "the firmware has ended"
}

firmware=
: >/mnt/firmware
"$koboshi" board --can socketcan:vcan0 --speed 0.1 >/mnt/board 2>&1 &
board=$!
until grep -q 'CAN bus on' /mnt/board; do
  check_running
  sleep 0.05
done
begin "starting the firmware"
"$koboshi" firmware scenarios/squat.yaml --can socketcan:vcan0 --speed 0.1 >/mnt/firmware 2>&1 &
firmware=$!
# reach HEX COMMAND...: repeats the command until the controller's telemetry shows this state. The controller refuses to
# enable the drives until its attitude estimate has settled. The number of tries is no deadline: on a loaded machine
# the time-out of in_uml.sh or of ctest ends a robot that does not get there.
reach() {
  state=$1
  begin "reaching state $state"
  shift
  for _ in $(seq 3000); do
    check_running
    "$@" || echo "repeated after status $?: $*"
    telemetry=$(candump -T 1000 -n 1 vcan0,181:7FF)
    case $telemetry in
      *"[8]  $state"*) return ;;
      # A loaded machine that stops for a fifth of a second loses the drives for the controller: it begins again.
      *"[8]  06"*) echo "reset after a fault: $telemetry"; cansend vcan0 201#060000 ;;
    esac
  done
  echo "the telemetry now:"
  candump -T 1000 -n 3 vcan0,181:7FF
  fail "the controller has not reached state $state"
}
reach 01 true
reach 04 cansend vcan0 201#010000
begin "measuring the load of the bus"
"$koboshi" can stats --can socketcan:vcan0 --duration 5
begin "ending the firmware"
kill -INT "$firmware"
wait "$firmware"
begin "ending the board"
kill -INT "$board"
wait "$board"
