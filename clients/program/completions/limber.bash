# shellcheck shell=bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Completion of limber for bash. The program's own --help says which verbs and options there are.
_limber() {
  local program=${COMP_WORDS[0]} current=${COMP_WORDS[COMP_CWORD]} words
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    # Entries are indented by two columns: verbs are words, options start with hyphens.
    words=$("$program" --help 2>/dev/null | sed -nE 's/^  ([a-z][a-z-]*|(-[a-z], *)?--[a-z-]+).*/\1/p' | tr ',' ' ')
  elif [[ $current == -* ]]; then
    words=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null | sed -nE 's/^  (-[a-z], *)?(--[a-z-]+).*/\2/p')
  fi
  readarray -t COMPREPLY < <(compgen -W "$words" -- "$current")
}
# What is no word of the program's is a file.
complete -o default -F _limber limber
