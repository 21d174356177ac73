#pragma once
#include "tests/shader_kernels/hand_counts.h"

namespace kernels {

// Operations of the kernels of effects, counted by hand from their sources. graphs_test.cc explains the short names.
//
//   random_point_in_square  3 (bits, mul), 3 xor; 2 (scrambled, shift, to_float, mul, add, floor, sub), xor
//                                                    4 add  2 mul 2 other 25 integer 2 convert
//   sin_half_turns         mul, abs, sub, mul; abs, mul, add, mul
//                                                    2 add  4 mul 2 other
//   map_to_disc         mul, sub, add; sqrt; compare, sub, select; 2 (sin_half_turns, mul)
//                                                    7 add 11 mul 1 div_sqrt 4 other 1 compare 1 select
//   perpendicular   compare, select; add, div; 2 mul; mul; 2 mul, add, mul, neg; 2 mul, add, neg
//                                                    3 add  8 mul 1 div_sqrt 2 other 1 compare 1 select
inline constexpr Hand kEffectsByHand[] = {
    // Operations: diffuse_light; 2 max, compare, 3 select, add_light.
    {"shade_open", {14, 31, 2, 6, 1, 3, 0, 0, 5, 1, 0}},
    // Operations: shade_diffuse; random_point_in_square, map_to_disc; 2 scale, 2 vector add; mul, max; scale.
    {"shade_soft", {29, 55, 3, 13, 2, 2, 26, 2, 5, 2, 0}},
    // Operations: 6 mul; random_point_in_square, map_to_disc, perpendicular_axes; 3 scale, 2 vector add, sub, sqrt; 2
    // max, compare, next.
    {"cast_occlusion", {21, 36, 3, 10, 3, 3, 26, 2, 5, 2, 0}},
    // Operations: lattice_sample.
    {"clear_effects", {4, 4, 0, 1, 0, 0, 0, 2, 0, 2, 0}},
    // As generate_shaded_rays.
    {"generate_centred_rays", {18, 18, 2, 3, 0, 0, 0, 3, 0, 4, 0}},
    // Operations: to_float, div_mod; 2 (add, to_int); or (xor), and, compare, next.
    {"select_effects", {4, 2, 0, 1, 1, 1, 3, 3, 2, 1, 0}},
    {"select_effects_checkerboard", {4, 2, 0, 1, 1, 1, 3, 3, 2, 1, 0}},
    // As shade_soft, but rays return only their share of the light.
    {"shade_soft_share", {29, 52, 3, 13, 2, 2, 26, 2, 5, 2, 0}},
    {"cast_occlusion_share", {21, 36, 3, 10, 3, 3, 26, 2, 5, 2, 0}},
    {"combine_ratio", {4, 0, 0, 0, 1, 3, 0, 0, 3, 1, 0}},
    // Operations: to_float, div_mod; mul, 2 add, to_int; add; 2 compare, select, div; scale, 3 select; 3 select, 3 mul;
    // add_light. 2 (add, to_int, and, to_float, neg); 4 steps (add, 2 compare, and, select), 2 mul. For each of 4 taps
    // 2 add, and; to_int, add; a weight of reconstruct (9 add 15 mul 1 div 2 other 1 1); max, mul, select; 3 mul, 4
    // add.
    {"upsample_effects", {73, 87, 5, 15, 14, 19, 15, 10, 12, 1, 0}},
    // Without 2 (add, to_int, and, to_float, neg); of a tap's steps one.
    {"upsample_effects_checkerboard", {67, 87, 5, 13, 14, 19, 9, 6, 12, 1, 0}},
};

}  // namespace kernels
