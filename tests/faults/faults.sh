#!/usr/bin/env bash
# One call that fails: faults.sh BUILD device|files SECONDS [SEED [NAME...]] runs the programs (NAME: run, synth, eval,
# export, viewer) again and again, each time with one Vulkan command or one file function that fails once, at its first,
# middle, last or a random call. Each must end with a documented exit code and an error in words, and leave nothing that
# looks finished and is not; an interrupted or short write is survived.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(cd "$1" && pwd)
kind=$2
seconds=$3
RANDOM=${4:-1}
shift $(($# < 4 ? $# : 4))
names=("$@")
# shellcheck source=tests/faults/common.sh
source "$here/common.sh"
if [[ ${#names[@]} -eq 0 ]]; then
  names=(run synth eval export)
  [[ $kind == files ]] || names=(run)
  [[ ! -x $viewer ]] || names+=(viewer)
fi
export FAULT_FOLDER=$work/out FAULT_COUNTS=$work/counts
[[ $kind == files ]] || FAULT_FOLDER=/nowhere

# faulty NAME: in $work/out, with the fault that the environment names. All output goes to the log.
faulty() {
  local command=(timeout 300 bash -c 'program=$1 viewer=$2; source "$3"; quick=("${@:6}"); exec_work "$4" "$5"' bash)
  before "$1" "$work/out"
  rm -f counts
  declare -f exec_work >exec_work.sh
  command+=("$program" "$viewer" ./exec_work.sh "$1" "$work/out" "${quick[@]}")
  if [[ $kind == device ]]; then
    VK_LAYER_PATH=$build/tests/faults VK_INSTANCE_LAYERS=VK_LAYER_ROSEFUSION_faults "${command[@]}" >log 2>&1
  else
    LD_PRELOAD=$build/tests/faults/libfailing_files.so "${command[@]}" >log 2>&1
  fi
}

# What a command may return, as Vulkan's specification and POSIX have it.
results_of() {
  case "$1" in
    vkQueueSubmit | vkWaitForFences | vkGetFenceStatus | vkQueueWaitIdle | vkDeviceWaitIdle) echo -1 -2 -4 ;;
    vkMapMemory) echo -1 -2 -5 ;;            # memory map failed
    vkAllocateMemory) echo -1 -2 -10 ;;      # too many objects
    vkAllocateDescriptorSets) echo -1 -2 -12 -1000069000 ;;  # fragmented, out of pool memory
    vkCreateDescriptorPool) echo -1 -2 -1000161000 ;;        # fragmentation
    vkCreateDevice) echo -1 -2 -3 -4 -10 ;;
    vkCreateInstance) echo -1 -2 -3 -9 ;;
    vkEnumeratePhysicalDevices) echo -1 -2 -3 ;;
    vkResetFences) echo -2 ;;
    vk*) echo -1 -2 ;;
    open) echo 28 30 5 4 13 ;;  # ENOSPC EROFS EIO EINTR EACCES
    open_to_read) echo 5 4 ;;
    write) echo 28 5 4 0 ;;
    read) echo 5 4 0 ;;
    close) echo 28 5 4 ;;
    *) echo 28 30 5 ;;
  esac
}
# Errors that are survived.
survives() { [[ $kind == files && ($1 == 4 || $1 == 0) ]]; }

injected=0 broken=0
# inject NAME COMMAND CALL RESULT
inject() {
  local code=0 problems=""
  FAULT_COMMAND=$2 FAULT_CALL=$3 FAULT_RESULT=$4 faulty "$1" || code=$?
  case $code in
    0) problems=$(same_results "$1" "$work/out") ;;
    2) [[ $kind == files ]] || problems="exit code 2" ;;
    3) [[ $kind == device ]] || problems="exit code 3" ;;
    124) problems="it hangs" ;;
    *) problems="exit code $code" ;;
  esac
  [[ $code == 0 ]] || ! survives "$4" || problems+=" not survived"
  [[ $code == 0 ]] || grep -q '^error: .*[;.]' log || problems+=" no error in words"
  problems+=$(left_behind "$1" "$work/out")
  injected=$((injected + 1))
  [[ -n ${VERBOSE:-} ]] && echo "$1 $2 $3 $4 -> $code $(grep '^error' log | head -n 1)"
  [[ -z $problems ]] && return
  broken=$((broken + 1))
  printf 'faults: %s with %s, call %s, returning %s: %s\n' "$1" "$2" "$3" "$4" "$problems" >&2
  tail -n 6 log | sed 's/^/    /' >&2
}

prepare "${names[@]}"
SECONDS=0
declare -A counted
cases=()
for name in "${names[@]}"; do
  FAULT_COMMAND=none faulty "$name" || { cat log >&2; exit 1; }
  while read -r command count; do
    counted[$name $command]=$count
    for result in $(results_of "$command"); do
      for call in $(printf '%s\n' 1 $(((count + 1) / 2)) "$count" | sort -nu); do cases+=("$name $command $call $result"); done
    done
  done <counts
done
echo "faults: ${#cases[@]} faults at first, middle and last calls"
mapfile -t cases < <(printf '%s\n' "${cases[@]}" | shuf --random-source=<(yes "$RANDOM"))
for case in "${cases[@]}"; do
  ((SECONDS < seconds)) || break
  read -r name command call result <<<"$case"
  inject "$name" "$command" "$call" "$result"
done
keys=("${!counted[@]}")
while ((SECONDS < seconds)); do
  key=${keys[RANDOM % ${#keys[@]}]}
  read -r name command <<<"$key"
  read -ra results < <(results_of "$command")
  count=${counted[$key]}
  inject "$name" "$command" $((RANDOM % count + 1)) "${results[RANDOM % ${#results[@]}]}"
done
echo "faults: $injected injected ($kind: ${names[*]}), $broken not as they should be"
[[ $broken == 0 ]]
