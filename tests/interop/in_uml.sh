#!/bin/sh
# in_uml.sh COMMAND [ARGUMENT...]: runs a command where there is a vcan0, in User-mode Linux, whatever the kernel outside.
# The files are the host's; /mnt is an empty memory file system. Exits with the command's status; after two minutes, or
# KOBOSHI_UML_TIMEOUT_S seconds, it gives up.
set -eu

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
modules=$(echo /usr/lib/uml/modules/*/kernel)

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

# It keeps its sockets in the home folder.
PATH=$PATH:/usr/sbin:/sbin HOME=$folder
export PATH HOME
timeout "${KOBOSHI_UML_TIMEOUT_S:-120}" linux.uml rootfstype=hostfs rootflags=/ rw init="$folder/init" mem=512M con=null con0=fd:0,fd:1 \
  </dev/null >"$folder/console" 2>&1 || true
cat "$folder/output" 2>/dev/null || cat "$folder/console"
exit "$(cat "$folder/status" 2>/dev/null || echo 70)"
