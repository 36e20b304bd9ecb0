#!/bin/sh
# with_vcan.sh COMMAND [ARGUMENT...]: runs a command where there is a vcan0 of its own, and an empty memory file system on /mnt: in
# namespaces where this machine lets it make them, else in User-mode Linux (in_uml.sh). Its first line says which, and why. Exits with the
# command's status, or with 77 where there is neither.
set -eu
PATH=$PATH:/usr/sbin:/sbin
export PATH

# Inside the namespaces. `ip` lets the kernel load the module that it needs; modprobe does where its settings forbid only that.
if [ "$1" = --inside ]; then
  shift
  modprobe -qa vcan can-raw 2>/dev/null || true
  ip link add dev vcan0 type vcan
  ip link set vcan0 up
  # A listener's buffer, the largest of any test here: without it, it loses frames. Only root of the machine may exceed rmem_max.
  complaint=$(candump -r 67108864 -T 1 vcan0 2>&1) && [ -z "$complaint" ] || { echo "$complaint"; exit 1; }
  mount -t tmpfs tmpfs /mnt
  status=0
  "$@" || status=$?  # no exec: this shell is process 1, and collects orphans that end
  exit $status
fi

# Of processes, too: the commands of a page end others by name.
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
