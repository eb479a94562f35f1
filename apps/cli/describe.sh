#!/usr/bin/env bash
# The manual page and bash's completion, from what --help says: describe.sh PROGRAM VERSION FOLDER writes rosefusion.1 and
# rosefusion.bash there.
set -euo pipefail
program=$1 version=$2 folder=$3
mkdir -p "$folder"

help() {
  (cd "$(dirname "$program")" && exec -a rosefusion ./"$(basename "$program")" "$@" --help) |
    awk '/^[^ ]/ {listed = /:$/ && tolower($0) !~ /^examples?:$/}
    {sub(/^Usage: [^ ]*rosefusion/, "Usage: rosefusion"); gsub(/{false}/, "")}
    listed {sub(/^ +-/, "  -"); if ($0 ~ /^  -[^-],? +--/) sub(/,? +--/, ",--")}
    {print}'
}
# The names in the list of subcommands; CLI11 2.5 and later have headings in capitals and long options in a column of their own.
commands=$(help | awk 'tolower($0) ~ /^subcommands:/ {on = 1; next} on && /^  [a-z]/ {print $1}')
[[ -n $commands ]] || { echo "describe: '$program --help' lists no subcommand." >&2; exit 1; }

# Lists become tagged paragraphs, the rest stays as it was set.
manual() {
  awk '
    function text(line) { gsub(/\\/, "\\e", line); gsub(/-/, "\\-", line); if (line ~ /^[.\047]/) line = "\\&" line; return line }
    function section(kind) {
      if (kind == now) return
      if (now == "as it is") print ".fi"
      if (kind == "as it is") print ".nf"
      now = kind
    }
    /^[^ ].*:$/ {
      listed = tolower($0) !~ /^examples?:$/
      section("text"); print ".PP"; print "\\fB" text($0) "\\fR"
      if (!listed) section("as it is")
      next
    }
    /^$/ { next }
    /^Usage: / { section("text"); print ".PP"; print text($0); next }
    listed && /^  [^ ]/ {
      line = substr($0, 3); term = line; rest = ""
      if (match(line, /  +/)) { term = substr(line, 1, RSTART - 1); rest = substr(line, RSTART + RLENGTH) }
      print ".TP"; print "\\fB" text(term) "\\fR"; if (rest != "") print text(rest); next }
    listed && /^   / { sub(/^ +/, ""); print text($0); next }
    { if (listed) { listed = 0; section("as it is") } print text($0) }
    END { section("text") }'
}
{
  echo ".TH ROSEFUSION 1 \"\" \"rosefusion $version\""
  echo '.SH NAME'
  echo 'rosefusion \- dense 3\-D reconstruction from a fast\-moving depth camera'
  echo '.SH DESCRIPTION'
  help | manual
  for command in $commands; do
    echo ".SH rosefusion $command" | sed 's/-/\\-/g'
    help "$command" | manual
  done
} >"$folder/rosefusion.1"

{
  echo "# Completion of rosefusion's commands and options; generated from --help."
  echo '_rosefusion() {'
  echo '  local word=${COMP_WORDS[COMP_CWORD]} words=""'
  echo '  if [[ $COMP_CWORD -eq 1 ]]; then'
  echo "    words=\"$(echo $commands) --help --version\""
  echo '  elif [[ ${COMP_WORDS[COMP_CWORD - 1]} == --config ]]; then'
  echo '    words="default paper"'
  echo '  elif [[ $word == -* ]]; then'
  echo '    case ${COMP_WORDS[1]} in'
  for command in $commands; do
    options=$(help "$command" | awk '/^[^ ]/ {on = /:$/ && tolower($0) !~ /^examples?:$/} on && /^  -/ {print $1}' |
      tr ',' '\n' | grep '^--' | tr '\n' ' ')
    echo "      $command) words=\"${options% }\" ;;"
  done
  echo '    esac'
  echo '  fi'
  echo '  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")'
  echo '}'
  echo 'complete -o default -F _rosefusion rosefusion'
} >"$folder/rosefusion.bash"
