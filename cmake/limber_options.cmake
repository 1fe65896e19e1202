# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What every target of this project is compiled with.
add_library(limber_options INTERFACE)
target_compile_features(limber_options INTERFACE cxx_std_20)
# Exactness claims need the operations as written: no contraction into fused multiply-adds.
target_compile_options(limber_options INTERFACE
  -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor
  $<$<BOOL:${LIMBER_WARNINGS_AS_ERRORS}>:-Werror>)
target_compile_definitions(limber_options INTERFACE $<$<BOOL:${LIMBER_CHECKS}>:LIMBER_CHECKS>)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
