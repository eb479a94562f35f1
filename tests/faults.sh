#!/usr/bin/env bash
# Nothing breaks the program: faults.sh [SECONDS [KILLS]], 300 seconds for each kind of fault and 100 kills by default.
# Single Vulkan commands and file functions fail in run, synth, eval, export, the viewer and the library, and run, synth,
# the viewer and both ends of a stream are killed: tests/faults/faults.sh and kills.sh, where a seed repeats what was found.
# What takes minutes of its own is not called from here: hostile.sh and long.sh there.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
seconds=${1:-300}
kills=${2:-100}
seed=${SEED:-$RANDOM}
cmake --preset ci >/dev/null && cmake --build build/ci --parallel "$(nproc)" --target faults test_library_faults
echo "faults: seed $seed"
failed=0
build/ci/tests/faults/test_library_faults --gtest_brief=1 || failed=1
for kind in device files; do
  bash tests/faults/faults.sh build/ci "$kind" "$seconds" "$seed" || failed=1
done
bash tests/faults/kills.sh build/ci "$kills" "$seed" || failed=1
exit $failed
