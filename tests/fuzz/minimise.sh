#!/usr/bin/env bash
# minimise.sh [NAME...]: makes the corpora of these fuzzers anew (default: of all) from the present ones and from what their
# tests found in build/fuzz/corpus: few and small inputs that together reach all the code that these reach. Run it after a
# longer fuzzing, such as
#
#   cmake --preset fuzz -DKOBOSHI_FUZZ_SECONDS=600 && cmake --build --preset fuzz && ctest --preset fuzz -L fuzz
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# Longer inputs cost every run time.
readonly max_bytes=4000

names=("$@")
((${#names[@]} > 0)) || mapfile -t names < <(ls tests/fuzz/corpus)
for name in "${names[@]}"; do
  corpus=tests/fuzz/corpus/$name
  mkdir -p "$corpus.new"
  build/fuzz/bin/fuzz_"$name" -set_cover_merge=1 -use_counters=0 -max_len=$max_bytes "$corpus.new" "$corpus" "build/fuzz/corpus/$name" >build/fuzz/merge.log 2>&1 ||
    { tail build/fuzz/merge.log >&2; exit 1; }
  rm -rf "$corpus"
  mv "$corpus.new" "$corpus"
  printf '%-16s %5d inputs, %5d kB\n' "$name" "$(find "$corpus" -type f | wc -l)" "$(du -sk --apparent-size "$corpus" | cut -f1)"
done
