#!/usr/bin/env bash
# check_packages.sh FOLDER: checks the Debian packages in a folder on a system that is thrown away, as in_debian.sh makes one.
# They satisfy lintian, contain no path of this clone, install with apt, work for an ordinary user from an empty folder, and leave
# nothing outside of home folders when they are purged. Exits with 1 at the first fault.
set -euo pipefail
export LC_ALL=C.UTF-8

readonly folder=${1:?a folder with .deb files} user=koboshi-check
readonly packages=(koboshi koboshi-studio libkoboshi-dev python3-koboshi)
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
readonly source
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

say() { printf '== %s\n' "$*"; }
fail() {
  printf 'check_packages.sh: %s\n' "$*" >&2
  exit 1
}

# as_user COMMAND: runs a command of the shell as an ordinary user in a new folder, and prints its output if it fails.
as_user() {
  local here
  here=$(runuser -u "$user" -- mktemp -d "/home/$user/XXXXXX")
  runuser -u "$user" -- env -i HOME="/home/$user" PATH=/usr/local/bin:/usr/bin:/bin LC_ALL=C.UTF-8 \
    bash -euc "cd '$here'; $1" >"$scratch/log" 2>&1 || { cat "$scratch/log" >&2; fail "this failed: $1"; }
}

# Everything that is not of apt, dpkg, logs, or home folders.
system_files() {
  find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /run -o -path /home -o -path /root \
    -o -path /var/lib/dpkg -o -path /var/lib/apt -o -path /var/cache -o -path /var/log \) -prune -o -print | sort
}

check_contents() {
  say "Checking with lintian"
  lintian --allow-root --fail-on error "$folder"/*.deb || fail "lintian finds errors"
  local deb
  for deb in "$folder"/*.deb; do dpkg-deb -x "$deb" "$scratch/root"; done
  desktop-file-validate "$scratch"/root/usr/share/applications/*.desktop
  local leaking
  leaking=$(grep -rlF "$source" "$scratch/root" || true)
  [[ -z $leaking ]] || fail "the path of the sources is in $leaking"
}

install_packages() {
  say "Installing with apt"
  useradd --create-home "$user"
  system_files >"$scratch/before"
  DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 install -y --no-install-recommends "$(realpath "$folder")"/*.deb >"$scratch/log" 2>&1 ||
    { cat "$scratch/log" >&2; fail "apt does not install the packages"; }
}

check_programs() {
  say "Running as an ordinary user"
  as_user 'koboshi run walk; test -s runs/walk/summary.json; test -s runs/walk/run.mcap; koboshi replay runs/walk --html'
  as_user 'koboshi model check koboshi; koboshi motion check squat'
  as_user 'test "$(koboshi manual names scenario | grep -cx walk)" = 1'
  as_user 'mkdir scenarios; cp /usr/share/koboshi/scenarios/go.yaml scenarios/own.yaml; koboshi run own --duration 0.1'
  as_user 'status=0; koboshi run wakl 2>message || status=$?; [[ $status == 2 ]]; grep -q "the nearest is walk" message'
  as_user 'python3 -c "import koboshi; sim = koboshi.Simulation(\"go\"); sim.step(10)"'
  as_user 'koboshi studio --version; QT_QPA_PLATFORM=offscreen timeout 60 koboshi-studio --help'
  as_user 'zcat /usr/share/man/man1/koboshi-run.1.gz | grep -q duration; bash -n /usr/share/bash-completion/completions/koboshi'
}

check_libraries() {
  say "Building another project with libkoboshi-dev"
  cp -r "$source/tests/proof/outside" "$scratch/outside"
  chmod -R a+rX "$scratch"
  as_user "cmake -S $scratch/outside -B build -G Ninja -DCMAKE_BUILD_TYPE=Release
    cmake --build build
    build/own_board
    build/own_behaviour /usr/share/koboshi/scenarios/go.yaml"
}

purge_packages() {
  say "Purging"
  DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 purge --autoremove -y "${packages[@]}" >"$scratch/log" 2>&1 ||
    { cat "$scratch/log" >&2; fail "apt does not purge the packages"; }
  local left
  left=$(comm -13 "$scratch/before" <(system_files))
  [[ -z $left ]] || fail "these are left after the purge: $left"
  left=$({ dpkg-query -W -f='${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null || true; } |
    sed '/^not-installed/d')
  [[ -z $left ]] || fail "dpkg still knows: $left"
}

check_contents
install_packages
check_programs
check_libraries
purge_packages
say "All checks of the packages passed"
