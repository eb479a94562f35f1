#!/usr/bin/env bash
# Killed at a random moment: kills.sh BUILD [COUNT [SEED]]. Afterwards each file of run, synth and the viewer is absent,
# whole or named as unfinished, and the same command works again. 100 kills by default.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(cd "$1" && pwd)
count=${2:-100}
RANDOM=${3:-1}
# shellcheck source=tests/faults/common.sh
source "$here/common.sh"
names=(run synth)
[[ ! -x $viewer ]] || names+=(viewer)
prepare "${names[@]}"

milliseconds() { echo $(($(date +%s%N) / 1000000)); }
declare -A lasts
for name in "${names[@]}"; do
  before "$name" "$work/out"
  start=$(milliseconds)
  work_of "$name" "$work/out" >log 2>&1
  lasts[$name]=$(($(milliseconds) - start))
done

killed=0 done_before=0 broken=0
for ((i = 0; i < count; ++i)); do
  name=${names[i % ${#names[@]}]}
  before "$name" "$work/out"
  (exec_work "$name" "$work/out") >log 2>&1 &
  child=$!
  sleep "$(awk -v ms=$((RANDOM % (lasts[$name] + lasts[$name] / 10 + 1))) 'BEGIN { print ms / 1000 }')"
  kill -9 $child 2>/dev/null || done_before=$((done_before + 1))
  wait $child 2>/dev/null || true
  killed=$((killed + 1))
  problems=$(left_behind "$name" "$work/out")
  # What was killed is begun anew: each time for a sequence, whose folder is moved about, else every third time.
  if [[ $name == synth || $((i % 9)) -lt 3 ]]; then
    work_of "$name" "$work/out" >log 2>&1 || problems+=" it does not run again: $(tail -n 1 log)"
    problems+=$(same_results "$name" "$work/out")
    problems+=$(find "$work/out" -maxdepth 1 -name '*.part')
  fi
  [[ -z $problems ]] && continue
  broken=$((broken + 1))
  printf 'kills: %s, %s\n' "$name" "$problems" >&2
done
echo "kills: $killed ($done_before came after the end), $broken not as they should be"
[[ $broken == 0 ]]
