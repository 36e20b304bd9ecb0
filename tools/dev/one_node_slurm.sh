#!/usr/bin/env bash
# Slurm on this machine alone, without systemd, cgroups or a database: for tests of job arrays, and to try them out.
#
#   tools/dev/one_node_slurm.sh start FOLDER [CPUS]     starts munged, slurmctld and slurmd in a new folder
#   tools/dev/one_node_slurm.sh stop-node FOLDER        kills slurmd with the tasks that it runs, as a power failure does
#   tools/dev/one_node_slurm.sh start-node FOLDER       starts slurmd again; the tasks are queued again
#   tools/dev/one_node_slurm.sh stop FOLDER             ends all of them
#
# Clients find it by `export SLURM_CONF=FOLDER/slurm.conf`. It needs root, because slurmd starts tasks as their users, and the packages
# slurm-wlm and munge. It touches nothing outside of the folder: any number of them run beside each other and beside a real Slurm.
set -euo pipefail

fail() {
  printf 'one_node_slurm.sh: %s\n' "$*" >&2
  exit 2
}

[[ $# -ge 2 ]] || fail "found $# arguments, expected start, stop-node, start-node or stop, and a folder"
command=$1
cpus=${3:-$(nproc)}
((EUID == 0)) || fail "found the user $(id -un), expected root: slurmd starts tasks as their users"
for program in munged slurmctld slurmd; do
  # They are in /usr/sbin, which the path of a user may lack.
  PATH=$PATH:/usr/sbin:/sbin command -v "$program" >/dev/null || fail "found no $program, expected it installed (apt install slurm-wlm munge)"
done
PATH=$PATH:/usr/sbin:/sbin
mkdir -p "$2"
folder=$(cd "$2" && pwd -P)
export SLURM_CONF=$folder/slurm.conf

# await SECONDS WHAT COMMAND...: repeats the command until it succeeds.
await() {
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@" >/dev/null 2>&1; do
    ((SECONDS < deadline)) || fail "found no $what after a while, expected it; the logs are in $folder"
    sleep 0.1
  done
}

# Prints a TCP port that nothing listens on, from 20000, by the process id so that several starts do not meet.
free_port() {
  local port=$((20000 + ($$ * 7 + $1 * 1009) % 12000))
  while (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((port + 1)); done
  printf '%s\n' "$port"
}

write_configuration() {
  local host
  host=$(hostname -s)
  # The node's CPUs are what the caller says: two shards share a core in a test, which is none of the scheduler's business.
  cat >"$SLURM_CONF" <<CONF
ClusterName=koboshi
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port 1)
SlurmdPort=$(free_port 2)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
SlurmUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
MpiDefault=none
ReturnToService=2
SlurmdTimeout=10
KillWait=2
MinJobAge=600
MaxArraySize=100001
MaxJobCount=200000
SchedulerParameters=sched_interval=1,batch_sched_delay=0,requeue_delay=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
  # Before 23.11 Slurm has no such plugin, and asks for no cgroup with the plugins above.
  if [[ $(slurmctld -V) =~ \ (2[3-9]|[3-9][0-9])\. ]]; then echo CgroupPlugin=disabled >"$folder/cgroup.conf"; fi
}

start_munge() {
  (umask 077 && head -c 1024 /dev/urandom >"$folder/munge.key")
  # --force: the folder may be in one that others write to, as temporary folders are.
  munged --force --key-file "$folder/munge.key" --socket "$folder/munge.socket" --pid-file "$folder/munged.pid" \
    --log-file "$folder/munged.log" --seed-file "$folder/munged.seed" 2>>"$folder/munged.err"
  await 10 munged munge --socket "$folder/munge.socket" --no-input
}

is_idle_or_busy() { sinfo --noheader --format=%T | grep -qE '^(idle|mixed|allocated|completing)$'; }

# Tells the controller what it would find out by itself after a while.
set_node() { scontrol update NodeName="$(hostname -s)" State="$1" Reason="one_node_slurm.sh"; }

start_node() {
  slurmd
  await 30 "node of Slurm" is_idle_or_busy
}

# Ends the process whose id the file holds.
end() {
  local file=$folder/$1.pid signal=$2 process
  [[ -s $file ]] || return 0
  process=$(cat "$file")
  kill -s "$signal" "$process" 2>/dev/null || return 0
  for ((i = 0; i < 100; ++i)); do
    kill -0 "$process" 2>/dev/null || return 0
    sleep 0.1
  done
  kill -s KILL "$process" 2>/dev/null || true
}

# The processes of tasks: each has a slurmstepd, whose children they are. Only those of this folder are meant.
end_tasks() {
  local step child
  for step in $(pgrep -x slurmstepd || true); do
    tr '\0' '\n' <"/proc/$step/environ" 2>/dev/null | grep -qxF "SLURM_CONF=$SLURM_CONF" || continue
    for child in $(pgrep -P "$step" || true); do kill -s KILL -- "-$child" "$child" 2>/dev/null || true; done
    kill -s KILL "$step" 2>/dev/null || true
  done
}

case $command in
  start)
    [[ ! -e $SLURM_CONF ]] || fail "found a Slurm in $folder, expected a new folder"
    chmod 755 "$folder"
    mkdir -p "$folder/state" "$folder/spool"
    write_configuration
    start_munge
    slurmctld
    await 30 slurmctld scontrol ping
    start_node
    ;;
  stop-node)
    end slurmd KILL
    end_tasks
    set_node DOWN
    ;;
  start-node)
    start_node
    ;;
  stop)
    scancel --full --user=root 2>/dev/null || true
    end slurmctld TERM
    end slurmd TERM
    end_tasks
    end munged TERM
    ;;
  *) fail "found the command $command, expected start, stop-node, start-node or stop" ;;
esac
