#!/usr/bin/env bash
# with_display.sh COMMAND...: runs a program with a virtual display of its own, settings and cache in a folder that is removed
# afterwards, and OpenGL in software. The server chooses the number of its display itself (-displayfd), so that tests beside each
# other never share one, as those of xvfb-run may. With KOBOSHI_WINDOW_MANAGER=1 there is a window manager (Openbox), which gives
# windows the keyboard as on a desktop.
set -euo pipefail
folder=$(mktemp -d)
export XDG_CONFIG_HOME=$folder/config XDG_CACHE_HOME=$folder/cache XDG_DATA_HOME=$folder/data XDG_STATE_HOME=$folder/state
export XDG_RUNTIME_DIR=$folder/runtime TMPDIR=$folder QT_QPA_PLATFORM=xcb LIBGL_ALWAYS_SOFTWARE=1 LC_ALL=C.UTF-8
mkdir -m 700 "$XDG_RUNTIME_DIR"
Xvfb -displayfd 3 -screen 0 1600x1200x24 -nolisten tcp 3>"$folder/display" >"$folder/server.log" 2>&1 &
server=$!
stop() {
  [[ -z ${manager:-} ]] || kill "$manager" 2>/dev/null || true
  kill "$server" 2>/dev/null || true
  wait "$server" 2>/dev/null || true
  rm -rf "$folder"
}
trap stop EXIT
for ((tries = 0; tries < 300; ++tries)); do
  [[ ! -s $folder/display ]] || break
  kill -0 "$server" 2>/dev/null || break
  sleep 0.1
done
if [[ ! -s $folder/display ]]; then
  echo "with_display.sh: no display from Xvfb:" >&2
  cat "$folder/server.log" >&2
  exit 1
fi
DISPLAY=:$(<"$folder/display")
export DISPLAY
if [[ -n ${KOBOSHI_WINDOW_MANAGER:-} ]]; then
  openbox --sm-disable --startup "touch $folder/managed" >"$folder/manager.log" 2>&1 &
  manager=$!
  for ((tries = 0; tries < 300; ++tries)); do
    [[ ! -e $folder/managed ]] || break
    sleep 0.1
  done
fi
"$@"
