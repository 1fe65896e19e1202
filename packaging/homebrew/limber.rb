# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Of the archive that ./dev release makes. Homebrew takes a recipe outside a tap from developers alone:
# HOMEBREW_DEVELOPER=1 brew install --formula packaging/homebrew/limber.rb
class Limber < Formula
  desc "Collision and distance for triangle meshes that deform"
  url "file://#{File.expand_path("../../build/publish/limber-1.0.0.tar.gz", __dir__)}"
  license "BSD-3-Clause"

  depends_on "boost" => :build
  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "nlohmann-json" => :build
  depends_on "fmt"
  depends_on "highway"
  depends_on "tbb"

  def install
    system "cmake", "-S", ".", "-B", "build", "-DBUILD_SHARED_LIBS=ON", "-DLIMBER_FETCH=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    answer = shell_output("#{bin}/limber distance scene:square scene:ball --pose-b 0,0,3,1,0,0,0")
    assert_match "exact", answer
  end
end
