#!/usr/bin/env bash
# Whether the working tree gives the same results as COMMIT, byte for byte, on this machine's device: trajectory, mesh
# and what is said of each frame, of recordings ($ROSEFUSION_DATA, else shared/data beside the checkout) and of
# generated flights, in presets default and paper. For changes that must not change any:
#   tests/same_results.sh [--quick] [--program PROGRAM] COMMIT [PROGRAM_OF_COMMIT]
# --quick: fewer frames of less. --program: built from the working tree already. What COMMIT gave is kept and used again.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
fail() {
  echo "same_results: $*" >&2
  exit 2
}
quick="" new=""
while [[ ${1:-} == --* ]]; do
  case $1 in
    --quick) quick=1 ;;
    --program) new=${2:-} && shift ;;
    *) fail "there is no option $1." ;;
  esac
  shift
done
[[ $# -ge 1 && $# -le 2 ]] || fail "give the commit to compare with, and the program that was built from it, if there is one."
commit=$(git -C "$root" rev-parse --verify --quiet "$1^{commit}") || fail "there is no commit '$1'."
data=${ROSEFUSION_DATA:-$root/../shared/data}
scratch=$root/build/same_results
kept=$scratch/$commit
mkdir -p "$kept" "$scratch/new"

build() {  # FOLDER: prints where its program is
  cmake --preset release -S "$1" -B "$1/build/same_results" -DROSEFUSION_TESTS=OFF >"$scratch/configure.log" 2>&1 &&
    cmake --build "$1/build/same_results" --target rosefusion --parallel "$(nproc)" >"$scratch/build.log" 2>&1 ||
    fail "$1 could not be built; see $scratch/configure.log and build.log."
  echo "$1/build/same_results/apps/cli/rosefusion"
}
[[ $new ]] || new=$(build "$root")
if [[ $# == 2 ]]; then
  old=$2
else
  [[ -e $scratch/tree ]] || git -C "$root" worktree add --detach "$scratch/tree" "$commit" >/dev/null 2>&1 ||
    fail "$scratch/tree could not be made."
  git -C "$scratch/tree" checkout --quiet --detach "$commit"
  old=$(build "$scratch/tree")
fi
for program in "$old" "$new"; do [[ -x $program ]] || fail "there is no program $program."; done

different=0
# verdict NAME KEY: whether the new folder's files are those kept of the old one.
verdict() {
  local changed=""
  for file in trajectory.txt mesh.ply frames.csv figures.txt; do
    [[ ! -e $kept/$2/$file && ! -e $scratch/new/$2/$file ]] || cmp --silent "$kept/$2/$file" "$scratch/new/$2/$file" ||
      changed+=" $file"
  done
  if [[ $changed ]]; then
    echo "DIFFERENT  $1:$changed"
    different=1
  else
    echo "same       $1"
  fi
}
# Both sides' folders for a key; the old one only where it is not kept. A run that loses most frames may end with a
# code of its own; what it wrote is compared all the same.
sides() {
  echo "new $scratch/new/$1 $new"
  [[ -e $kept/$1/done ]] || echo "old $kept/$1 $old"
}
compare() {  # NAME SEQUENCE OPTIONS...
  local name=$1 sequence=$2 key side folder program
  key=$(tr -c 'a-zA-Z0-9\n' _ <<<"$name")
  shift 2
  [[ -d $sequence ]] || { echo "not tried  $name: there is no $sequence"; return; }
  while read -r side folder program; do
    rm -rf "$folder"
    "$program" run "$sequence" --out "$folder" "$@" >"$scratch/$side.log" 2>&1 || true
    [[ -e $folder/trajectory.txt && -e $folder/frames.csv ]] || fail "$name: no result; see $scratch/$side.log."
    # Reasons, in quotes, may hold commas; the last columns are times.
    sed -E 's/"[^"]*"/reason/' "$folder/frames.csv" | cut -d, -f"$(columns "$folder/frames.csv")" >"$folder/frames.tmp"
    grep -oE '"[^"]*"' "$folder/frames.csv" >>"$folder/frames.tmp" || true
    mv "$folder/frames.tmp" "$folder/frames.csv"
    touch "$folder/done"
  done < <(sides "$key")
  verdict "$name" "$key"
}
# The columns of a table that hold no times.
columns() {
  head -1 "$1" | tr , '\n' | grep -nvE '_ms$|milliseconds' | cut -d: -f1 | paste -sd,
}
disturbed() {  # NAME OPTIONS...: a flight of the tracking suite, whose figures are compared but for times
  local name=$1 key side folder program
  key=$(tr -c 'a-zA-Z0-9\n' _ <<<"$name")
  shift
  while read -r side folder program; do
    rm -rf "$folder" && mkdir -p "$folder"
    "$program" bench --suite tracking --rooms 1 "$@" --json "$folder/figures.json" >"$scratch/$side.log" 2>&1 || true
    grep -vE 'milliseconds|ms_per|median|p95|seconds|commit|version|"path"' "$folder/figures.json" >"$folder/figures.txt" ||
      fail "$name: no figures; see $scratch/$side.log."
    touch "$folder/done"
  done < <(sides "$key")
  verdict "$name" "$key"
}

for preset in default paper; do
  [[ $quick && $preset == paper ]] || compare "realsense_table, $preset" "$data/realsense_table" --config $preset
  compare "seven_scenes every 4th, $preset${quick:+, 50 frames}" "$data/seven_scenes" --config $preset --stride 4 \
    ${quick:+--max-frames 50}
  compare "tum_fr1_rpy every 3rd, $preset${quick:+, 80 frames}" "$data/tum_fr1_rpy" --config $preset --stride 3 \
    ${quick:+--max-frames 80}
  [[ $quick ]] && continue
  [[ -d $scratch/room1 ]] || "$old" synth "$scratch/room1" --frames 60 --seed 1 >/dev/null
  compare "room 1, 60 frames, $preset" "$scratch/room1" --config $preset
done
disturbed "room 911 with black frames" --seed 911 --frames 120 --disturb black
disturbed "room 907 with a hand" --seed 907 --frames 120 --disturb hand
disturbed "room 1114, kidnapped" --seed 1114 --frames 120 --disturb cut
if [[ -f $data/meshes/small_house.ply ]]; then
  [[ -d $scratch/walk ]] || "$old" synth "$scratch/walk" --mesh "$data/meshes/small_house.ply" --seed 71 --frames 500 \
    --loops 1 --width 320 --height 240 --fx 160 --fy 160 >/dev/null
  # It drifts by less than the usual tolerance; with this one two loops are closed.
  compare "a walk that closes loops" "$scratch/walk" --set loops.enabled=true --set loops.tolerance=0.004
fi
[[ $different == 0 ]] && echo "All results are the same."
exit $different
