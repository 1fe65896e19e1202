#compdef limber
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Completion of limber for zsh. The program's own --help says which verbs and options there are.
local -a entries
if ((CURRENT == 2)); then
  entries=(${(f)"$($words[1] --help 2>/dev/null | sed -nE 's/^  ([a-z][a-z-]*) +(.*)/\1:\2/p')"})
  _describe verb entries
elif [[ $PREFIX == -* ]]; then
  entries=(${(f)"$($words[1] $words[2] --help 2>/dev/null | sed -nE 's/^  (-[a-z], *)?(--[a-z-]+).*/\2/p')"})
  _describe -o option entries
else
  _files
fi
