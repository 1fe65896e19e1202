# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Completion of limber for fish. The program's own --help says which verbs and options there are.
function __limber_verbs
    limber --help 2>/dev/null | string replace --regex --filter '^  ([a-z][a-z-]*) +(.*)' '$1\t$2'
end
function __limber_options
    limber (commandline --tokenize --current-process --cut-at-cursor)[2] --help 2>/dev/null |
        string replace --regex --filter '^  (?:-[a-z], *)?(--[a-z-]+).*' '$1'
end
complete --command limber --no-files --condition __fish_use_subcommand --arguments '(__limber_verbs)'
complete --command limber --condition 'not __fish_use_subcommand' --arguments '(__limber_options)'
