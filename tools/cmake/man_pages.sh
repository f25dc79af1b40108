#!/bin/sh
# usage: man_pages.sh IVORY FOLDER
# Writes the man pages of ivory and of each command, ivory.1, ivory-bake.1, ivory-bake-grid.1 ..., into FOLDER: what
# --help says, set by help2man.
set -eu
ivory=$1
folder=$2
version=$("$ivory" --version | sed 's/.* //')
text=$(mktemp)
trap 'rm -f "$text"' EXIT
mkdir -p "$folder"

# The page of the command that the arguments name, and those of the commands below it.
page() {
  name=$(echo ivory "$@" | tr ' ' -)
  # help2man knows the heading Examples, and sets lines below it apart that start with a $.
  "$ivory" "$@" --help | sed 's/^Example:/Examples:/; s/^  ivory /  $ ivory /' >"$text"
  summary=$(sed '/^Usage:/,$d' "$text" | tr '\n' ' ')
  help2man --no-info --name="${summary% }" --version-string="$name $version" --help-option="$text" cat \
    >"$folder/$name.1"
  for command in $(sed -n '/^Subcommands:/,/^$/s/^  \([a-z0-9]*\) .*/\1/p' "$text"); do
    page "$@" "$command"
  done
}
page
