#!/usr/bin/env bash
# An ssh server on this machine's loopback interface, with keys of its own: for tests of programs that start others by ssh.
#
#   tools/dev/loopback_ssh.sh start FOLDER     starts sshd in a new folder, on a free port
#   tools/dev/loopback_ssh.sh stop FOLDER      ends it
#
# `ssh -F FOLDER/ssh_config localhost` reaches it as the calling user, without a password. It needs openssh-server and openssh-client, and as
# root the folder /run/sshd, which it creates.
set -euo pipefail

fail() {
  printf 'loopback_ssh.sh: %s\n' "$*" >&2
  exit 2
}

[[ $# == 2 ]] || fail "found $# arguments, expected start or stop, and a folder"
PATH=$PATH:/usr/sbin
sshd=$(command -v sshd) || fail "found no sshd, expected it installed (apt install openssh-server)"
mkdir -p "$2"
folder=$(cd "$2" && pwd -P)

case $1 in
  start)
    [[ ! -e $folder/sshd_config ]] || fail "found a server in $folder, expected a new folder"
    ((EUID != 0)) || mkdir -p /run/sshd
    port=$((32000 + $$ % 12000))
    while (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((port + 1)); done
    ssh-keygen -q -t ed25519 -N '' -f "$folder/host_key"
    ssh-keygen -q -t ed25519 -N '' -f "$folder/user_key"
    cp "$folder/user_key.pub" "$folder/authorized_keys"
    # GNU parallel opens a connection for each job: without MaxStartups a server drops some of them.
    cat >"$folder/sshd_config" <<CONF
ListenAddress 127.0.0.1:$port
HostKey $folder/host_key
PidFile $folder/sshd.pid
AuthorizedKeysFile $folder/authorized_keys
StrictModes no
UsePAM no
PasswordAuthentication no
PermitRootLogin yes
MaxStartups 1000
CONF
    printf '[127.0.0.1]:%s %s\n' "$port" "$(cut -d' ' -f1,2 "$folder/host_key.pub")" >"$folder/known_hosts"
    cat >"$folder/ssh_config" <<CONF
Host localhost 127.0.0.1
  HostName 127.0.0.1
  Port $port
  User $(id -un)
  IdentityFile $folder/user_key
  IdentitiesOnly yes
  UserKnownHostsFile $folder/known_hosts
  HostKeyAlgorithms ssh-ed25519
CONF
    "$sshd" -f "$folder/sshd_config" -E "$folder/sshd.log"
    for ((i = 0; i < 100; ++i)); do
      ! ssh -F "$folder/ssh_config" -o BatchMode=yes localhost true 2>/dev/null || exit 0
      sleep 0.1
    done
    fail "found no answer of sshd, expected one; see $folder/sshd.log"
    ;;
  stop) [[ ! -s $folder/sshd.pid ]] || kill "$(cat "$folder/sshd.pid")" 2>/dev/null || true ;;
  *) fail "found the command $1, expected start or stop" ;;
esac
