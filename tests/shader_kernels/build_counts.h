#pragma once
#include "hand_counts.h"

namespace kernels {

/// Operations of the kernels that build trees, counted by hand from their sources.
inline constexpr Hand kBuildByHand[] = {
    // Operations: 4 (3 min or max); 2 vector add or sub, 3 mul; 3 (max, min, to_int, 3 (shift, or, and)); 2 shift, 2
    // or.
    {"build_leaf", {6, 3, 0, 18, 0, 0, 31, 3, 2, 2, 0}},
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
    {"encode_leaf", {0, 0, 0, 0, 0, 0, 0, 0, 3, 1, 0}},
};

}  // namespace kernels
