#!/usr/bin/env bash
# The manual page and the completion that a build makes say what the program says: description.sh PROGRAM FOLDER
set -euo pipefail
program=$1 folder=$2
fail() {
  echo "description: $*" >&2
  exit 1
}
page=$(sed 's/\\-/-/g' "$folder/rosefusion.1")
# shellcheck disable=SC1091
source "$folder/rosefusion.bash"
# complete WORDS...: what would be offered for the last of them.
complete_words() {
  COMP_WORDS=(rosefusion "$@")
  COMP_CWORD=$#
  _rosefusion
  printf '%s\n' "${COMPREPLY[@]}"
}
for command in run eval-mesh synth bench; do
  grep -qx ".SH rosefusion $command" <<<"$page" || fail "the manual page has no section on '$command'."
  grep -qx -- "$command" <<<"$(complete_words "${command:0:2}")" || fail "'$command' is not completed."
  # Every long option that --help names anywhere but in its examples.
  options=$("$program" "$command" --help | sed '/^Examples\?:/,$d' | grep -oE '^ +-[-a-zA-Z,= ]+' | grep -oE -- '--[a-z-]+' | sort -u)
  [[ $(wc -l <<<"$options") -ge 4 ]] || fail "'$command --help' was not understood."
  for option in $options; do
    grep -qE "^.fB.*$option([^a-z-]|$)" <<<"$page" || fail "the manual page lacks $option of '$command'."
    grep -qx -- "$option" <<<"$(complete_words "$command" "$option")" || fail "$option of '$command' is not completed."
  done
done
[[ $(complete_words run --config pap) == paper ]] || fail "the presets are not completed."
[[ -z $(complete_words keys --device) ]] || fail "an option of other commands is completed for 'keys'."
if command -v groff >/dev/null; then
  complaints=$(groff -man -Tutf8 -ww -z "$folder/rosefusion.1" 2>&1 | grep -v 'break\|adjust' || true)
  [[ -z $complaints ]] || fail "groff complains of the manual page: $complaints"
fi
echo "description: manual page and completion agree with --help"
