#pragma once
#include "tests/shader_kernels/hand_counts.h"

namespace kernels {

// Operations of the kernels of paths, rough reflections and bounces, counted by hand from their sources. graphs_test.cc
// and effects_counts.h explain the short names.
//
//   bounce_key          add, scrambled                                       9 integer
//   random_number       add, scrambled, shift, to_float, mul                 1 mul 10 integer 1 convert
//   see_light           diffuse_light without 9 mul                          11 add 22 mul 2 div_sqrt 4 other
//   choose_light        bounce_key, random_number, mul, floor, sub, min, to_int, see_light
//                                                   12 add 24 mul 2 div_sqrt 6 other 19 integer 2 convert
//   emit_light_ray      3 mul; max, mul; 3 mul, 3 mul; 2 max, compare, next; mul, sub
//                                                   1 add 11 mul 3 other 1 compare 1 select 1 integer
//   on a disc           2 random_number, map_to_disc, 2 scale, 2 vector add, mul, max; and no more
//                                                   13 add 20 mul 1 div_sqrt 5 other 1 compare 1 select 20 integer
//                                                   2 convert
//   alpha_of            shift, to_float, 2 mul                               2 mul 1 integer 1 convert
//   schlick_share       sub, max, 3 mul                                      1 add  3 mul 1 other
//   schlick_reflectance vector sub, schlick_share, scale, vector add         7 add  6 mul 1 other
//   hidden_facets       mul, mul, div, sub, mul, add, sqrt, mul, sub         3 add  4 mul 2 div_sqrt
//   scatter_by_facets   vector sub, normalised; dot, mul; mul, sub, mul, add; max; 2 hidden_facets, 2 add; 5 mul, div;
//                       dot, neg, schlick_reflectance, scale                 26 add 37 mul 7 div_sqrt 4 other
//   circle_point        mul, sub, abs, sub, min; 2 (6 mul, 4 add); sub, mul; compare, neg, select, mul
//                                                   11 add 15 mul 3 other 1 compare 1 select
//   reflect_by_facet    perpendicular; 3 (dot, neg), max; 2 mul, normalised; sub, add, mul, sub; mul, sub, max, sqrt,
//                       circle_point; 2 (add, mul), add, max, normalised; dot; mul, scale, vector sub; hidden_facets,
//                       add; max, hidden_facets, add, div; schlick_reflectance, compare, select, scale; 3 scale, 2
//                       vector add, normalised      59 add 89 mul 13 div_sqrt 16 other 3 compare 3 select
inline constexpr Hand kPathByHand[] = {
    // Operations: to_float, 2 div_mod, 2 add; 2 to_int, mul, add; xor, scrambled, to_int, add, scrambled.
    {"seed_paths", {6, 4, 0, 2, 0, 0, 20, 4, 0, 1, 0}},
    {"keep_visible", {0, 0, 0, 0, 1, 1, 1, 0, 1, 1, 0}},
    // Operations: 2 (and, compare, next).
    {"classify_lit", {0, 0, 0, 0, 2, 2, 4, 0, 2, 2, 0}},
    // Operations: choose_light, emit_light_ray.
    {"sample_light", {13, 35, 2, 9, 1, 1, 20, 2, 6, 2, 0}},
    {"sample_light_soft", {26, 55, 3, 14, 2, 2, 40, 4, 7, 2, 0}},
    // Besides: dot, neg, max; scale, alpha_of, scatter_by_facets; schlick_share, sub, scale, vector add.
    {"sample_light_rough", {46, 86, 9, 16, 1, 1, 21, 3, 8, 2, 0}},
    {"sample_light_rough_soft", {59, 106, 10, 21, 2, 2, 41, 5, 9, 2, 0}},
    // Operations: bounce_key, interface; mul, vector add; 2 max, sub, mul; 3 mul, 2 max, add; sub, mul, scale, 3 mul, 2
    // max, add; 3 mul, 2 max, add; random_number, mul, 3 compare, 3 (sub, select); max, min, random_number, 2 compare,
    // and; mul, max, div, scale; compare, and; 4 (and, next), 2 compare, and.
    {"choose_lobe", {21, 33, 4, 13, 10, 9, 40, 2, 7, 5, 0}},
    // Besides: and, compare, schlick_share, select; vector sub, scale, vector add; sub, scale; compare, and, and, next;
    // compare, and.
    {"choose_lobe_rough", {29, 42, 4, 14, 13, 11, 45, 2, 7, 6, 0}},
    // Operations: bounce_key, 2 random_number, sqrt, circle_point, perpendicular; 3 scale, 2 vector add, sub, sqrt,
    // normalised; 3 mul; 2 max, compare, next.
    {"scatter_diffuse", {23, 43, 5, 8, 3, 3, 30, 2, 5, 2, 0}},
    // Besides: dot, neg; and, compare, schlick_share, select, sub, scale.
    {"scatter_diffuse_rough", {27, 52, 5, 10, 4, 4, 31, 2, 6, 2, 0}},
    // Operations: bounce_key, 2 random_number, alpha_of, reflect_by_facet; 3 mul; 2 max, compare, next.
    {"scatter_rough", {59, 96, 13, 18, 4, 4, 31, 3, 7, 2, 0}},
    // As average_colour.
    {"average_paths", {5, 5, 0, 7, 1, 3, 0, 2, 1, 1, 0}},
    // As shade_physical; 2 compare, and; 3 select, mul; mul, add, to_int, shift, select; or.
    {"shade_physical_rough", {36, 39, 1, 17, 10, 13, 28, 13, 8, 2, 2}},
    {"shade_physical_rough_mip", {36, 40, 1, 19, 10, 14, 32, 13, 9, 2, 2}},
    {"shade_physical_rough_trilinear", {67, 62, 1, 29, 15, 19, 57, 25, 11, 2, 3}},
    // As shade_mirror; random_point_in_square, alpha_of, reflect_by_facet; and, compare, 6 select.
    {"reflect_rough", {79, 112, 16, 22, 7, 12, 28, 3, 7, 2, 0}},
    // Operations: random_point_in_square, map_to_disc, perpendicular; 3 scale, 2 vector add, sub, sqrt, normalised;
    // add;
    // compare, next.
    {"cast_bounce", {23, 36, 5, 9, 3, 3, 27, 2, 4, 4, 0}},
    // Operations: lattice_sample; add; compare, 3 select.
    {"take_bounce", {4, 4, 0, 1, 1, 3, 1, 2, 2, 1, 0}},
};

}  // namespace kernels
