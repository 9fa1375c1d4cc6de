# The commands of the program in the code blocks of a Markdown file: one a line, continuations joined, `./quayside` and
# `quayside` alike, comments off.
/^    / || continued {
  line = $0
  sub(/^ +/, "", line)
  text = continued ? text " " line : line
  continued = sub(/ *\\$/, "", text)
  if (continued) next
  if (text ~ /^(\.\/)?quayside /) {
    sub(/^(\.\/)?quayside /, "", text)
    sub(/ +#.*$/, "", text)
    print text
  }
}
