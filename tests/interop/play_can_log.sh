#!/bin/sh
# play_can_log.sh LOG: canplayer sends the log to vcan0, and candump must receive the same frames in the same order.
# Needs a vcan0: see with_vcan.sh.
set -eu

log=$1
folder=$(mktemp -d -p /mnt)

candump -r 16777216 -L vcan0 >"$folder/seen.log" &
candump=$!
"$(dirname "$0")/await_receiver.sh"
canplayer -t -I "$log"
until [ "$(wc -l <"$folder/seen.log")" -ge "$(wc -l <"$log")" ] || [ "${waited:=0}" -ge 600 ]; do
  waited=$((waited + 1))
  sleep 0.05
done
kill "$candump"

cut -d' ' -f3 "$log" >"$folder/sent"
cut -d' ' -f3 "$folder/seen.log" >"$folder/seen"
cmp "$folder/sent" "$folder/seen"
echo "canplayer: $(wc -l <"$folder/seen") frames sent and seen"
