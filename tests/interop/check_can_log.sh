#!/bin/sh
# check_can_log.sh LOG: checks a log with third-party CAN tools. can-utils must convert it to Vector's format and back
# without a change, and Wireshark's CANopen dissector must find every frame and none malformed.
set -eu

log=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
lines=$(wc -l <"$log")
fail() {
  echo "$log: $*" >&2
  exit 1
}

[ "$lines" -gt 0 ] || fail "no frames"

log2asc -I "$log" -O "$folder/log.asc" vcan0
asc2log -I "$folder/log.asc" -O "$folder/back.log"
cut -d' ' -f3 "$log" >"$folder/frames"
cut -d' ' -f3 "$folder/back.log" >"$folder/frames_back"
cmp "$folder/frames" "$folder/frames_back" || fail "log2asc and asc2log changed it"

tshark -r "$log" -d can.subdissector,canopen -T fields -e frame.number -e frame.time_epoch -e can.id -e _ws.malformed \
  -e _ws.col.Protocol -e _ws.col.Info >"$folder/dissected" 2>"$folder/tshark_errors" ||
  fail "tshark: $(cat "$folder/tshark_errors")"
[ "$(wc -l <"$folder/dissected")" -eq "$lines" ] || fail "tshark read $(wc -l <"$folder/dissected") of $lines frames"
awk -F'\t' '$4 != "" || $6 ~ /Malformed/ { print; bad = 1 } END { exit bad }' "$folder/dissected" >&2 ||
  fail "malformed for tshark"
awk -F'\t' '$5 != "CANopen" { print; bad = 1 } END { exit bad }' "$folder/dissected" >&2 || fail "not CANopen for tshark"

# The log pads seconds to ten digits, tshark adds nanoseconds.
cut -d' ' -f1 "$log" | sed 's/^(0*\([0-9]\)/\1/; s/)$/000/' >"$folder/times"
cut -f2 "$folder/dissected" | cmp - "$folder/times" || fail "tshark reads other times"

echo "$lines frames: log2asc, asc2log and tshark agree"
