#!/usr/bin/env bash
# Random bytes for every parser, under the sanitizers: fuzz.sh [SECONDS | --runs N] [PARSER...], 10 seconds each by default,
# or as many executions. Needs Clang 14.
# Starts from tests/fuzz/corpus; what it found new lies in build/fuzz/found, and an input that broke something beside it.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
limit=-max_total_time=${1:-10}
if [[ ${1:-} == --runs ]]; then
  limit=-runs=${2:?"fuzz: --runs needs a number"}
  shift
fi
shift || true
parsers=("$@")
if [[ ${#parsers[@]} -eq 0 ]]; then
  parsers=(settings assignment trajectory calibration list sequence_yaml png seq bag db3 mcap mkv ply templates wire codec keys)
fi
command -v clang++-14 >/dev/null || { echo "fuzz: clang++-14 is missing; install the package clang-14." >&2; exit 1; }
mkdir -p build/fuzz/found
cmake --preset fuzz >build/fuzz/configure.log 2>&1 || { cat build/fuzz/configure.log >&2; exit 1; }
cmake --build --preset fuzz --parallel "$(nproc)" >build/fuzz/build.log 2>&1 || { tail -n 30 build/fuzz/build.log >&2; exit 1; }

export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=0
export LSAN_OPTIONS=suppressions=$PWD/tests/leak_sanitizer.txt:print_suppressions=0
failed=0
for parser in "${parsers[@]}"; do
  mkdir -p "build/fuzz/found/$parser" "tests/fuzz/corpus/$parser"
  case "$parser" in bag | db3 | mcap | mkv) cp -n "tests/fixtures/recordings/small.$parser" "build/fuzz/found/$parser/" ;; esac
  log=build/fuzz/$parser.log
  # 2 GB in all and 256 MB at once: no parser may believe a size that the bytes do not hold.
  if ROSEFUSION_FUZZ=$parser build/fuzz/tests/fuzz/fuzz_parsers "$limit" -max_len=16384 -timeout=20 \
    -rss_limit_mb=2048 -malloc_limit_mb=256 -artifact_prefix="build/fuzz/$parser-" -close_fd_mask=1 -print_final_stats=1 \
    "build/fuzz/found/$parser" "tests/fuzz/corpus/$parser" >"$log" 2>&1; then
    echo "fuzz: $parser, $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") executions," \
      "$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log") a second"
  else
    tail -n 40 "$log" >&2
    echo "fuzz: $parser broke; the input is build/fuzz/$parser-*, the whole log $log" >&2
    failed=1
  fi
done
exit "$failed"
