# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Whether the pages in apps/limber/pages are built from the sources in web/pages, as far as can be told without npm: each
# names the digest of its sources, as web/pages/build.mjs computes it. Run by cmake -DSOURCE_DIR=... -P.
cmake_minimum_required(VERSION 3.25)

set(folder ${SOURCE_DIR}/web/pages)
file(GLOB_RECURSE sources RELATIVE ${folder} ${folder}/report/* ${folder}/replay/* ${folder}/live/*
     ${folder}/shared/*)
list(FILTER sources INCLUDE REGEX "\\.(ts|css|html)$")
file(GLOB parts RELATIVE ${folder} ${folder}/../limber3d/*.js)
list(APPEND sources ${parts} build.mjs package-lock.json)
list(SORT sources)
set(lines "")
foreach(source ${sources})
  file(SHA256 ${folder}/${source} digest)
  string(APPEND lines "${digest} ${source}\n")
endforeach()
string(SHA256 expected "${lines}")

foreach(page report replay live)
  file(STRINGS ${SOURCE_DIR}/apps/limber/pages/${page}.html found REGEX "<meta name=\"limber-sources\"")
  if(NOT found MATCHES "content=\"${expected}\"")
    message(SEND_ERROR "apps/limber/pages/${page}.html is not built from web/pages as they are: run ./dev pages")
  endif()
endforeach()
