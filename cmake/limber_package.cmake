# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What `cmake --install` brings: libraries, headers, the packages of CMake and pkg-config, and the program with its manual.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/limber)
set(pkgconfig_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# The loader searches the folders of the system by itself, so nothing installed below /usr names a folder. Elsewhere the
# program names that of the libraries, relative to its own: a tree works wherever it is. Libraries never do. Whoever links
# limber_io links limber too, and the loader takes the one that is there.
set(run_path)
if(BUILD_SHARED_LIBS AND NOT CMAKE_INSTALL_PREFIX MATCHES "^/(usr/?)?$")
  file(RELATIVE_PATH libraries_from_programs /prefix/${CMAKE_INSTALL_BINDIR} /prefix/${CMAKE_INSTALL_LIBDIR})
  set(own_folder $ORIGIN)
  if(APPLE)
    set(own_folder @loader_path)
  endif()
  set(run_path ${own_folder}/${libraries_from_programs})
endif()

# limber_install_library(TARGET EXPORT HEADER...)
function(limber_install_library target export)
  install(TARGETS ${target} EXPORT ${export})
  install(FILES ${ARGN} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/limber)
  install(EXPORT ${export} NAMESPACE limber:: DESTINATION ${cmake_folder})
endfunction()

# limber_install_pkgconfig(NAME DESCRIPTION LIBRARY REQUIRES)
function(limber_install_pkgconfig name description library requires)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/limber.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${pkgconfig_folder})
endfunction()

# Places are written relative to the file, so that a tree can be installed anywhere and moved.
if(IS_ABSOLUTE ${CMAKE_INSTALL_LIBDIR} OR IS_ABSOLUTE ${CMAKE_INSTALL_INCLUDEDIR})
  set(pkgconfig_prefix ${CMAKE_INSTALL_PREFIX})
  set(pkgconfig_libraries ${CMAKE_INSTALL_FULL_LIBDIR})
  set(pkgconfig_headers ${CMAKE_INSTALL_FULL_INCLUDEDIR})
else()
  file(RELATIVE_PATH up /prefix/${pkgconfig_folder} /prefix)
  string(REGEX REPLACE "/$" "" up "${up}")
  set(pkgconfig_prefix "\${pcfiledir}/${up}")
  set(pkgconfig_libraries "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
  set(pkgconfig_headers "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
endif()

file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/limber/*.h)
set(io_headers ${PROJECT_SOURCE_DIR}/include/limber/io.h)
list(REMOVE_ITEM headers ${io_headers})
limber_install_library(limber limberTargets ${headers})
# Whoever links the static library links what that needs; the shared one brings it along, and no header shows it. It is
# not named as Requires.private: pkg-config would want its headers to be installed.
set(linked libhwy)
if(LIMBER_THREADS)
  set(linked "tbb, libhwy")
endif()
if(BUILD_SHARED_LIBS)
  limber_install_pkgconfig(limber "${PROJECT_DESCRIPTION}" limber "")
else()
  set(definitions " -DLIMBER_STATIC")
  limber_install_pkgconfig(limber "${PROJECT_DESCRIPTION}" limber "${linked}")
endif()
if(TARGET limber_io)
  limber_install_library(limber_io limberIoTargets ${io_headers})
  limber_install_pkgconfig(limber-io "Mesh files for limber" limber_io "limber = ${PROJECT_VERSION}")
endif()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/limberConfig.cmake.in ${PROJECT_BINARY_DIR}/limberConfig.cmake
  INSTALL_DESTINATION ${cmake_folder} NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# docs/guide/install.md, "Versions".
write_basic_package_version_file(${PROJECT_BINARY_DIR}/limberConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/limberConfig.cmake ${PROJECT_BINARY_DIR}/limberConfigVersion.cmake
  DESTINATION ${cmake_folder})

# The licenses of what is compiled in; reports of the program have libraries of their own inside.
file(READ ${PROJECT_SOURCE_DIR}/packaging/NOTICES.txt notices)
if(TARGET limber_program)
  file(READ ${PROJECT_SOURCE_DIR}/clients/program/pages/viewer.html page)
  string(REGEX MATCH "id=\"notices\">\n([^<]*)" page "${page}")
  string(APPEND notices "\nReports of the program contain:\n\n${CMAKE_MATCH_1}")
endif()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/NOTICES.txt CONTENT "${notices}" @ONLY)
# Not CMAKE_INSTALL_DOCDIR: that is named after whichever project asked for these folders first.
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_BINARY_DIR}/NOTICES.txt
  DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/limber)
if(TARGET limber_program)
  set_target_properties(limber_program PROPERTIES INSTALL_RPATH "${run_path}")
endif()
