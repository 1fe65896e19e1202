# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Whether clients/program/pages/viewer.html is built from the sources in clients/pages, as far as can be told without npm: it
# names the digest of its sources, as clients/pages/build.mjs computes it. And whether it has the license of what is inside,
# in full. Run by cmake -DSOURCE_DIR=... -P.
cmake_minimum_required(VERSION 3.25)

set(folder ${SOURCE_DIR}/web/pages)
file(GLOB_RECURSE sources RELATIVE ${folder} ${folder}/viewer/* ${folder}/report/* ${folder}/replay/*
  ${folder}/study/* ${folder}/shared/*)
list(FILTER sources INCLUDE REGEX "\\.(ts|css|html)$")
list(APPEND sources build.mjs package-lock.json)
list(SORT sources)
set(lines "")
foreach(source ${sources})
  file(SHA256 ${folder}/${source} digest)
  string(APPEND lines "${digest} ${source}\n")
endforeach()
string(SHA256 expected "${lines}")

file(READ ${SOURCE_DIR}/clients/program/pages/viewer.html page)
if(NOT page MATCHES "<meta name=\"limber-sources\" content=\"${expected}\">")
  message(SEND_ERROR "clients/program/pages/viewer.html is not built from clients/pages as they are: run ./dev pages")
endif()

# limber_expect_license(MARK OWNER): the page has the code that only this owner's library has, and its license.
function(limber_expect_license mark owner)
  string(FIND "${page}" "${mark}" place)
  if(place EQUAL -1)
    message(SEND_ERROR "clients/program/pages/viewer.html has no ${mark}, by which the code of ${owner} is known")
  endif()
  string(REGEX MATCH "<script type=\"text/plain\" id=\"notices\">[^<]*" notices "${page}")
  foreach(words "${owner}" "to permit persons to")
    string(FIND "${notices}" "${words}" place)
    if(place EQUAL -1)
      message(SEND_ERROR "clients/program/pages/viewer.html has the code of ${owner} inside, but not its license")
    endif()
  endforeach()
endfunction()

limber_expect_license("__THREE__" "three.js authors")
limber_expect_license("u-legend" "Leon Sorokin")
