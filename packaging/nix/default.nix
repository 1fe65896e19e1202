# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# nix-build packaging/nix
{ pkgs ? import <nixpkgs> { } }:
pkgs.stdenv.mkDerivation {
  pname = "limber";
  version = "1.0.0";
  src = builtins.filterSource (path: type: !builtins.elem (baseNameOf path) [ ".git" "build" ]) ../..;
  nativeBuildInputs = [ pkgs.cmake pkgs.ninja ];
  buildInputs = [ pkgs.boost pkgs.cli11 pkgs.fmt pkgs.libhwy pkgs.nlohmann_json pkgs.onetbb ];
  cmakeFlags = [ "-DBUILD_SHARED_LIBS=ON" "-DLIMBER_FETCH=OFF" ];
  doInstallCheck = true;
  installCheckPhase = "$out/bin/limber distance scene:square scene:ball --pose-b 0,0,3,1,0,0,0";
  meta = {
    description = "Collision and distance for triangle meshes that deform";
    license = pkgs.lib.licenses.bsd3;
    mainProgram = "limber";
  };
}
