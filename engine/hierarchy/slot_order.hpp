// SPDX-License-Identifier: MIT
// Which of a node's eight slots a child takes: that of the octant it lies in, seen from the node's middle, so that a
// ray visits slot ^ octant(direction) in ascending order and comes to near children first without sorting them (Ylitie,
// Karras, Laine, HPG 2017, section 3.2).
#pragma once

#include "hierarchy/object_hierarchy.hpp"

namespace sheaf {

/// Permutes children and their boxes; empty children end up anywhere. Slot bit 0 set: on the high x side; 1: y; 2: z.
void order_slots(WideNode& node);

}  // namespace sheaf
