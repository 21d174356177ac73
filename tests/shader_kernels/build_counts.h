#pragma once
#include "hand_counts.h"

namespace kernels {

/// Operations of the kernels that build and refit trees or pose geometry, counted by hand from their sources.
inline constexpr Hand kBuildByHand[] = {
    // Operations: 4 (3 min or max).
    {"build_leaf", {0, 0, 0, 12, 0, 0, 1, 0, 2, 2, 0}},
    // Operations: vector add; 3 min, 3 max.
    {"bound_centres", {3, 0, 0, 6, 0, 0, 0, 0, 1, 1, 0}},
    {"bound_batches", {0, 0, 0, 6, 0, 0, 0, 0, 1, 1, 0}},
    // Operations: vector sub, largest; less, div, select.
    {"make_grid", {3, 0, 1, 2, 1, 1, 0, 0, 1, 1, 0}},
    // Operations: 2 vector add or sub, 3 mul; 3 (max, min, to_int, 4 (shift, or, and)); 2 shift, 2 or; add.
    {"morton_code", {6, 3, 0, 6, 0, 0, 41, 3, 1, 1, 0}},
    // Operations: shift, and; add.
    {"sort_histogram", {0, 0, 0, 0, 0, 0, 3, 0, 2, 1, 0}},
    // Operations: to_float, add, to_int.
    {"sort_scan", {1, 0, 0, 0, 0, 0, 0, 2, 1, 1, 0}},
    {"sort_scatter", {0, 0, 0, 0, 0, 0, 3, 0, 2, 2, 0}},
    // Operations: 2 equal, 2 (select, add or sub); 2 xor, less, 3 select.
    {"link_node", {0, 0, 0, 0, 3, 5, 4, 0, 5, 1, 0}},
    // Operations: 3 min, 3 max.
    {"fit_node", {0, 0, 0, 6, 0, 0, 0, 0, 3, 1, 0}},
    {"encode_node", {0, 0, 0, 0, 0, 0, 0, 0, 3, 1, 0}},
    {"encode_leaf", {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1}},
    // Operations: as build_leaf.
    {"refit_leaf", {0, 0, 0, 12, 0, 0, 0, 0, 2, 2, 0}},
    // Operations: shift, add; 3 min, 3 max.
    {"refit_node", {0, 0, 0, 6, 0, 0, 2, 0, 3, 2, 0}},
    // Operations: 2 and, 2 shift; 4 (3 scale, 3 vector add, scale), 3 vector add.
    {"skin_vertex", {45, 48, 0, 0, 0, 0, 4, 0, 6, 1, 0}},
    // Operations: 3 scale, 3 vector add.
    {"pose_vertex", {9, 9, 0, 0, 0, 0, 0, 0, 1, 1, 0}},
    // Operations: 3 (6 mul, 3 sub); dot, div; 3 scale, less, select, 3 (dot, neg), abs.
    {"pose_instance", {17, 39, 1, 4, 1, 1, 0, 0, 1, 1, 0}},
    // Operations: 6 scale; 2 (9 min or max, 3 vector add).
    // Operations: 7 (less, 3 select) but the last area; 2 (vector sub, 3 mul, 2 add, shift, equal, select); 8 (2 equal,
    // 4 select); add.
    {"collapse_node", {10, 6, 0, 0, 25, 54, 3, 0, 5, 1, 0}},
    {"encode_child", {0, 0, 0, 0, 0, 0, 0, 0, 2, 1, 0}},
    // Operations: 2 (vector sub, 3 mul); 3 (2 floor, 2 neg, 2 (max, min, to_int), shift, or).
    {"quantise_child", {6, 6, 0, 24, 0, 0, 6, 6, 3, 1, 0}},
    {"bound_instance", {18, 18, 0, 18, 0, 0, 0, 0, 2, 1, 0}},
};

}  // namespace kernels
