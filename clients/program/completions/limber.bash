# shellcheck shell=bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Completion of limber for bash. The program's own --help says which verbs, options and words there are.
_limber() {
  local program=${COMP_WORDS[0]} current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} words
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    # Entries are indented by two columns: verbs are words, options start with hyphens.
    words=$("$program" --help 2>/dev/null | sed -nE 's/^  ([a-z][a-z-]*|(-[a-z], *)?--[a-z-]+).*/\1/p' | tr ',' ' ')
  elif [[ $current == -* ]]; then
    words=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null | sed -nE 's/^  (-[a-z], *)?(--[a-z-]+).*/\2/p')
  elif [[ $previous == --* ]]; then
    # An option that takes one of some words shows them as fast|classic|reference; words in capitals stand for others.
    words=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null |
      sed -nE "s/^  (-[a-z], *)?$previous ([A-Za-z-]+(\|[A-Za-z-]+)+).*/\2/p" | tr '|' '\n' | grep -v '[A-Z]')
  fi
  readarray -t COMPREPLY < <(compgen -W "$words" -- "$current")
}
# What is no word of the program's is a file.
complete -o default -F _limber limber
