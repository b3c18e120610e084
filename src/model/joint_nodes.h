// Joints as the nodes of a graph: two are linked where they share a body that can give way, neither
// the ground nor the driven body. A joint may be several nodes.
#pragma once

#include "base/sparse_order.h"
#include "model/linkage.h"

// The body of a side of a joint, or LINKAGE_GROUND where it cannot give way.
int joint_nodes_mover(const Linkage *linkage, int joint, int side);

// Lists the nodes of each body, given the joint of each node: those of body i are from first[i] to
// first[i + 1]. There is room for one number more than bodies in `first`, all zero, and for two
// numbers a node in `nodes`.
void joint_nodes_list(const Linkage *linkage, const int *joints, size_t count, size_t *first,
                      size_t *nodes);

// Makes a list of all links, which free() gives back. Two nodes that share two bodies are linked
// twice. Returns how many links there are.
size_t joint_nodes_link(const Linkage *linkage, const int *joints, size_t count,
                        SparseLink **links);
