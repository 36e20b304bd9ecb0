#!/usr/bin/env bash
# in_debian.sh [--fresh] bookworm|trixie COMMAND [ARGUMENT...]: runs a command in a clone of this repository on a minimal
# Debian, as the first command on a new machine, and exits with its status:
#
#   tools/dev/in_debian.sh trixie ./run test
#
# The clone contains the commit that is checked out here. It, the installed packages and all results are thrown away at
# the end; only the downloaded packages and the minimal system, which debootstrap makes once (again with --fresh), are
# kept, in ${XDG_CACHE_HOME:-~/.cache}/koboshi. The system comes from KOBOSHI_DEBIAN_MIRROR or else from the mirror of
# this machine's apt. The command runs as root with the host's network and display, and without the host's files.
set -euo pipefail

readonly environment='^(https?_proxy|HTTPS?_PROXY|no_proxy|NO_PROXY|TERM|DISPLAY|CI|KOBOSHI_[A-Z_]*)='

fail() {
  printf 'in_debian.sh: %s\n' "$*" >&2
  exit 2
}

mirror() {
  local apts=
  if command -v apt-get >/dev/null; then
    # shellcheck disable=SC2016 # apt-get expands it
    apts=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' | sort -u)
  fi
  printf '%s\n' "${KOBOSHI_DEBIAN_MIRROR:-${apts:-http://deb.debian.org/debian}}" | head -n 1
}

# bootstrap RELEASE FOLDER: makes the minimal system, as a whole or not at all.
bootstrap() {
  printf '== Making a minimal Debian %s in %s\n' "$1" "$2" >&2
  rm -rf "$2" "$2.part"
  # Its mounts end with the namespace.
  unshare --mount debootstrap --variant=minbase "$1" "$2.part" "$(mirror)" >"$2.log" 2>&1 ||
    { tail "$2.log" >&2; fail "debootstrap failed; its messages are in $2.log"; }
  mv "$2.part" "$2"
}

# configure_network ROOT: gives a system this machine's name servers, proxies, certificates and settings of apt's downloads.
configure_network() {
  local file
  mkdir -p "$1/etc/apt/apt.conf.d"
  for file in /etc/resolv.conf /etc/hosts /etc/ssl/certs/ca-certificates.crt /usr/local/share/ca-certificates; do
    [[ ! -e $file ]] || { mkdir -p "$1$(dirname "$file")" && cp -RL "$file" "$1$(dirname "$file")"; }
  done
  if command -v apt-config >/dev/null; then
    apt-config dump Acquire | grep -E '^Acquire::(https?::|Check-|Retries )' >"$1/etc/apt/apt.conf.d/90host" || true
  fi
}

# enter SYSTEM RUN REPOSITORY COMMAND [ARGUMENT...]: runs the command on top of a system, as process 1 of its own namespaces.
enter() {
  local system=$1 run=$2 repository=$3
  shift 3
  # No overlay can lie on top of another one, such as that of a container.
  [[ $(stat -fc %T "$run") != overlayfs ]] || mount -t tmpfs tmpfs "$run/layers"
  cd "$run/layers"
  mkdir -p upper/root work root
  chmod 700 upper/root
  configure_network upper
  git clone --quiet --no-hardlinks "$repository" upper/root/koboshi
  mount -t overlay overlay -o "volatile,lowerdir=$system,upperdir=$PWD/upper,workdir=$PWD/work" root
  cd root
  mount --rbind /dev dev
  mount --rbind /sys sys
  mount -t proc proc proc
  mount -t tmpfs tmpfs tmp
  mount --bind "$run/archives" var/cache/apt/archives
  if [[ -d /tmp/.X11-unix ]]; then
    mkdir tmp/.X11-unix
    mount --bind /tmp/.X11-unix tmp/.X11-unix
  fi
  pivot_root . mnt  # not chroot, in which programs may not make user namespaces
  umount -l /mnt
  cd /root/koboshi
  local kept
  mapfile -t kept < <(env | grep -E "$environment")
  # Processes in the background of a shell ignore the signals of the keyboard, unless they are reset.
  env -i --default-signal=INT,QUIT HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "${kept[@]}" "$@"
}

main() {
  local fresh=
  [[ ${1:-} != --fresh ]] || { fresh=yes; shift; }
  [[ $# -ge 2 && $1 =~ ^(bookworm|trixie)$ ]] ||
    fail "found '$*', expected: in_debian.sh [--fresh] bookworm|trixie COMMAND [ARGUMENT...]"
  local release=$1 program
  shift
  ((EUID == 0)) || fail "it mounts file systems, which needs root: sudo --preserve-env=DISPLAY $0 $release $*"
  for program in debootstrap flock git setpriv unshare; do
    command -v "$program" >/dev/null || fail "there is no $program here: on Debian, apt-get install debootstrap git util-linux"
  done
  unshare --mount --pid --fork true || fail "the kernel permits no namespaces of mounts and processes here"

  local repository cache=${XDG_CACHE_HOME:-$HOME/.cache}/koboshi/$release
  repository=$(git -C "$(dirname "${BASH_SOURCE[0]}")" rev-parse --show-toplevel)
  mkdir -p "$cache/archives" "$cache/runs"
  exec 8>"$cache/lock"
  flock 8  # one process at a time makes the system
  [[ -z $fresh && -d $cache/system ]] || bootstrap "$release" "$cache/system"
  local killed
  for killed in "$cache"/runs/*; do  # left over where in_debian.sh itself was killed
    [[ ! -d $killed ]] || flock -n "$killed" rm -rf "$killed" || true
  done
  run=$(mktemp -d "$cache/runs/XXXXXX")
  exec 9<"$run"
  flock 9  # until the last process inside has ended, because all of them inherit the descriptor
  exec 8>&-

  child=
  finish() {
    if [[ -n $child ]]; then
      kill -KILL "$child" || true
      wait "$child" 2>/dev/null || true
    fi
    exec 9<&-
    flock "$run" true
    find "$run/archives" -maxdepth 1 -name '*.deb' -exec ln -t "$cache/archives" {} + 2>/dev/null || true  # those that are new
    rm -rf "$run"
  }
  trap finish EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM HUP

  mkdir -p "$run"/{layers,archives/partial}
  find "$cache/archives" -name '*.deb' -exec ln -t "$run/archives" {} +
  export -f configure_network enter
  export environment
  setpriv --pdeathsig KILL unshare --mount --pid --fork --kill-child bash -euc 'enter "$@"' enter "$cache/system" "$run" "$repository" "$@" <&0 &
  child=$!
  local status=0
  wait "$child" || status=$?
  child=
  exit "$status"
}

main "$@"
