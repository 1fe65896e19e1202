# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Whether the pages in apps/limber/pages are built from the sources in web/pages, as far as can be told without npm: each
# names the digest of its sources, as web/pages/build.mjs computes it. And whether each has the license of what is inside,
# in full. Run by cmake -DSOURCE_DIR=... -P.
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

# limber_expect_license(PAGE MARK OWNER...): the page names these owners if its text has the mark, which only a library has.
function(limber_expect_license page mark)
  file(READ ${SOURCE_DIR}/apps/limber/pages/${page}.html text)
  string(FIND "${text}" "${mark}" is_inside)
  string(REGEX MATCH "<script type=\"text/plain\" id=\"notices\">[^<]*" notices "${text}")
  foreach(owner IN LISTS ARGN)
    string(FIND "${notices}" "${owner}" place)
    string(FIND "${notices}" "to permit persons to" permission)
    if(NOT is_inside EQUAL -1 AND (place EQUAL -1 OR permission EQUAL -1))
      message(SEND_ERROR "apps/limber/pages/${page}.html has the code of ${owner} inside, but not its license")
    endif()
  endforeach()
endfunction()

foreach(page report replay live)
  file(STRINGS ${SOURCE_DIR}/apps/limber/pages/${page}.html found REGEX "<meta name=\"limber-sources\"")
  if(NOT found MATCHES "content=\"${expected}\"")
    message(SEND_ERROR "apps/limber/pages/${page}.html is not built from web/pages as they are: run ./dev pages")
  endif()
  limber_expect_license(${page} "__THREE__" "three.js authors")
  limber_expect_license(${page} "u-legend" "Leon Sorokin")
  limber_expect_license(${page} "id=\"engine-module\"" "The Emscripten Authors" "Rich Felker" "Niels Lohmann")
endforeach()
