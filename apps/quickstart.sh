#!/usr/bin/env bash
# From a fresh Debian or Ubuntu to a reconstruction: installs what is missing, builds, makes a sequence of fast camera
# motion with known truth, reconstructs it, and compares the result with the truth. A second run reuses packages,
# build and sequence. Everything lands in build/quickstart and out/quickstart.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=$root/out/quickstart
program=$root/build/quickstart/apps/cli/rosefusion
frames=240

step() { printf '\n== %s\n' "$*"; }
fail() {
  echo "quickstart: $*" >&2
  exit 1
}
jobs() {  # one per core, but no more than memory allows: a compiler takes up to 1 GB
  local cores gigabytes
  cores=$(nproc)
  gigabytes=$(awk '/^MemAvailable/ {print int($2 / 1e6)}' /proc/meminfo 2>/dev/null || echo "$cores")
  echo $((gigabytes < 1 ? 1 : gigabytes < cores ? gigabytes : cores))
}

[[ $# -eq 0 ]] || fail "takes no arguments; to reconstruct your own sequence see the README."
cd "$root"

step "1/5 Packages"
bash apps/install_packages.sh || fail "the packages are not complete (see above)."

step "2/5 Build (Release, without tests)"
mkdir -p build/quickstart "$out" || fail "$root cannot be written to; copy the project to where you may write."
cmake --preset quickstart >build/quickstart/configure.log 2>&1 || {
  cat build/quickstart/configure.log >&2
  fail "the build could not be configured; the lines above name what is missing."
}
cmake --build build/quickstart --target rosefusion --parallel "$(jobs)" || fail "the build failed; see above."

step "3/5 Sequence: a furnished room, a camera at 1 to 4 m/s, noisy depth"
sequence=$out/sequence
# synth.json is there only when the sequence is complete; another number of frames means another quickstart.
if grep -qs "\"frames\": $frames,"  "$sequence/synth.json"; then
  echo "Reusing $sequence"
else
  [[ ! -e $sequence ]] || force=--force
  "$program" synth "$sequence" --frames "$frames" ${force:-} || fail "the sequence could not be made."
fi

step "4/5 Reconstruction"
result=$out/result
"$program" run "$sequence" --out "$result" || fail "the reconstruction failed; see above."

step "5/5 Comparison with the truth"
"$program" eval "$result" "$sequence" --json "$result/eval.json" --plot "$result/errors.png" ||
  fail "the trajectory could not be compared with the truth."
echo
"$program" eval-mesh "$result/mesh.ply" "$sequence/mesh_seen.ply" \
  --estimate-trajectory "$result/trajectory.txt" --truth-trajectory "$sequence/groundtruth.txt" \
  --json "$result/eval_mesh.json" || fail "the mesh could not be compared with the truth."

step "Done in $((SECONDS / 60)) min $((SECONDS % 60)) s. Look at:"
cat <<END
  $result/preview.png     picture of the reconstruction
  $result/view.html       the model and the path, in a browser
  $result/mesh.ply        the mesh (MeshLab, CloudCompare, Blender)
  $result/trajectory.txt  camera poses, TUM format
  $result/report.json     what happened: counts, times, memory, errors
  $result/errors.png      trajectory and errors against the truth
Your own data:  $program run FOLDER --out $root/out/NAME
END
