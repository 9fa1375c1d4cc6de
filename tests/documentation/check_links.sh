#!/bin/sh
# Every relative link of a Markdown file leads to a file or folder, and a link to a heading to one that is there.
#
#   check_links.sh SOURCE_TREE
set -eu
cd "$1"
failures=0 links=0
for document in $(git ls-files '*.md' 2>/dev/null || find . -name '*.md'); do
  for link in $(grep -oE '\]\([^) ]+\)' "$document" | sed 's/^](//; s/)$//'); do
    case $link in http://* | https://*) continue ;; esac
    links=$((links + 1))
    file=${link%%#*} heading=
    case $link in *'#'*) heading=${link#*#} ;; esac
    target=$(dirname "$document")/$file
    [ -n "$file" ] || target=$document
    if [ ! -e "$target" ]; then
      echo "$document: no such file: $link"
      failures=$((failures + 1))
    elif [ -n "$heading" ] && ! sed -n 's/^##* //p' "$target" | tr 'A-Z ' 'a-z-' | tr -cd 'a-z0-9\n_-' | grep -qx -- "$heading"; then
      echo "$document: no such heading: $link"
      failures=$((failures + 1))
    fi
  done
done
echo "$links links, $failures lead nowhere"
[ "$links" -gt 0 ] && [ "$failures" = 0 ]
