// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Everything of the core library; mesh files are in limber/io.h.
#include "limber/base.h"
#include "limber/classic.h"
#include "limber/contact_reduction.h"
#include "limber/contacts.h"
#include "limber/elements.h"
#include "limber/function_ref.h"
#include "limber/geometry.h"
#include "limber/math.h"
#include "limber/mesh.h"
#include "limber/model.h"
#include "limber/neighbor_rings.h"
#include "limber/points.h"
#include "limber/query.h"
#include "limber/reference.h"
#include "limber/scene.h"
