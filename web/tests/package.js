// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The package as ./dev web builds it.
export * from "../../build/web/limber3d/index.js";
