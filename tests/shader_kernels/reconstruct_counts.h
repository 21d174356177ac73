#pragma once
#include "hand_counts.h"

namespace kernels {

/// Operations of the kernels of `reconstruct`, counted by hand from their sources. For short names see graphs_test.cc.
inline constexpr Hand kReconstructByHand[] = {
    // Operations: to_float, 3 div_mod; add, mul; 2 (sub or add, mul), 2 (2 add); emit_primary_ray.
    {"generate_rotated_rays", {21, 21, 2, 4, 0, 0, 0, 1, 0, 3, 0}},
    // Operations: lattice_sample, and for the ray (14 14 2 2, 1 convert) to_float, div_mod; 2 (2 add); 2 scale, 2
    // vector add, normalised. Of the others to_float, div_mod, to_int; add; 2 add, less, select, sub; 2 (mul, add);
    // mul, to_int, add.
    {"generate_shaded_rays", {18, 18, 2, 3, 0, 0, 0, 3, 0, 4, 0}},
    {"generate_visible_rays", {26, 23, 2, 4, 1, 1, 1, 6, 0, 3, 0}},
    {"clear_branch", {4, 4, 0, 1, 0, 0, 3, 2, 0, 5, 0}},
    {"begin_branch", {0, 0, 0, 0, 0, 0, 1, 0, 1, 2, 0}},
    {"record_visible", {5, 3, 0, 0, 0, 0, 0, 0, 3, 1, 0}},
    {"record_branch_visible", {0, 1, 0, 0, 0, 0, 0, 0, 4, 1, 0}},
    {"record_visible_shadow", {0, 0, 0, 0, 1, 1, 1, 0, 3, 1, 0}},
    // Operations: lattice_sample, 3 min; for each branch add, vector add, 3 min, vector sub.
    {"limit_colours", {4, 4, 0, 4, 0, 0, 0, 2, 1, 1, 0}},
    {"limit_colours_branch", {10, 4, 0, 7, 0, 0, 1, 2, 2, 2, 0}},
    {"limit_colours_branches", {16, 4, 0, 10, 0, 0, 2, 2, 3, 3, 0}},
    // Operations: to_float, div_mod; mul, 2 add; add, to_int; 4 less, 3 add, 3 or; next.
    {"list_branches", {5, 3, 0, 1, 4, 1, 7, 2, 4, 1, 0}},
    // Operations: to_float, div_mod; mul, 2 add; to_int, 3 add. Steps, 2 r each way: add, 2 less, and, select; those
    // along y mul.
    // A weight: sub, mul; dot, max, min, sub, mul, mul; add, decay, equal, select    9 add 15 mul 1 div 2 other 1 1
    //   4 of them for each of the 8 (24) others, whose steps take 1 or 2 add, and; to_int, select; and 3.
    // Shares: 4 x 8 (24) add; 3 (less, 2 select); 4 div. Colours: 4 mul, 3 add; 3 mul; 8 (24) vector add.
    {"reconstruct", {418, 593, 39, 71, 46, 53, 11, 10, 21, 1, 0}},
    {"reconstruct_wide", {1186, 1667, 103, 199, 118, 137, 27, 26, 53, 1, 0}},
    // Operations: and add; 4 (less, select); vector add.
    {"reconstruct_branch", {422, 593, 39, 71, 50, 57, 11, 10, 23, 1, 0}},
    {"reconstruct_branch_wide", {1190, 1667, 103, 199, 122, 141, 27, 26, 55, 1, 0}},
    // Operations: to_float, div_mod; mul, 2 add; steps as above; to_int. For each of 8 others 1 or 2 add, and; to_int,
    // select; sub, mul; dot, max, min, sub, mul, mul; equal; add, less, and; 3 (select, min, max). Contrasts, of 3
    // channels: 2 (max, min, encode), sub, add, max, div; mul, less; 2 or. To encode is 2 add, 4 mul, 3 sqrt, less,
    // select. Next.
    {"list_contrasts", {78, 80, 21, 80, 33, 43, 19, 10, 18, 1, 0}},
    {"list_contrasts_branch", {149, 155, 42, 159, 58, 81, 34, 19, 36, 1, 0}},
    {"list_contrasts_branches", {220, 230, 63, 238, 83, 119, 49, 28, 54, 1, 0}},
    // As generate_visible_rays, with to_float, div_mod, mul, 2 add in place of lattice_sample.
    {"generate_contrast_rays", {26, 22, 2, 4, 1, 1, 1, 6, 1, 3, 0}},
    // Operations: to_float, div_mod; mul, 2 add; to_int. 3 (add, 3 (max, min, add)); 3 mul. For each branch add, vector
    // add.
    {"average_contrasts", {13, 6, 0, 19, 0, 0, 3, 2, 5, 1, 0}},
    {"average_contrasts_branch", {16, 6, 0, 19, 0, 0, 4, 2, 6, 1, 0}},
    {"average_contrasts_branches", {19, 6, 0, 19, 0, 0, 5, 2, 7, 1, 0}},
};

}  // namespace kernels
