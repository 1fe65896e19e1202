# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""For Conan 2: conan create packaging/conan"""

from pathlib import Path

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain
from conan.tools.files import copy


class Limber(ConanFile):
    name = "limber"
    version = "1.0.0"
    description = "Collision and distance for triangle meshes that deform"
    license = "BSD-3-Clause"
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "program": [True, False], "system": [True, False]}
    # system: the libraries that limber needs are the system's, not Conan's.
    default_options = {"shared": False, "program": False, "system": False}

    def export_sources(self):
        root = Path(self.recipe_folder).parents[1]
        for part in ("CMakeLists.txt", "LICENSE", "cmake/*", "include/*", "src/*", "clients/program/*"):
            copy(self, part, root, self.export_sources_folder)

    def requirements(self):
        if self.options.system:
            return
        self.requires("highway/1.2.0")
        self.requires("onetbb/2021.12.0")
        self.requires("boost/1.86.0", options={"header_only": True})
        self.requires("nlohmann_json/3.11.3")
        if self.options.program:
            self.requires("cli11/2.4.2")
            self.requires("fmt/11.0.2")

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False
        toolchain.cache_variables["LIMBER_FETCH"] = False
        toolchain.cache_variables["LIMBER_BUILD_PROGRAM"] = bool(self.options.program)
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, str(Path(self.package_folder) / "licenses"))

    def package_info(self):
        # The CMake package is limber's own.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = ["lib/cmake/limber"]
        self.cpp_info.libs = ["limber_io", "limber"]
