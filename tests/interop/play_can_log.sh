#!/bin/sh
# play_can_log.sh LOG: canplayer sends the log to vcan0, and candump must receive the same frames in the same order.
# Needs a vcan0: see with_vcan.sh.
set -eu

log=$1
folder=$(mktemp -d -p /mnt)

candump -r 16777216 -L vcan0 >"$folder/seen.log" 2>"$folder/said" &
candump=$!
trap 'cat "$folder/said" >&2' EXIT
"$(dirname "$0")/await_receiver.sh" "$candump"
canplayer -t -I "$log"
# Waits for as long as candump still receives. It has lost frames if it receives no further one in 10 s.
expected=$(wc -l <"$log")
seen=0
waits=0
until [ "$seen" -ge "$expected" ]; do
  kill -0 "$candump" 2>/dev/null || { echo "candump has ended after $seen of $expected frames" >&2; exit 1; }
  [ "$waits" -lt 200 ] || { echo "candump has received $seen of $expected frames" >&2; exit 1; }
  sleep 0.05
  before=$seen
  seen=$(wc -l <"$folder/seen.log")
  waits=$((waits + 1))
  [ "$seen" -eq "$before" ] || waits=0
done
kill "$candump"

cut -d' ' -f3 "$log" >"$folder/sent"
cut -d' ' -f3 "$folder/seen.log" >"$folder/seen"
cmp "$folder/sent" "$folder/seen"
echo "canplayer: $(wc -l <"$folder/seen") frames sent and seen"
