// SPDX-License-Identifier: MIT
// All that GLSL and C++ share, for C++. Shaders include the parts that they read.
#pragma once
#include "interface/bindings.h"
#include "interface/counters.h"
#include "interface/deform.h"
#include "interface/dispatch.h"
#include "interface/frame.h"
#include "interface/hierarchy.h"
#include "interface/rays.h"
#include "interface/scene.h"
#include "interface/shading.h"
#include "interface/types.h"
