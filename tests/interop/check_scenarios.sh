#!/bin/sh
# check_scenarios.sh KOBOSHI [SECONDS]: runs all scenarios and checks their logs as the tests check one. For use by
# hand.
set -eu

koboshi=$1
seconds=${2:-10}
here=$(dirname "$0")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for scenario in scenarios/*.yaml; do
  name=$(basename "$scenario" .yaml)
  log=$folder/$name/can.log
  if [ "$name" = board ]; then  # has no controller, so `koboshi run` refuses it
    mkdir "$folder/$name"
    "$koboshi" board "$scenario" --can "log:$log" --duration "$seconds"
  elif [ "$name" = teleop ]; then  # needs an operator at the keyboard
    "$koboshi" run "$scenario" --set teleop=false --duration "$seconds" --out "$folder/$name"
  else
    "$koboshi" run "$scenario" --duration "$seconds" --out "$folder/$name"
  fi
  "$here/check_can_log.sh" "$log"
  /usr/bin/python3 -B "$here/canopen_test.py" "$koboshi" "$log"
done
