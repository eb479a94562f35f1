#!/usr/bin/env bash
# Killed at a random moment: kills.sh BUILD [COUNT [SEED [NAME...]]]. Afterwards each file of run, synth, the viewer and a
# stream's receiver is absent, whole or named as unfinished, and the same command works again. Of a stream (where the build
# has streams) one end is killed while the other lives on: a receiver whose sender is gone writes what it has, and both
# ends begun anew give what the run from disk gives. 100 kills by default.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(cd "$1" && pwd)
count=${2:-100}
RANDOM=${3:-1}
shift $(($# < 3 ? $# : 3))
names=("$@")
# shellcheck source=tests/faults/common.sh
source "$here/common.sh"
if [[ ${#names[@]} -eq 0 ]]; then
  names=(run synth)
  [[ ! -x $viewer ]] || names+=(viewer)
  ! "$program" keys "$work/try" >/dev/null 2>&1 || names+=(receive send)
fi
prepare "${names[@]}"

milliseconds() { echo $(($(date +%s%N) / 1000000)); }

# begin NAME OUT LOG: in the background; $child is its process.
begin() {
  (exec_work "$1" "$2") >"$3" 2>&1 &
  child=$!
}
# ends_within SECONDS PROCESS: $code is then its exit code.
ends_within() {
  local end=$(($(milliseconds) + 1000 * $1))
  while kill -0 "$2" 2>/dev/null; do
    (($(milliseconds) < end)) || return 1
    sleep 0.05
  done
  code=0
  wait "$2" 2>/dev/null || code=$?
}
other_of() { [[ $1 == send ]] && echo receive || echo send; }
is_stream() { [[ $1 == send || $1 == receive ]]; }

problems=""
say() { problems+=" $*;"; }

declare -A lasts
# whole_work NAME OUT: without a kill; of a stream both ends. ${lasts[NAME]}: how long it took, milliseconds.
whole_work() {
  local receiver sender start
  start=$(milliseconds)
  if ! is_stream "$1"; then
    work_of "$1" "$2" >log 2>&1 || say "it does not run again: $(tail -n 1 log)"
    lasts[$1]=$(($(milliseconds) - start))
    return 0
  fi
  begin receive "$2" log
  receiver=$child
  begin send "$2" log.other
  sender=$child
  whole_end "$sender" log.other
  lasts[send]=$(($(milliseconds) - start))
  whole_end "$receiver" log
  lasts[receive]=$(($(milliseconds) - start))
}
whole_end() {
  if ! ends_within 300 "$1"; then
    kill -9 "$1"
    say "it hangs anew: $(tail -n 1 "$2")"
  elif ((code != 0)); then
    say "it does not run again: $(tail -n 1 "$2")"
  fi
}

for name in "${names[@]}"; do
  before "$name" "$work/out"
  whole_work "$name" "$work/out"
  problems+=$(same_results "$name" "$work/out")
  [[ -z $problems ]] || { echo "kills: $name without a kill: $problems" >&2; exit 1; }
done

# survivor_ends NAME PROCESS: the other end of a stream, whose NAME was killed, is ended in order. A sender waits for a new
# receiver. A receiver that had frames ends after its silence limit; another waits for a new sender.
survivor_ends() {
  local signal=""
  if [[ $1 == receive ]] || ! ends_within 8 "$2"; then
    signal=TERM
    kill -TERM "$2" 2>/dev/null || true
    if ! ends_within 120 "$2"; then
      kill -9 "$2"
      say "the $(other_of "$1") hangs"
      return
    fi
  fi
  case $code in
    0 | 4) ;;
    130 | 143) [[ -n $signal ]] || say "exit code $code without a signal" ;;  # 143: before it takes signals
    2) grep -q '^error: .*[;.]' log.other || say "no error in words" ;;
    *) say "the $(other_of "$1") ends with $code: $(tail -n 1 log.other)" ;;
  esac
}

killed=0 done_before=0 broken=0
for ((i = 0; i < count; ++i)); do
  name=${names[i % ${#names[@]}]}
  before "$name" "$work/out"
  if is_stream "$name"; then
    begin "$(other_of "$name")" "$work/out" log.other
    survivor=$child
  fi
  begin "$name" "$work/out" log
  victim=$child
  sleep "$(awk -v ms=$((RANDOM % (lasts[$name] + lasts[$name] / 10 + 1))) 'BEGIN { print ms / 1000 }')"
  kill -9 $victim 2>/dev/null || done_before=$((done_before + 1))
  wait $victim 2>/dev/null || true
  killed=$((killed + 1))
  problems=""
  ! is_stream "$name" || survivor_ends "$name" "$survivor"
  problems+=$(left_behind "$name" "$work/out")
  # What was killed is begun anew: each time for a sequence, whose folder is moved about, else every third time.
  if [[ $name == synth || $((i / ${#names[@]} % 3)) == 0 ]]; then
    whole_work "$name" "$work/out"
    problems+=$(same_results "$name" "$work/out")
    problems+=$(find "$work/out" -maxdepth 1 -name '*.part')
  fi
  [[ -z $problems ]] && continue
  broken=$((broken + 1))
  printf 'kills: %s, %s\n' "$name" "$problems" >&2
done
echo "kills: $killed of ${names[*]} ($done_before came after the end), $broken not as they should be"
[[ $broken == 0 ]]
