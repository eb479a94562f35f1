#!/usr/bin/env bash
# clang-tidy over engine, host and apps, by the checks of .clang-tidy: all sources of a target at once, since most of the time
# goes to the libraries' headers. Needs clang-tidy-14 and the build's packages;
# compiles nothing but two small shaders.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
if ! command -v clang-tidy-14 >/dev/null; then
  echo "tidy.sh: clang-tidy-14 is not installed." >&2
  exit 2
fi
mkdir -p build/tidy
cmake --preset tidy >build/tidy/configure.log 2>&1 || {
  cat build/tidy/configure.log >&2
  exit 1
}
sed -i 's/ -fno-gnu-unique / /' build/tidy/compile_commands.json  # which Clang does not know
cmake --build build/tidy --target apps/renderer/scene.vert.inc apps/renderer/scene.frag.inc >build/tidy/build.log 2>&1 || {
  cat build/tidy/build.log >&2
  exit 1
}
# The largest first, so that none is left alone at the end; what the build generates is not looked at.
targets() {
  sed -n 's/.*"file": "\(.*\)".*/\1/p' build/tidy/compile_commands.json | grep -E "^$root/(build/tidy/)?(engine|host|apps)/" |
    while IFS= read -r file; do echo "$(grep -c '#include' "$file") $file"; done | sort -rn | cut -d' ' -f2-
}
targets | xargs -P "$(nproc)" -n 1 clang-tidy-14 -p build/tidy --quiet --header-filter="^$root/(engine|host|apps|shaders)/" \
  --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-error 2>build/tidy/suppressed.log ||
  {
    echo "tidy.sh: the lines above break the checks of .clang-tidy." >&2
    exit 1
  }
