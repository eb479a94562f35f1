#!/usr/bin/env bash
# All tests: builds, and runs everything in Release on Mesa's software device (or on
# $ROSEFUSION_DEVICE) with validation; then the tests of engine and pipeline again with narrower subgroups; then all
# but the long ones under the address and undefined-behaviour sanitizers. Ends with 'All tests passed.' or fails.
# --install first installs the Debian or Ubuntu packages that are missing, as it does in CI (CI is set in the environment);
# --no-sanitizers leaves out the last part.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
sanitizers=1
install=0
[[ -z ${CI:-} ]] || install=1
for option in "$@"; do
  case "$option" in
    --install) install=1 ;;
    --no-sanitizers) sanitizers=0 ;;
    *)
      echo "run.sh: there is no option '$option'; known are --install and --no-sanitizers." >&2
      exit 2
      ;;
  esac
done
cd "$root"

step() { printf '\n== %s (%d min %02d s so far)\n' "$*" $((SECONDS / 60)) $((SECONDS % 60)); }
fail() {
  echo "run.sh: $*" >&2
  exit 1
}
jobs() {  # one per core, but no more than memory allows: a compiler takes up to 1 GB, 1.5 GB under the sanitizers
  local cores fit
  cores=$(nproc)
  fit=$(awk '/^MemAvailable/ {print int($2 / 1.5e6)}' /proc/meminfo 2>/dev/null || echo "$cores")
  echo $((fit < 1 ? 1 : fit < cores ? fit : cores))
}
build() {  # PRESET [ARGUMENTS...]
  mkdir -p "build/$1"
  cmake --preset "$1" >"build/$1/configure.log" 2>&1 || {
    cat "build/$1/configure.log" >&2
    fail "the build '$1' could not be configured; the lines above name what is missing; on Debian and Ubuntu, --install installs it."
  }
  cmake --build "build/$1" --parallel "$(jobs)" "${@:2}" || fail "the build '$1' failed; see above."
}
# Each executable once, not each case: they would start for longer than they run. A run that finds no test must not pass.
# run BITS BUILD ARGUMENTS...: with vectors of so many bits. Mesa's cache of compiled shaders does not tell widths apart
# (22.3): a shader of another width comes out of it, and writes beyond its arrays. So each width has a cache of its own.
run() {
  LP_NATIVE_VECTOR_WIDTH=$1 MESA_SHADER_CACHE_DIR="$root/build/shader_cache_$1" \
    ctest --test-dir "build/$2" --build-config Whole --output-on-failure --no-tests=error --parallel 2 "${@:3}"
  local log="build/$2/Testing/Temporary/LastTest.log"
  echo "$(grep -c '^\[       OK \] .*ms)$' "$log") cases passed; $(grep -c '^\[  SKIPPED \] .*ms)$' "$log") skipped"
}

# The precompiled headers need these two allowances to be cached.
export CCACHE_SLOPPINESS=pch_defines,time_macros
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$root} CCACHE_NOHASHDIR=1
export UBSAN_OPTIONS=print_stacktrace=1
# The 256 MB that it keeps by default, in case they are used after being freed, cost a third of the time in new pages.
export ASAN_OPTIONS=${ASAN_OPTIONS:-quarantine_size_mb=16}

if [[ $install == 1 ]]; then
  step "Packages"
  bash apps/install_packages.sh --tests
fi

step "Release: build"
build ci
step "Release: all tests, subgroups of 8"
run 256 ci --label-regex whole

# The variable is Mesa's software device's; no other device heeds it.
if [[ -z "${ROSEFUSION_DEVICE:-}" ]]; then
  step "Release: tests of engine and pipeline, subgroups of 4"
  run 128 ci --label-regex 'whole.*subgroups'
fi

if [[ $sanitizers == 1 ]]; then
  step "Sanitizers: build"
  build asan --target short_tests
  step "Sanitizers: all tests but the long ones"
  run 256 asan --label-regex whole --label-exclude long
fi

step "All tests passed"
