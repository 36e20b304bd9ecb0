#!/usr/bin/env bash
# with_display.sh COMMAND...: runs a program with a virtual display of its own, settings and cache in a folder that is removed
# afterwards, and OpenGL in software.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export XDG_CONFIG_HOME=$folder/config XDG_CACHE_HOME=$folder/cache XDG_DATA_HOME=$folder/data XDG_STATE_HOME=$folder/state
export XDG_RUNTIME_DIR=$folder/runtime TMPDIR=$folder QT_QPA_PLATFORM=xcb LIBGL_ALWAYS_SOFTWARE=1 LC_ALL=C.UTF-8
mkdir -m 700 "$XDG_RUNTIME_DIR"
xvfb-run --auto-servernum --server-args="-screen 0 1600x1200x24 -nolisten tcp" "$@"
