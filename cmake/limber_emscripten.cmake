# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What everything is compiled with for WebAssembly, and where its headers are. docs/design/web.md says why.
add_compile_options(-msimd128 -mbulk-memory -mnontrapping-fptoint -msign-ext -fwasm-exceptions
  "SHELL:-include ${PROJECT_SOURCE_DIR}/clients/javascript/src/missing_from_libcxx.h")

# Emscripten looks for headers in its own folders only, and the system's must not come in the way of its C library. So
# the libraries of headers that are needed get a folder of their own. Boost puts paths of its headers into messages; the
# option shortens them, so that the module has the same bits in whatever folder it is built.
set(headers ${PROJECT_BINARY_DIR}/headers)
add_compile_options(-ffile-prefix-map=${headers}=.)
file(MAKE_DIRECTORY ${headers})
foreach(library boost fast_float nlohmann)
  file(CREATE_LINK /usr/include/${library} ${headers}/${library} SYMBOLIC)
endforeach()
include_directories(SYSTEM ${headers})
set(Boost_INCLUDE_DIR ${headers})
add_library(nlohmann_json::nlohmann_json INTERFACE IMPORTED)
target_include_directories(nlohmann_json::nlohmann_json INTERFACE ${headers})

