#!/usr/bin/env bash
# Whether it lasts: long.sh [FRAMES [BUILD]]. A camera of 160 x 120 flies the same path to and fro for 5,000 frames by default:
# from disk, as a stream, and in the Python module where the build has it. Prints what 1,000 frames add to the resident
# memory (of a software device that is the device's memory too), to open files and to a frame's processor time, once the
# model stands (after the first third). Fails above 1 MB, one file or a tenth of the time.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
frames=${1:-5000}
build=$(cd "${2:-$here/../../build/ci}" && pwd)
# shellcheck source=tests/faults/common.sh
source "$here/common.sh"
"$program" synth made --frames 40 --width 160 --height 120 --fx 131 --fy 131 --max-speed 1 --no-colour >log 2>&1 ||
  { cat log >&2; exit 1; }
to_and_fro made "$frames" "{intrinsics: {fx: 131, fy: 131, cx: 79.5, cy: 59.5}, depth_units_per_metre: 5000, fps: 30"
failed=0

python3 "$here/long.py" disk "$frames" "$program" run to_and_fro --out disk --no-page || failed=1
if "$program" keys try >/dev/null 2>&1; then
  "$program" send to_and_fro "tcp://127.0.0.1:$port" >log 2>&1 &
  sender=$!
  python3 "$here/long.py" stream "$frames" "$program" run "tcp://127.0.0.1:$port" --out stream --no-page --silence-limit 60 || failed=1
  kill $sender 2>/dev/null || true
fi
if compgen -G "$build/apps/python/rosefusion.*" >/dev/null; then
  PYTHONPATH=$build/apps/python python3 "$here/long.py" library "$frames" "$work/made" || failed=1
fi
exit $failed
