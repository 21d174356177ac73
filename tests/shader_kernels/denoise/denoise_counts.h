#pragma once
#include "tests/shader_kernels/hand_counts.h"

namespace kernels {

// Operations of the denoiser's kernels, counted by hand from their sources. graphs_test.cc explains the short names.
//
//   half            min, mul, add, shift; back: shift, and, mul
//   light, moments  4 or 2 halves; shift and or for each pair
//   luminance       3 mul 2 add
//   project         3 dots, div, 2 mul                     6 add 11 mul 1 div
//   normal          3 bytes, to_float                      5 integer 3 convert; packed 3 (mul, add, to_int), 4 integer
inline constexpr Hand kDenoiseByHand[] = {
    // Operations: 2 project, 2 sub; compare, select.
    {"clear_guides", {14, 22, 2, 0, 1, 1, 0, 0, 2, 1, 0}},
    // Operations: 2 vector sub, 2 project, 2 sub, div, max.
    {"record_guide", {20, 22, 3, 1, 0, 0, 0, 0, 4, 1, 0}},
    // And, int_mul, 2 int_add; weights, 3 interpolate more.
    {"record_moving_guide", {28, 31, 3, 1, 0, 0, 4, 0, 5, 1, 3}},
    // Operations: to_float, div_mod, compare, to_int; 6 (max, min, select, add, mul); 3 (mul, max, select, add,
    // to_int); 3 (to_float, mul, div); 2 (mul, add, max, min, to_int), shift, or; largest, compare; select, vector *
    // scalar; light, normal; 2 shift, 2 or.
    {"split_light", {16, 26, 3, 26, 2, 10, 22, 13, 2, 4, 0}},
    {"split_light_float", {16, 22, 3, 22, 2, 10, 10, 13, 2, 4, 0}},
    // Lattice_sample instead of div_mod, compare, to_int; without 6 (select, add, mul).
    {"split_grid_light", {12, 22, 3, 26, 1, 4, 22, 13, 2, 4, 0}},
    {"split_grid_light_float", {12, 18, 3, 22, 1, 4, 10, 13, 2, 4, 0}},
    // Operations: light; to_float, div_mod; and, shift; 2 (to_float, sub, mul, 2 add); 2 (floor, sub), 4 sub, 4 add;
    // mul, normal. 4 taps: 4 compare, 3 and; mul, add, select, to_int; light without its fourth value, moments, normal;
    // shift, to_float; vector sub, dot, 2 compare, sub, abs, mul; compare, 3 and; mul, select. Sums: mul; 3 (5 sub, 5
    // mul, mul, 2 add), 2 (5 add). Compare, max, div, mul, select, 5 mul, 5 add. Add, floor, add, min, div, 2 max; 3
    // sub, 3 mul, 3 add; luminance, sub, 4 mul, add, sub, mul; 5 select; mul, add, sqrt; light, moments; to_int, shift,
    // or.
    {"accumulate_history", {96, 96, 3, 18, 29, 14, 123, 27, 3, 3, 12}},
    {"accumulate_history_float", {96, 66, 3, 12, 29, 14, 57, 27, 3, 3, 12}},
    {"unpack_taps", {0, 4, 0, 0, 0, 0, 13, 3, 2, 2, 0}},
    {"unpack_taps_float", {0, 0, 0, 0, 0, 0, 5, 3, 2, 2, 0}},
    // The first iteration: as later ones, but per tap decay, and, select, 2 mul, 4 add more; 2 div, sub, 3 mul, max; a
    // load, to_int, shift, to_float, compare, div, mul, 2 select, mul.
    {"filter_first_light", {827, 942, 62, 72, 21, 72, 79, 28, 51, 1, 0}},
    // Operations: to_float, div_mod; mul, 2 add. 10 steps: 2 mul, add, 2 compare, and, select. 25 taps: 2 add, to_int.
    // Depths: 4 (sub, abs, select), 2 min; 12 mul, 4 add; mul, 8 (add, div). Luminance; 24 (4 sub, abs, 2 mul, dot,
    // add, luminance, sub). Variance: 8 (mul, sub, max; mul, and, select, add, mul, add), mul, div. Max, sqrt,
    // div. 24 taps: abs, mul, add, decay; and, mul, select; 3 (sub, mul, add), mul, add, mul, add; less 3 add. Div, 3
    // (mul, add, max), 2 mul, light.
    {"filter_light", {658, 649, 36, 71, 20, 46, 54, 26, 50, 1, 0}},
    // Unpacks 25 lights and normals.
    {"filter_stored_light", {658, 749, 36, 71, 20, 46, 379, 101, 0, 1, 50}},
    {"filter_first_light_float", {827, 938, 62, 68, 21, 72, 67, 28, 51, 1, 0}},
    {"filter_light_float", {658, 645, 36, 67, 20, 46, 42, 26, 50, 1, 0}},
    {"filter_stored_light_float", {658, 645, 36, 67, 20, 46, 167, 101, 0, 1, 50}},
    // Operations: 3 halves, 3 bytes, 3 (to_float, mul, mul), clamped.
    {"modulate_albedo", {0, 9, 0, 6, 0, 0, 11, 3, 2, 1, 0}},
    {"modulate_albedo_float", {0, 6, 0, 6, 0, 0, 5, 3, 2, 1, 0}},
};

}  // namespace kernels
