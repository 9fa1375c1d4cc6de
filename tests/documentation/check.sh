#!/bin/bash
# check.sh QUAYSIDE: the reference of the case format, the completion for bash and the examples in the help.
set -u
quayside=$(realpath "$1")
root=$(realpath "$(dirname "$0")/../..")
failed=0
fail() { echo "FAILED: $*"; failed=1; }

# The reference is what the program makes of the schema today.
diff -u "$root/cases/format.md" <("$quayside" case-format) ||
  fail "cases/format.md is not what 'quayside case-format' prints; run: quayside case-format > cases/format.md"

# Every key of the schema stands in it, at the end of its path.
python3 - "$root" <<'END' || fail "cases/format.md lacks keys of the schema"
import json, sys
text = open(sys.argv[1] + '/cases/format.md').read()
def keys(node):
    if isinstance(node, dict):
        yield from node.get('properties', {})
        for inner in node.values():
            yield from keys(inner)
    elif isinstance(node, list):
        for inner in node:
            yield from keys(inner)
missing = [key for key in set(keys(json.load(open(sys.argv[1] + '/cases/schema.json')))) if f'{key}`' not in text]
sys.exit(f'missing: {missing}' if missing else 0)
END

# complete WORD...: what is offered for the last of the words.
source <("$quayside" completion)
complete_words() {
  COMP_WORDS=(quayside "$@")
  COMP_CWORD=$#
  COMPREPLY=()
  _quayside
  echo "${COMPREPLY[*]}"
}
expect() {
  local wanted=$1 got
  shift
  got=$(complete_words "$@")
  [ "$got" = "$wanted" ] || fail "completion of '$*': '$got', expected '$wanted'"
}
expect "validate" val
expect "simbody" run case.yaml --engine sim
expect "reduced full" run case.yaml --scene ""
expect "--engine" run case.yaml --eng
expect "train trihedra" contact tr
expect "--fmi" export-fmu --fm
expect "" run no_option_begins_like_this

# Every command teaches with an example.
for command in $(complete_words ""); do
  case $command in -*) continue ;; esac
  if ! "$quayside" "$command" --help | grep -q "quayside $command\|Subcommands"; then fail "'quayside $command --help' has no example"; fi
done
exit $failed
