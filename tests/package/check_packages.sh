#!/bin/sh
# On a machine that has nothing but the Debian packages beside this script: installs them, does the main job, exports an FMU,
# and builds and runs both examples.
set -eu
cd "$(dirname "$0")"
apt-get update -qq
apt-get install -y -qq --no-install-recommends ./quayside_*.deb >install.log 2>&1 || { tail -n 20 install.log; exit 1; }
echo "installed: the program alone, $(dpkg-query -f '.\n' -W | wc -l) packages"
quayside run /usr/share/quayside/cases/land_on_stack.yaml --out run
quayside export-fmu /usr/share/quayside/cases/land_on_stack.yaml -o crane.fmu
apt-get install -y -qq --no-install-recommends ./quayside-dev_*.deb g++ cmake make >install.log 2>&1 || { tail -n 20 install.log; exit 1; }
for example in contact_query step_case; do
  cp -r "/usr/share/doc/quayside/examples/$example" .
  { cmake -S "$example" -B "$example/build" -DCMAKE_BUILD_TYPE=Release && cmake --build "$example/build"; } >build.log 2>&1 ||
    { cat build.log; exit 1; }
done
contact_query/build/contact_query
step_case/build/step_case /usr/share/quayside/cases/free_sway.yaml | tail -n 1
