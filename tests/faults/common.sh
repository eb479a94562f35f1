# For faults.sh and kills.sh: what is run, and what may lie there afterwards. Sourced with $build (a build folder), after
# which $work is a folder of its own with recording/ and result/, made without a fault. send and receive are the ends of a
# stream over $port.
port=$((20000 + ($$ * 7 + RANDOM) % 12000))  # below those that connections are given
program=$build/apps/cli/rosefusion
viewer=$build/apps/viewer/rosefusion-viewer
work=$(mktemp -d "${TMPDIR:-/tmp}/rosefusion-faults-XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
export XDG_CACHE_HOME=$work/cache LC_ALL=C
export ROSEFUSION_DEVICE=${ROSEFUSION_DEVICE:-llvmpipe}
quick=(--set swarm.levels=512/4 --set tracking.templates_per_level=2 --set volume.voxel_size=0.08
  --set volume.truncation=0.24 --set depth.sensor=kinect1 --set refine.pixel_stride=2)

# exec_work NAME OUT: this shell becomes one of the programs, with its output below OUT.
exec_work() {
  case "$1" in
    run) exec "$program" run recording --out "$2/result" "${quick[@]}" ;;
    receive) exec "$program" run "tcp://127.0.0.1:$port" --out "$2/result" --silence-limit 1 "${quick[@]}" ;;
    send) exec "$program" send recording --colour "tcp://127.0.0.1:$port" ;;
    synth) exec "$program" synth "$2/sequence" --frames 4 --width 96 --height 72 --fx 48 --fy 48 --max-speed 1 --force ;;
    eval) exec "$program" eval "$2/result" recording --json "$2/errors.json" ;;
    export)
      exec "$program" export "$2/result" --to "$2/a.glb" --to "$2/a.ply" --to "$2/a.html" --to "$2/a.tum" --to "$2/a.kitti"
      ;;
    viewer)
      exec "$viewer" recording --headless --screenshot "$2/picture.png" --after-frames 4 --width 800 --height 600 \
        "${quick[@]}"
      ;;
  esac
}
work_of() { (exec_work "$@"); }

# What is in OUT before: of eval and export, the result that they read; of the others, what an earlier run left.
before() {
  rm -rf "$2"
  mkdir -p "$2"
  case "$1" in
    eval | export) cp -r result "$2/result" ;;
    run | receive | send) [[ $((RANDOM % 2)) == 0 ]] || cp -r result "$2/result" ;;
    synth) [[ $((RANDOM % 2)) == 0 ]] || cp -r recording "$2/sequence" ;;
  esac
}

ends_with() { [[ $(tail -c "$2" "$1" | od -An -tx1 | tr -d ' \n') == "$3" ]]; }

# whole FILE: by its form, for times in it differ from run to run.
whole() {
  local size counts
  case "$1" in
    *.png) ends_with "$1" 12 0000000049454e44ae426082 ;;
    *.json) ends_with "$1" 3 0a7d0a ;;
    *.html) [[ $(tail -n 1 "$1") == *"</html>"* ]] ;;
    *.glb) [[ $(od -An -tu4 -j8 -N4 "$1" | tr -d ' ') == $(stat -c %s "$1") ]] ;;
    *.ply)
      counts=$(head -c 1000 "$1" | awk -v size="$(stat -c %s "$1")" '
        BEGIN { bytes["float"] = 4; bytes["uchar"] = 1; bytes["double"] = 8 }
        { header += length($0) + 1 }
        /^element/ { of = $2; count[of] = $3 }
        /^property list/ { each[of] += 13; next }
        /^property/ { each[of] += bytes[$2] }
        /^end_header/ { for (e in count) header += count[e] * each[e]; print header == size; exit }' 2>/dev/null)
      [[ $counts == 1 ]]
      ;;
    *) ends_with "$1" 1 0a ;;
  esac
}

# left_behind NAME OUT: says what is neither absent, whole, nor named as unfinished. A sequence's folder is whole
# or not there; report.json says that all the others are there.
left_behind() {
  local file
  if [[ $1 == synth && -d $2/sequence && -n $(ls -A "$2/sequence") ]]; then
    diff -rq --exclude='.rosefusion-part*' recording "$2/sequence" || true
  fi
  while IFS= read -r file; do
    [[ $file == *.part* ]] || whole "$file" || echo "$file is not whole"
  done < <(find "$2" -type f ! -name '*.pst*' ! -path '*/sequence/*')
  if [[ -e $2/result/report.json ]]; then
    for file in result/*; do [[ -e $2/$file ]] || echo "report.json is there without $file"; done
  fi
}

# same_results NAME OUT: says what differs from a run without faults.
same_results() {
  local file
  case "$1" in
    run | receive | send) for file in trajectory.txt mesh.ply preview.png settings.yaml view.html report.json frames.csv; do
      case "$file" in
        view.html | report.json | frames.csv) [[ -e $2/result/$file ]] || echo "$file is missing" ;;
        *) cmp -s "result/$file" "$2/result/$file" || echo "$file differs" ;;
      esac
    done ;;
    synth) diff -rq recording "$2/sequence" || true ;;
    *) for file in "reference-$1"/*; do
      [[ -f $file ]] || continue
      cmp -s "$file" "$2/${file##*/}" || echo "${file##*/} differs"
    done ;;
  esac
}

prepare() {  # NAME...
  local name
  work_of synth "$work/made" >log 2>&1 && mv made/sequence recording || { cat log >&2; exit 1; }
  work_of run "$work/made" >log 2>&1 && mv made/result result || { cat log >&2; exit 1; }
  for name in "$@"; do
    case "$name" in run | synth | receive | send) continue ;; esac
    before "$name" "$work/reference-$name"
    work_of "$name" "$work/reference-$name" >log 2>&1 || { cat log >&2; exit 1; }
  done
}

# to_and_fro SEQUENCE COUNT YAML: to_and_fro/, of SEQUENCE's depth images as often as needed, there and back. YAML: the
# beginning of its sequence.yaml.
to_and_fro() {
  local images=("$1"/depth/*.png) order i
  order=("${images[@]}")
  for ((i = ${#images[@]} - 2; i > 0; --i)); do order+=("${images[i]}"); done
  mkdir -p to_and_fro/depth
  for ((i = 0; i < $2; ++i)); do
    printf '%s\0%s\0' "../../${order[i % ${#order[@]}]}" "$(printf 'to_and_fro/depth/%06d.png' "$i")"
  done | xargs -0 -n 2 ln -s
  echo "$3, depth: depth/*.png}" >to_and_fro/sequence.yaml
}
