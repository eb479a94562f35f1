#!/usr/bin/env bash
# Whether programs that were linked with the last release still run with this library: abi.sh BUILD [--renew]. Compares what
# BUILD's shared library exports, and how the public types are laid out, with what tests/fixtures/abi holds of that release.
# --renew writes it anew: with a release, or with a version number that promises nothing (host/public/VERSIONING.md).
set -euo pipefail
build=$1 renew=${2:-}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
stored=$root/tests/fixtures/abi
fail() {
  echo "abi: $*" >&2
  exit 1
}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
library=$(find -L "$build" -maxdepth 2 -name 'librosefusion.so' | head -n 1)
[[ -n $library ]] || fail "there is no librosefusion.so in $build; build the target rosefusion_library_shared."

nm -D --defined-only "$library" | awk '{print $3}' | LC_ALL=C sort >"$scratch/exported.txt"
# One function that takes each public type, so that the compiler describes them all.
types=$(grep -hoE '^(struct|class) (ROSEFUSION_API )?[A-Z][A-Za-z]+' "$root"/host/public/rosefusion/*.h | awk '{print $NF "&,"}' | sort -u)
[[ $(wc -l <<<"$types") -ge 15 ]] || fail "the public types were not found in host/public/rosefusion."
printf '#include <rosefusion/vulkan.h>\nnamespace rosefusion { ROSEFUSION_API void layouts(%s int) {} }\n' "$types" >"$scratch/layouts.cpp"
g++ -std=c++20 -g -O0 -fPIC -shared -fvisibility=hidden -I"$root/host/public" -I"$build/include" "$scratch/layouts.cpp" -o "$scratch/layouts.so"

# Other compilers and processors describe the standard library's types otherwise.
kind=gcc$(g++ -dumpversion | cut -d. -f1)-$(uname -m)
if [[ $renew == --renew ]]; then
  mkdir -p "$stored"
  cp "$scratch/exported.txt" "$stored/exported-$(uname -m).txt"
  abidw --headers-dir "$root/host/public" --drop-private-types --no-show-locs --no-corpus-path --no-comp-dir-path "$scratch/layouts.so" |
    xz -9 >"$stored/layouts-$kind.abi.xz"
  echo "abi: written to $stored"
  exit 0
fi

[[ -e $stored/exported-$(uname -m).txt ]] || { echo "abi: skipped, nothing is stored for $(uname -m)"; exit 0; }
gone=$(LC_ALL=C comm -23 "$stored/exported-$(uname -m).txt" "$scratch/exported.txt")
[[ -z $gone ]] || fail "no longer exported (see host/public/VERSIONING.md): $(c++filt <<<"$gone")"
if ! command -v abidiff >/dev/null; then
  echo "abi: all that was exported still is; layouts not compared, because abidiff is missing (package abigail-tools)"
elif [[ ! -e $stored/layouts-$kind.abi.xz ]]; then
  echo "abi: all that was exported still is; layouts not compared, because none are stored for $kind"
else
  xz -dc "$stored/layouts-$kind.abi.xz" >"$scratch/stored.abi"
  status=0
  report=$(abidiff "$scratch/stored.abi" "$scratch/layouts.so" 2>&1) || status=$?
  [[ $status == 0 ]] || fail "public types are laid out otherwise (see host/public/VERSIONING.md): $report"
  echo "abi: exported functions and layouts are those of the last release"
fi
