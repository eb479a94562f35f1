#!/usr/bin/env bash
# Peers that mean harm beside an honest sender: hostile.sh [SECONDS [SEED [BUILD]]]. For half of 120 seconds by default without
# keys, then with them (and with senders whose keys are not allowed), hostile.py attacks a receiving run. The receiver's memory
# must stay within 500 MB of what it was, and its files and sockets within 200; of the honest sender's frames, 5 a second, nine
# tenths must arrive (how many are tracked is up to the machine); and at the end the run must write all its files.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
seconds=${1:-120}
RANDOM=${2:-1}
build=$(cd "${3:-$here/../../build/ci}" && pwd)
# shellcheck source=tests/faults/common.sh
source "$here/common.sh"
most_memory=${MOST_MEMORY:-500} most_files=200

work_of synth "$work/made" >log 2>&1 || { cat log >&2; exit 1; }
for name in server camera stranger; do "$program" keys "$name" >/dev/null; done
# At 5 frames a second, for longer than the attacks.
to_and_fro made/sequence $((5 * (seconds / 2 + 60))) \
  "{intrinsics: {fx: 48, fy: 48, cx: 47.5, cy: 35.5}, depth_units_per_metre: 5000, fps: 5"

failed=0
fail() { echo "hostile: $1: ${*:2}" >&2; failed=1; }

# half HOW: HOW is open or keys.
half() {
  local how=$1 receiver sender stranger="" counts code=0 server_keys=() camera_keys=()
  [[ $how == open ]] || server_keys=(--secret-key server.secret --peer-key camera.public)
  [[ $how == open ]] || camera_keys=(--secret-key camera.secret --peer-key server.public)
  port=$((port + 2))
  "$program" run "tcp://127.0.0.1:$port" --out "$how" --silence-limit 20 "${quick[@]}" "${server_keys[@]}" >"$how.log" 2>&1 &
  receiver=$!
  sleep 1
  if [[ $how == keys ]]; then
    while :; do
      timeout 5 "$program" send made/sequence "tcp://127.0.0.1:$port" --secret-key stranger.secret --peer-key server.public ||
        true
      timeout 5 "$program" send made/sequence "tcp://127.0.0.1:$port" || true
    done >/dev/null 2>&1 &
    stranger=$!
  fi
  python3 "$here/hostile.py" "$port" $((seconds / 2 + 10)) "$RANDOM" "$receiver" --replay $((port + 1)) >counts &
  counts=$!
  sleep 1
  "$program" send to_and_fro "tcp://127.0.0.1:$((port + 1))" --realtime "${camera_keys[@]}" --json "$how.json" >"$how.sender" 2>&1 &
  sender=$!
  wait $counts || fail "$how" "the attacks failed"
  [[ -z $stranger ]] || kill "$stranger" || fail "$how" "the strangers failed"
  kill -TERM "$receiver" 2>/dev/null || fail "$how" "the receiver is gone: $(tail -n 2 "$how.log")"
  wait $receiver || code=$?
  # Nobody answers a live sender any more, which it finds out.
  kill -TERM "$sender" 2>/dev/null || true
  for ((i = 0; i < 200; ++i)); do kill -0 "$sender" 2>/dev/null || break; sleep 0.1; done
  ! kill -9 "$sender" 2>/dev/null || fail "$how" "the honest sender cannot be stopped"
  wait $sender 2>/dev/null || true
  [[ $code == 130 || $code == 0 || $code == 4 ]] || fail "$how" "exit code $code: $(tail -n 5 "$how.log")"
  [[ -e $how/frames.csv ]] || { fail "$how" "no results: $(tail -n 2 "$how.log")"; return; }
  local sent arrived
  read -r sent arrived < <(sed -nE 's/.*"(frames|dropped)": ([0-9]+).*/\2/p' "$how.json" | awk '{ all += $1; n = n ? n : $1 } END { print all, n }')
  echo "hostile: $how, $((seconds / 2)) s: $(cat counts); $arrived of $sent frames arrived, $(($(wc -l <"$how/frames.csv") - 1))" \
    "tracked; $(grep -cE '^(info|warning)' "$how.log") lines said"
  ((10 * arrived >= 9 * sent)) || fail "$how" "$arrived of $sent frames arrived"
  local first most files
  read -r first most files < <(sed -E 's/.*memory ([0-9]+) at first, ([0-9]+) at most.*; ([0-9]+) files.*/\1 \2 \3/' counts)
  ((most - first <= most_memory)) || fail "$how" "the receiver's memory grew by $((most - first)) MB"
  ((files <= most_files)) || fail "$how" "the receiver held $files files and sockets"
}

for how in ${HALVES:-open keys}; do half "$how"; done
exit $failed
