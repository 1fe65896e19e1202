// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// This header brings what most programs need. Beside it stand io.h for mesh files and eigen.h for matrices of Eigen.
#include "limber/base.h"
#include "limber/contacts.h"
#include "limber/convex.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "limber/geometry.h"
#include "limber/gradients.h"
#include "limber/math.h"
#include "limber/mesh.h"
#include "limber/model.h"
#include "limber/motion.h"
#include "limber/path.h"
#include "limber/penetration.h"
#include "limber/points.h"
#include "limber/scene.h"
#include "limber/shapes.h"
#include "limber/solids.h"
#include "limber/version.h"
