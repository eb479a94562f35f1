#!/usr/bin/env bash
# Installs the library from a build into a folder, moves that folder, and builds and runs a project against it that knows
# nothing else: run.sh BUILD static|shared SCRATCH
set -euo pipefail
build=$1 kind=$2 scratch=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
fail() {
  echo "consumer: $*" >&2
  exit 1
}

rm -rf "$scratch"
mkdir -p "$scratch"
for component in headers "$kind"; do
  cmake --install "$build" --prefix "$scratch/first" --component "rosefusion-$component" >"$scratch/install.log"
done
mv "$scratch/first" "$scratch/prefix"

sed -n '/^```cpp$/,/^```$/p' "$here/../../README.md" | sed '/^```/d' >"$scratch/quickstart.cpp"
lines=$(wc -l <"$scratch/quickstart.cpp")
[[ $lines -ge 10 && $lines -le 25 ]] || fail "the README's C++ quickstart has $lines lines instead of at most 25."

if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
neighbours=OFF  # in the shared library nothing can meet
[[ $kind == shared ]] || neighbours=ON
# The generator that the build has is there.
CMAKE_GENERATOR=$(sed -n 's/^CMAKE_GENERATOR:INTERNAL=//p' "$build/CMakeCache.txt")
export CMAKE_GENERATOR
cmake -S "$here" -B "$scratch/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$scratch/prefix" \
  -DQUICKSTART="$scratch/quickstart.cpp" -DNEIGHBOURS="$neighbours" >"$scratch/configure.log" || fail "$(cat "$scratch/configure.log")"
cmake --build "$scratch/build" >"$scratch/build.log" || fail "$(cat "$scratch/build.log")"
"$scratch/build/embedded" || fail "the Vulkan header's program ended with $?."
"$scratch/build/quickstart" | tee "$scratch/output.txt"
# 8 frames, 3 cm to the right each.
[[ $(grep -c 'camera at' "$scratch/output.txt") == 8 ]] || fail "not every frame was tracked."
awk '/camera at/ {x = $5; y = $6; z = $7}
     / triangles/ {triangles = $3}
     END {exit !(x > 0.20 && x < 0.22 && y * y < 1e-4 && z * z < 1e-4 && triangles > 5000)}' \
  "$scratch/output.txt" || fail "the poses or the mesh are wrong; see above."

if [[ $neighbours == ON ]]; then
  # What leaks is Mesa's software device's, which is unloaded before the sanitizer looks.
  ASAN_OPTIONS=detect_leaks=0 "$scratch/build/neighbours" || fail "beside other users of the same libraries it ended with $?."
  library=$(find "$scratch/prefix" -name librosefusion.a)
  exported=$(nm -C --defined-only --extern-only "$library" | sed -n 's/^[0-9a-f]* [A-Za-z] //p')
else
  library=$(find "$scratch/prefix" -name librosefusion.so)
  exported=$(nm -DC --defined-only "$library" | cut -d' ' -f3-)
fi
names='(Reconstructor|View|Fusion|Error)::|vulkanRequirements\(|missingFor\[|volumeBuffers\('
stray=$(grep -vE "^rosefusion::($names)|^(typeinfo|typeinfo name|vtable) for rosefusion::Error$" <<<"$exported" || true)
stray+=$(grep '::Impl' <<<"$exported" || true)
[[ -n $exported && -z $stray ]] || fail "exported, but not meant to be: $stray"
