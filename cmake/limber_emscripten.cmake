# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What everything is compiled with for WebAssembly, and where its headers are. clients/javascript/README.md says why.
add_compile_options(-msimd128 -mbulk-memory -mnontrapping-fptoint -msign-ext -fwasm-exceptions
  "SHELL:-include ${PROJECT_SOURCE_DIR}/clients/javascript/src/missing_from_libcxx.h")

# Emscripten looks for headers in its own folders only, and the system's must not come in the way of its C library. So
# Boost's get a folder of their own. Boost puts paths of its headers into messages; the option shortens them, so that the
# module has the same bits in whatever folder it is built.
set(headers ${PROJECT_BINARY_DIR}/headers)
add_compile_options(-ffile-prefix-map=${headers}=.)
file(MAKE_DIRECTORY ${headers})
file(CREATE_LINK /usr/include/boost ${headers}/boost SYMBOLIC)
include_directories(SYSTEM ${headers})
set(Boost_INCLUDE_DIR ${headers})

