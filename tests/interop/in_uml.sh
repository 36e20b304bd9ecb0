#!/bin/sh
# in_uml.sh COMMAND [ARGUMENT...]: runs a command with a vcan0 in User-mode Linux, on any host kernel.
# The files are the host's; /mnt is an empty memory file system. Exits with the command's status, or with 77 if there is
# no User-mode Linux. The time-out is nine minutes, or KOBOSHI_UML_TIMEOUT_S seconds, because the machine may be loaded.
set -eu

PATH=$PATH:/usr/sbin:/sbin
export PATH
if ! command -v linux.uml >/dev/null; then
  echo "skipped: there is no linux.uml (Debian's package user-mode-linux)"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
modules=$(echo /usr/lib/uml/modules/*/kernel)

# The ptrace wrapper that UML needs on processors with AMX. Scripts run by hand take it from build/release.
ptrace=${KOBOSHI_PTRACE_XSTATE:-$(dirname "$0")/../../build/release/tests/interop/libptrace_xstate.so}
[ -e "$ptrace" ] || { echo "in_uml.sh: there is no $ptrace: build first" >&2; exit 70; }

quoted() {
  for argument; do printf " '%s'" "$(printf %s "$argument" | sed "s/'/'\\\\''/g")"; done
}

cat >"$folder/init" <<INIT
#!/bin/sh
export PATH=$PATH HOME=$folder
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t tmpfs tmpfs /mnt
[ -e /dev/fd ] || ln -s /proc/self/fd /dev/fd
for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan; do
  insmod $modules/\$module.ko
done
ip link add dev vcan0 type vcan && ip link set vcan0 up && cd '$PWD' &&
  $(quoted "$@") >'$folder/output' 2>&1
echo \$? >'$folder/status'
halt -f
INIT
chmod +x "$folder/init"

limit_s=${KOBOSHI_UML_TIMEOUT_S:-540}
# UML keeps its sockets in the home folder and its memory in a file in TMPDIR, or in /dev/shm if that is unset.
ended=0
env -u TMPDIR -u TMP -u TEMP HOME="$folder" LD_PRELOAD="$(realpath "$ptrace")${LD_PRELOAD:+ $LD_PRELOAD}" \
  timeout "$limit_s" linux.uml rootfstype=hostfs rootflags=/ rw init="$folder/init" mem=512M con=null con0=fd:0,fd:1 \
  </dev/null >"$folder/console" 2>&1 || ended=$?
cat "$folder/output" 2>/dev/null || true
[ -s "$folder/status" ] && exit "$(cat "$folder/status")"
[ "$ended" -ne 124 ] || echo "in_uml.sh: no end within $limit_s s"
echo "in_uml.sh: User-mode Linux ended with status $ended, and without the command's; its console:"
cat "$folder/console"
exit 70
