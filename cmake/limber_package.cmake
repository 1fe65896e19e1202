# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What `cmake --install` adds to headers and libraries, so that find_package(limber) works.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(LIMBER_CMAKE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/limber)
if(LIMBER_INSTALL)
  configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/limberConfig.cmake.in ${PROJECT_BINARY_DIR}/limberConfig.cmake
    INSTALL_DESTINATION ${LIMBER_CMAKE_FOLDER})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/limberConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/limberConfig.cmake ${PROJECT_BINARY_DIR}/limberConfigVersion.cmake
    DESTINATION ${LIMBER_CMAKE_FOLDER})
endif()
