#!/bin/sh
# Installs a build into an empty folder, runs the program from there, builds both examples against it and runs them.
#
#   check_installed.sh BUILD_DIRECTORY CMAKE
set -eu
build=$1 cmake=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
prefix=$place/prefix

"$cmake" --install "$build" --prefix "$prefix" >"$place/install.log" || { cat "$place/install.log"; exit 1; }
cd "$place"
"$prefix/bin/quayside" run "$prefix/share/quayside/cases/free_sway.yaml" --engine simbody --scene full --out "$place/run" >/dev/null
test -s "$place/run/summary.json"
"$prefix/bin/quayside" export-fmu "$prefix/share/quayside/cases/free_sway.yaml" -o "$place/free_sway.fmu" >/dev/null

for example in contact_query step_case; do
  cp -r "$prefix/share/doc/quayside/examples/$example" "$place/$example"
  { "$cmake" -G Ninja -S "$example" -B "$example/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release &&
    "$cmake" --build "$example/build"; } >"$example.log" 2>&1 || { cat "$example.log"; exit 1; }
done

contact_query/build/contact_query | tee contact.txt
# Flat on a face of 12.192 m less 0.1 m by 2.438 m, 2 mm deep: a gap of -2 mm, the normal up.
grep -q '^gap -0.002000 m, normal (0.000, 0.000, 1.000)$' contact.txt
# The case stepped from outside ends where the program's own run of the same scene ends: both to the solver's tolerance of
# 1e-6 of a metre, and stepped at other communication times, of which Simbody's integrator takes no notice.
step_case/build/step_case "$prefix/share/quayside/cases/free_sway.yaml" | tail -n 1 | tee step.txt
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /load.position.z/) column = i } END { print $1, $column }' \
  "$place/run/trajectory_simbody.csv" | tee run.txt
awk 'NR == FNR { time = $1; z = $2; next } { exit !($1 == time && ($3 - z)^2 <= 2e-6 ^ 2) }' run.txt step.txt
