#!/bin/sh
# Every command and option that a README shows is one that the program's help knows.
#
#   check_commands.sh PROGRAM SOURCE_TREE
set -eu
program=$1 here=$(cd "$(dirname "$0")" && pwd)
cd "$2"
failures=0 shown=0
for document in $(git ls-files '*.md' 2>/dev/null || find . -name '*.md'); do
  commands=$(awk -f "$here/shown_commands.awk" "$document")
  while IFS= read -r command; do
    case $command in '' | test | test\ * | package*) continue ;; esac  # the wrapper's own
    shown=$((shown + 1))
    # Down the tree of commands, each of which lists its own.
    path= help=$("$program" --help)
    for word in $command; do
      printf '%s\n' "$help" | grep -q '^Subcommands:' || break
      printf '%s\n' "$help" | sed '1,/^Subcommands:/d' | grep -qE "^  $word( |\$)" || {
        case $word in --help) ;; *) echo "$document: no such command: quayside $path$word"; failures=$((failures + 1)) ;; esac
        break
      }
      path="$path$word "
      # shellcheck disable=SC2086  # one word a subcommand
      help=$("$program" $path --help)
    done
    for option in $(printf '%s\n' "$command" | tr ' ' '\n' | grep -oE '^--[a-z-]+' || true); do
      printf '%s\n' "$help" | grep -qE -- "(^|[ ,])$option([ ,=]|\$)" || {
        echo "$document: quayside $path has no option $option"
        failures=$((failures + 1))
      }
    done
  done <<LINES
$commands
LINES
done
echo "$shown commands shown, $failures wrong"
[ "$shown" -gt 0 ] && [ "$failures" = 0 ]
