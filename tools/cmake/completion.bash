# Completion of ivory's command line for bash. What may follow is read from --help, so that nothing here grows stale.
_ivory() {
  local ivory=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local help commands=() next=1 below
  # As far as the words name commands.
  while
    help=$("$ivory" "${commands[@]}" --help 2>/dev/null)
    below=$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z0-9]*\) .*/\1/p' <<<"$help")
    ((next < COMP_CWORD)) && grep -qx -e "${COMP_WORDS[next]}" <<<"$below"
  do
    commands+=("${COMP_WORDS[next++]}")
  done
  # Values that an option is limited to stand behind its name as {one,other}.
  local values=
  [[ $previous == -* ]] && values=$(sed -n "s/^  \(-.,\)\?$previous [^{]*{\([^}]*\)}.*/\2/p" <<<"$help")
  if [[ $values ]]; then
    COMPREPLY=($(compgen -W "${values//,/ }" -- "$word"))
  elif [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$(sed -n 's/^  \(-[^ ]*\).*/\1/p' <<<"$help" | tr ',' '\n')" -- "$word"))
  else
    COMPREPLY=($(compgen -W "$below" -- "$word"))  # where there is none, bash completes file names
  fi
}
complete -o default -F _ivory ivory
