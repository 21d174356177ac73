#pragma once
#include "tests/shader_kernels/hand_counts.h"

namespace kernels {

// Kernels of effects, counted by hand as those of graphs_test.cc are.
//
//   drawn           3 (bits, mul), 3 xor; 2 (scrambled, shift, to_float, mul, add, floor, sub), xor
//                                                    4 add  2 mul 2 other 25 integer 2 convert
//   sine_of         mul, abs, sub, mul; abs, mul, add, mul
//                                                    2 add  4 mul 2 other
//   on_disc         mul, sub, add; sqrt; compare, sub, select; 2 (sine_of, mul)
//                                                    7 add 11 mul 1 div_sqrt 4 other 1 compare 1 select
//   across          compare, select; add, div; 2 mul; mul; 2 mul, add, mul, neg; 2 mul, add, neg
//                                                    3 add  8 mul 1 div_sqrt 2 other 1 compare 1 select
inline constexpr Hand kEffectsByHand[] = {
    // Diffuse_light; 2 max, compare, 3 select, add_light.
    {"shade_open", {14, 31, 2, 6, 1, 3, 0, 0, 5, 1, 0}},
    // Shade_diffuse; drawn, on_disc; 2 scale, 2 vector add; mul, max; scale.
    {"shade_soft", {29, 55, 3, 13, 2, 2, 26, 2, 4, 2, 0}},
    // 6 mul; drawn, on_disc, across; 3 scale, 2 vector add, sub, sqrt; 2 max, compare, next.
    {"cast_occlusion", {21, 36, 3, 10, 3, 3, 26, 2, 4, 2, 0}},
};

}  // namespace kernels
