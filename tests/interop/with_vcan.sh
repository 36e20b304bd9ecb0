#!/bin/sh
# with_vcan.sh COMMAND [ARGUMENT...]: runs a command with a private vcan0 and an empty memory file system on /mnt. Uses
# namespaces if this machine permits them, otherwise User-mode Linux (in_uml.sh). Prints the choice and its reason as
# the first line. Exits with the command's status, or with 77 if neither is available.
set -eu
PATH=$PATH:/usr/sbin:/sbin
export PATH

# The part that runs inside the namespaces. `ip` makes the kernel load the module; modprobe works where the kernel's
# settings forbid that.
if [ "$1" = --inside ]; then
  shift
  modprobe -qa vcan can-raw 2>/dev/null || true
  ip link add dev vcan0 type vcan
  ip link set vcan0 up
  # The largest listener's buffer of these tests: with the default one candump loses frames. Only root outside a
  # namespace may exceed rmem_max.
  complaint=$(candump -r 67108864 -T 1 vcan0 2>&1) && [ -z "$complaint" ] || { echo "$complaint"; exit 1; }
  mount -t tmpfs tmpfs /mnt
  status=0
  "$@" || status=$?  # no exec: as process 1 this shell must reap orphans
  exit $status
fi

# Includes a process namespace: the pages' commands end other processes by name.
in_namespaces() {
  unshare $([ "$(id -u)" -eq 0 ] || echo --map-root-user) --net --mount --pid --fork --kill-child --mount-proc sh "$0" --inside "$@" </dev/null
}

if reason=$(in_namespaces true 2>&1); then
  echo "vcan0: in a network namespace"
  in_namespaces "$@"
  exit
fi
echo "vcan0: in User-mode Linux, as a network namespace could not have one: $(echo "$reason" | tr '\n' ' ')"
exec "$(dirname "$0")/in_uml.sh" "$@"
