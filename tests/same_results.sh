#!/usr/bin/env bash
# Whether the working tree gives the same results as COMMIT, byte for byte, on this machine's device: trajectories of
# recordings ($ROSEFUSION_DATA, else shared/data beside the checkout) and of generated flights, in presets default and
# paper. For changes that must not change any: tests/same_results.sh COMMIT [PROGRAM_OF_COMMIT]
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
fail() {
  echo "same_results: $*" >&2
  exit 2
}
[[ $# -ge 1 && $# -le 2 ]] || fail "give the commit to compare with, and the program that was built from it, if there is one."
commit=$(git -C "$root" rev-parse --verify --quiet "$1^{commit}") || fail "there is no commit '$1'."
data=${ROSEFUSION_DATA:-$root/../shared/data}
scratch=$root/build/same_results
mkdir -p "$scratch"

build() {  # FOLDER: prints where its program is
  cmake --preset release -S "$1" -B "$1/build/same_results" -DROSEFUSION_TESTS=OFF >"$scratch/configure.log" 2>&1 &&
    cmake --build "$1/build/same_results" --target rosefusion --parallel "$(nproc)" >"$scratch/build.log" 2>&1 ||
    fail "$1 could not be built; see $scratch/configure.log and build.log."
}
build "$root"
new=$root/build/same_results/apps/cli/rosefusion
if [[ $# == 2 ]]; then
  old=$2
else
  [[ -e $scratch/tree ]] || git -C "$root" worktree add --detach "$scratch/tree" "$commit" >/dev/null 2>&1 ||
    fail "$scratch/tree could not be made."
  git -C "$scratch/tree" checkout --quiet --detach "$commit"
  build "$scratch/tree"
  old=$scratch/tree/build/same_results/apps/cli/rosefusion
fi

different=0
verdict() {  # WHAT A B
  if cmp --silent "$2" "$3"; then
    echo "same       $1"
  else
    echo "DIFFERENT  $1"
    different=1
  fi
}
compare() {  # NAME SEQUENCE OPTIONS...: the trajectories
  local name=$1 sequence=$2
  shift 2
  [[ -d $sequence ]] || { echo "not tried  $name: there is no $sequence"; return; }
  for side in old new; do
    # A run that loses most frames may end with a code of its own; what it wrote is compared all the same.
    "${!side}" run "$sequence" --out "$scratch/$side" "$@" >"$scratch/$side.log" 2>&1 || true
    cp "$scratch/$side/trajectory.txt" "$scratch/$side.txt" 2>/dev/null || fail "$name: no trajectory; see $scratch/$side.log."
  done
  verdict "$name" "$scratch/old.txt" "$scratch/new.txt"
}
disturbed() {  # NAME OPTIONS...: a flight of the tracking suite, whose figures are compared but for times
  local name=$1
  shift
  for side in old new; do
    "${!side}" bench --suite tracking --rooms 1 "$@" --json "$scratch/$side.json" >"$scratch/$side.log" 2>&1 || true
    grep -vE 'milliseconds|ms_per|median|p95|seconds|commit|version' "$scratch/$side.json" >"$scratch/$side.txt" ||
      fail "$name: no figures; see $scratch/$side.log."
  done
  verdict "$name" "$scratch/old.txt" "$scratch/new.txt"
}

for preset in default paper; do
  compare "realsense_table, $preset" "$data/realsense_table" --config $preset
  compare "seven_scenes every 4th, $preset" "$data/seven_scenes" --config $preset --stride 4
  compare "tum_fr1_rpy every 3rd, $preset" "$data/tum_fr1_rpy" --config $preset --stride 3
  [[ -d $scratch/room1 ]] || "$old" synth "$scratch/room1" --frames 60 --seed 1 >/dev/null
  compare "room 1, 60 frames, $preset" "$scratch/room1" --config $preset
done
disturbed "room 911 with black frames" --seed 911 --frames 120 --disturb black
disturbed "room 1114, kidnapped" --seed 1114 --frames 120 --disturb cut
if [[ -f $data/meshes/small_house.ply ]]; then
  [[ -d $scratch/walk ]] || "$old" synth "$scratch/walk" --mesh "$data/meshes/small_house.ply" --seed 71 --frames 500 \
    --loops 1 --width 320 --height 240 --fx 160 --fy 160 >/dev/null
  compare "a walk that closes a loop" "$scratch/walk" --set loops.enabled=true
fi
[[ $different == 0 ]] && echo "All results are the same."
exit $different
