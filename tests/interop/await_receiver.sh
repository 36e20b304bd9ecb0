#!/bin/sh
# await_receiver.sh: waits until a program receives from vcan0.
set -eu

# A device without receivers is listed, too, as "(vcan0: no entry)".
until grep -q '^ *vcan0' /proc/net/can/rcvlist_all; do sleep 0.05; done
