#!/bin/sh
# Runs the commands of README.md, in their order, in a folder that holds what they read: the cases and the responses to
# impacts, after the copies (`cp`) that it shows. Those that take long say so in their comment ("minutes"), and are left out.
#
#   run_readme.sh PROGRAM SOURCE_TREE
set -eu
program=$1 source=$2 here=$(cd "$(dirname "$0")" && pwd)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cp -r "$source/cases" "$place/cases"
mkdir -p "$place/tests/regression"
cp "$source/tests/regression/impacts.csv" "$place/tests/regression/"
cd "$place"
grep -E '^    cp ' "$source/README.md" | sed 's/ *#.*//' | sh -e
grep -v minutes "$source/README.md" | awk -f "$here/shown_commands.awk" | grep -vE '^(test|package)' >commands
while IFS= read -r command; do
  echo "quayside $command"
  eval "\"$program\" $command" >output 2>&1 </dev/null || { cat output; exit 1; }
done <commands
