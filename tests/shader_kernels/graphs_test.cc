#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "build_counts.h"
#include "denoise/denoise_counts.h"
#include "effects/effects_counts.h"
#include "hand_counts.h"
#include "path/path_counts.h"
#include "reconstruct_counts.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"

namespace kernels {
namespace {

// Operations of each kernel, counted by hand from its source. Short names: normalised is unit_vector, scrambled
// scramble_bits, encoded encode_srgb, clamped clamp_to_unit, decay exp_negative, passed unpack_passed_sample, wraps
// crosses_texture_border, go_on continue_ray, interface make_interface, largest max_channel, contrast channel_contrast.
//
//   dot 3 mul 2 add | vector + vector 3 add | vector * scalar 3 mul | largest 2 max
//   normalised      dot, max, sqrt, div, 3 mul                            2 add  6 mul 2 div_sqrt 1 other
//   div_mod          add, mul, floor, mul, sub                             2 add  2 mul 1 other
//   scrambled       3 xor, 3 shift, 2 mul                                 8 integer
//   next            select, int_add                                       1 select 1 integer
//   add_light       load, 3 add, store                                    3 add
//   interpolate     3 mul 2 add (and 2 sub, once, for the weights)
//   has             and, compare; look_up: has, 2 select, sample
//   sample          2 neighbours (max min, mul floor mul sub, sub min, mul sub, floor, add, add, 2 compare, 2 select,
//                   sub, 2 to_int, sub); shift, add; 2 shift, 2 or          14 add  6 mul 10 other 4 compare 4 select
//                                                                           6 integer 4 convert
//   linear          3 (sub, mul, add), 4 (to_float, mul); 4 integer (red, alpha) or 8: 6 add 7 mul 4 convert
//   colour          3 of (3 (sub, mul, add), 4 loads); 4 + 8 + 8 integer    18 add  9 mul 20 integer 12 local loads
//   vertex_colour   4 of (3 (integer, to_float), interpolate, mul)          8 add 16 mul 12 integer 12 convert
//   decay           mul, 4 (mul, add), div, 4 mul                           4 add  9 mul 1 div_sqrt
//   fetch_layer     and; weights, 2 interpolate; compare, select; sample, linear; mul
//                                            26 add 20 mul 10 other 5 compare 5 select 11 integer 8 convert
//     with colours  has; 2 interpolate, 2 select; vertex_colour; mul
//   emit_primary_ray    2 scale, 2 vector add, normalised; 3 store             8 add 12 mul 2 div_sqrt 1 other
//   diffuse_light   scale, vector sub; dot, sqrt, div; dot, mul; dot, neg, mul; mul add max min; mul mul sub max;
//                   4 mul; 7 mul                                           11 add 31 mul 2 div_sqrt 4 other
//   encoded         3 sqrt, 3 mul add sub, compare, mul, select            2 add  4 mul 3 div_sqrt 1 compare 1 select
//   clamped         max, min                                               2 other
//   lattice_sample  to_float, div_mod; 2 (mul, add); to_int                 4 add  4 mul 1 other 2 convert
//   sample_neighbours  to_float, 2 div_mod; mul; 2 (mul, add); add, mul, add, to_int; to_int; mul, add, to_int; to_int;
//                   compare, add, compare, or                              10 add 9 mul 2 other 2 compare 1 integer
//                                                                           5 convert
//   write_verdict   select; 2 (compare, next); shift, or; 3 store          3 select 2 compare 4 integer
//   passed          and; shift, to_float, add; to_float; mul, sub, to_int; mul, add, to_int; mul
//                                                                           3 add  3 mul 2 integer 4 convert
//   lerp           sub, mul, add; of vectors three times that
//   lerp_colours   6 clamped, lerp                                       6 add  3 mul 12 other
//   lerp_geometry  2 lerp, normalised                                    14 add 12 mul 2 div_sqrt 1 other
//   fails           compare, select; where flags decide, and before it
//   wraps           2 (floor, sub); min, compare, sub, max, compare, and   3 add  4 other 2 compare 1 integer
//   object_of       and, compare, select, or                               1 compare 1 select 2 integer
//   add_samples     compare; 3 (select, clamped, add); to_int; 3 mul       3 add  3 mul 6 other 1 compare 3 select
//   go_on           next; mul, dot, sqrt, div; mul, 2 add                   4 add  5 mul 2 div_sqrt
//   interface       -dot, less, 1/ior, select; 3 mul 2 sub; sub add div; compare max sqrt select sub; mul;
//                   4 mul 3 sub              10 add 11 mul 3 div_sqrt 2 other 2 compare 2 select
//
//   generate_rays             to_float, 3 div_mod, 2 add, 2 (2 add, mul), emit_primary_ray
//   generate_jittered_rays    the same with 2 (shift, to_float, mul) for 0.5; 2 to_int, mul, add; xor; 3 scrambled;
//                             to_int, add; xor
//   classify_hits             2 (compare, next)
//   shade_background          3 mul, add_light
//   classify_layers           2 compare, and, next
//   test_alpha                fetch_layer; has, select, compare; go_on (of the vertex colour, alpha alone)
//   test_shadow               fetch_layer; compare, select; has, select; colour, 3 mul; sub; mul, scale, vector add;
//                             3 mul; 2 max, compare; go_on; with colours 3 mul more
//   scatter_layers            2 compare, and, next
//   shade_surface             and; weights; interpolate of vectors, normalised; dot, compare, select; scale; vector
//                             add; 2 scale; 2 interpolate
//   classify_details          8 (has, next)
//   absorb                    neg, max, mul; scale; 3 decay; 3 mul
//   fetch_vertices            and; weights; vertex_colour; 7 mul; 4 (interpolate, 3 to_float, sub, mul) with
//                             3 (1 + 2 + 2 + 1) integer; 2 interpolate
//   shade_base                look_up, colour, 6 mul, linear, mul
//   shade_physical            look_up, 2 linear; mul sub mul max min; mul; mul; sub mul add; add; compare, max, div,
//                             select; 2 scale, vector add; mul sub; sub mul, scale; mul; 2 (2 max, compare, select), 2
//                             or
//   shade_bump                look_up, 3 linear; 2 (mul sub mul), mul sub max; scale; cross 6 mul 3 sub; mul, 3 scale,
//                             2 vector add; 2 normalised; scale; dot, add, max; scale, vector sub
//   shade_blend               7 mul
//   classify_surfaces         5 (has, next)
//   shade_textured            sample, colour, 3 mul
//   shade_emission            3 mul, scale, add_light
//   shade_glow                look_up, colour; 6 mul, scale, add_light
//   shade_ambient             6 mul, add_light
//   shade_occluded            look_up, linear; sub, mul; 6 mul, scale, add_light
//   shade_diffuse             diffuse_light; 2 max, compare, next; mul, sub
//   combine_shadow            compare, 3 select, add_light
//   shade_straight            sub; scale; 2 max, compare, next
//   shade_mirror              interface; mul; vector add; mul, scale, vector add; 3 mul; 2 max,
//                             compare, next
//   shade_glass               interface; mul, max, sqrt, sub; 2 scale, vector add; sub, mul; scale, 3 mul;
//                             2 max, compare, next
//   average_colour            to_float, div_mod, add_samples
//   pack_colour               3 (clamped, encoded, mul, add, to_int); 2 shift, 3 or
//
//   list_samples              lattice_sample
//   generate_listed_rays      to_float, 3 div_mod, 2 add, 2 (2 add, mul), emit_primary_ray
//   record_geometry           and, object_of
//   record_surface            and; 2 vector sub, cross 6 mul 3 sub; dot, compare, select; object_of; normalised, scale
//   record_secondary          and; 5 compare, 2 and, 2 select; 2 vectors of select; xor, shift, xor, scrambled, add
//   record_shadow             compare, select, add
//   check_similarity          sample_neighbours; 3 fails, dot; 2 or; write_verdict
//     with secondary hits     3 fails, 2 dot, min; 3 or more
//     with textures           6 (clamped, encoded), vector sub, dot; and, 3 compare, 3 and; select, or; select,
//     compare,
//                             next more
//   interpolate_x             passed, lerp_colours, lerp_geometry
//     with secondary hits     2 (lerp, normalised) more
//   interpolate_y             passed, lerp_colours
//   average_samples           to_float, 3 div_mod; 3 mul, 4 add, to_int; add_samples
//   record_local_after, record_global   vector add or sub
//   check_attributes          sample_neighbours; vector sub, dot; 2 dot, neg, mul; 2 wraps, or;
//                             6 (clamped, encoded), vector sub, dot; 8 fails with dot, mul, 2 and for flags, 1 and; 7
//                             or; write_verdict
//   interpolate_attributes_y  passed, lerp_geometry; lerp of 2 vectors and 2 numbers
//   interpolate_attributes_x  the same, and one more vector, normalised
//   classify_occluded         has, next
//   shade_visible             diffuse_light; and, compare; 2 max, compare; 2 vectors of select; add_light
//   store_identities          lattice_sample; and; 2 (compare, select); or
//     with shadows            2 scrambled, xor more
//   find_suspects_4           sub, xor, and, compare, and, select; and, 2 compare, and; next
//   find_suspects_8           2 (2 add or sub; xor, and, compare, and, select; or) more
//
// supersample:
//
//   corner_steps    2 add, 4 compare, 2 and, 2 select, mul; a third and if has_both is used
//   active_bit      shift, and; position_sum: dot; object_of: and, compare, select, or
//   contrast        3 max, 3 min, 2 clamped (max min), 2 encoded (as in pack_colour); sub, add, max, div
//
//   clear_traits              nothing
//   record_traits             and; object_of
//   record_traits_shadow      compare, select, add
//   weigh_branch              largest, max
//   record_branch             and; object_of; largest, compare; 4 select; position_sum, select
//   record_branch_shadow      compare; position_sum, compare; 2 select, add
//   test_subpixels            shift, to_float, div_mod; (shift, and), and, 2 (to_float, sub); corner_steps; 2 add, mul;
//                             2 add, 2 add, select, 4 to_int; 2 sets of 3 (2 compare, 2 select; dot, compare, select;
//                             2 or; or, and, compare, select), 3 or, and, compare, select; 2 shift, or, and; 8 (and,
//                             compare, select, min); compare, select; 3 contrast, 3 (mul, compare), 2 or; 2 select, or
//   weigh_centres             to_float, div_mod; 2 add, mul, to_int; clamped; shift; 4 active_bit, 3 (add, add);
//                             to_float, mul, sub; scale
//   weigh_centres_bilinear    to_float, div_mod; 2 add, mul, to_int; clamped; shift; 4 of (corner_steps; 4 add, 3
//   to_int;
//                             3 clamped; add, active_bit, to_float, mul, sub; 3 scale, 4 vector add)
//   pack_subpixels            shift, to_float, div_mod; mul, and, to_float, add; mul, shift, and, to_float, add; 2
//   compare,
//                             and; mul, add, to_int; shift; 4 (add, active_bit, select), 3 add; to_float; mul, floor;
//                             mul, sub, add, compare, select, add; mul, max; add; to_int; 3 add, 4 (2 add, compare,
//                             shift, or, select); compare, next, select, add; to_int, mul, sub, to_int, shift, or
//   pack_subpixels_atomic     add, compare, sub, select; to_int; active_bit; add; compare, shift, or, select
//   generate_extra_rays       shift, shift, to_float, div_mod; 2 add; 2 (and, and, or) with 2 shift; 2 to_int, mul,
//   add;
//                             shift, or; hashes as generate_jittered_rays; add, to_float, to_int; 2 (to_float, add,
//                             mul, add), 2 scale, 2 vector add, normalised
//   state_index        shift, to_float, div_mod; 3 and, shift; 2 (add, to_float, add); add, mul, add
//                                                                           8 add  3 mul 1 other 4 integer 3 convert
//   pack_state      3 (encoded, mul, add, to_int); shift, 2 or              9 add 15 mul 9 div_sqrt 3 compare 3 select
//                                                                           3 integer 3 convert
//   unpack_channels     2 and, shift, 3 to_float
//
//   show_subpixels            shift, to_float, div_mod; 2 add, mul, to_int; clamped; state_index, to_int; pack_state
//   show_subpixels_bilinear   shift, 2 and, 2 (to_float, sub); corner_steps; 4 add, 3 to_int; 3 clamped; 3 scale, 3
//                             vector add more
//   settle_subpixels          shift, to_float, add, to_int; 4 add, clamped; 3 vector add, scale; and, shift, or;
//                             state_index, to_int; pack_state
//   propagate_subpixels       state_index, to_int; unpack_channels; 4 (add, to_int; 2 shift, compare; unpack_channels;
//   2 vectors of
//                             select, 3 min, 3 max; shift, and, select, or); 9 (and, compare, select, min); 3 (2 mul, 2
//                             add, max, compare), 2 or; shift, compare, and; next; shift, to_float, compare, and,
//                             select; next
//   average_subpixels         to_float, div_mod; to_int; shift, and, or; add_samples
//   sum_subpixels             shift; 2 (and, and, or) with 3 shift; shift, or; active_bit, compare; shift, shift, or;
//                             to_float, add, to_int; and, compare; 3 (max, min, 3 select, add, mul, add)
constexpr Hand kByHand[] = {
    //                         add mul d/s oth cmp sel int cnv  ld  st  $
    {"generate_rays", {20, 20, 2, 4, 0, 0, 0, 1, 0, 3, 0}},
    {"generate_jittered_rays", {20, 22, 2, 4, 0, 0, 31, 6, 0, 3, 0}},
    {"classify_layers", {0, 0, 0, 0, 2, 1, 2, 0, 1, 1, 0}},
    {"test_alpha", {30, 25, 2, 10, 7, 7, 13, 8, 5, 2, 3}},
    {"test_alpha_coloured", {36, 36, 2, 10, 8, 9, 17, 11, 5, 2, 4}},
    {"test_shadow", {52, 44, 2, 12, 8, 8, 33, 8, 18, 3, 3}},
    {"test_shadow_coloured", {64, 70, 2, 12, 9, 10, 46, 20, 18, 3, 4}},
    {"scatter_layers", {0, 0, 0, 0, 2, 1, 2, 0, 2, 2, 0}},
    {"classify_hits", {0, 0, 0, 0, 2, 2, 2, 0, 1, 2, 0}},
    {"shade_background", {3, 3, 0, 0, 0, 0, 0, 0, 3, 1, 0}},
    {"shade_surface", {19, 33, 2, 1, 1, 1, 1, 0, 3, 4, 2}},
    {"classify_details", {0, 0, 0, 0, 8, 8, 16, 0, 2, 8, 0}},
    {"absorb", {12, 34, 3, 2, 0, 0, 0, 0, 4, 1, 1}},
    {"fetch_vertices", {26, 45, 0, 0, 0, 0, 31, 24, 4, 3, 1}},
    {"shade_base", {38, 29, 0, 10, 5, 6, 31, 8, 19, 2, 1}},
    {"shade_physical", {35, 37, 1, 17, 8, 9, 25, 12, 8, 2, 2}},
    {"shade_bump", {54, 72, 4, 14, 5, 6, 27, 16, 8, 1, 2}},
    {"shade_blend", {0, 7, 0, 0, 0, 0, 0, 0, 3, 2, 0}},
    {"classify_surfaces", {0, 0, 0, 0, 5, 5, 10, 0, 2, 5, 0}},
    {"shade_textured", {32, 18, 0, 10, 4, 4, 26, 4, 17, 1, 1}},
    {"shade_emission", {3, 6, 0, 0, 0, 0, 0, 0, 5, 1, 1}},
    {"shade_glow", {35, 24, 0, 10, 5, 6, 27, 4, 22, 1, 2}},
    {"shade_ambient", {3, 6, 0, 0, 0, 0, 0, 0, 4, 1, 0}},
    {"shade_occluded", {24, 23, 0, 10, 5, 6, 11, 8, 9, 1, 2}},
    {"shade_diffuse", {12, 32, 2, 6, 1, 1, 1, 0, 4, 2, 0}},
    {"combine_shadow", {3, 0, 0, 0, 1, 3, 0, 0, 3, 1, 0}},
    {"shade_straight", {1, 3, 0, 2, 1, 1, 1, 0, 5, 2, 0}},
    {"shade_mirror", {16, 19, 3, 4, 3, 3, 1, 0, 5, 2, 0}},
    {"shade_glass", {15, 25, 4, 5, 3, 3, 1, 0, 5, 2, 0}},
    {"average_colour", {5, 5, 0, 7, 1, 3, 0, 2, 1, 1, 0}},
    {"pack_colour", {9, 15, 9, 6, 3, 3, 5, 3, 1, 1, 0}},
    {"list_samples", {4, 4, 0, 1, 0, 0, 0, 2, 0, 2, 0}},
    {"generate_listed_rays", {20, 20, 2, 4, 0, 0, 0, 1, 1, 3, 0}},
    {"clear_geometry", {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0}},
    {"clear_secondary", {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0}},
    {"record_geometry", {0, 0, 0, 0, 1, 1, 3, 0, 5, 1, 1}},
    {"record_surface", {13, 18, 2, 1, 2, 2, 3, 0, 6, 2, 1}},
    {"record_secondary", {0, 0, 0, 0, 5, 8, 15, 0, 5, 1, 1}},
    {"record_shadow", {0, 0, 0, 0, 1, 1, 1, 0, 3, 1, 0}},
    {"record_secondary_shadow", {0, 0, 0, 0, 1, 1, 1, 0, 3, 1, 0}},
    {"check_similarity_x", {12, 12, 0, 2, 7, 6, 7, 5, 2, 3, 0}},
    {"check_similarity_x_secondary", {16, 18, 0, 3, 10, 9, 10, 5, 4, 3, 0}},
    {"check_similarity_y", {12, 12, 0, 2, 7, 6, 7, 5, 2, 3, 0}},
    {"check_similarity_y_secondary", {16, 18, 0, 3, 10, 9, 10, 5, 4, 3, 0}},
    {"check_similarity_x_texture", {29, 39, 18, 14, 17, 15, 13, 5, 4, 3, 0}},
    {"check_similarity_x_secondary_texture", {33, 45, 18, 15, 20, 18, 16, 5, 6, 3, 0}},
    {"check_similarity_y_texture", {29, 39, 18, 14, 17, 15, 13, 5, 4, 3, 0}},
    {"check_similarity_y_secondary_texture", {33, 45, 18, 15, 20, 18, 16, 5, 6, 3, 0}},
    {"interpolate_x", {23, 18, 2, 13, 0, 0, 2, 4, 5, 2, 0}},
    {"interpolate_x_secondary", {39, 36, 6, 15, 0, 0, 2, 4, 7, 3, 0}},
    {"interpolate_y", {9, 6, 0, 12, 0, 0, 2, 4, 3, 1, 0}},
    {"average_samples", {13, 12, 0, 9, 1, 3, 0, 3, 1, 1, 0}},
    {"clear_surface", {0, 0, 0, 0, 0, 0, 0, 0, 1, 3, 0}},
    {"record_local_before", {0, 0, 0, 0, 0, 0, 0, 0, 3, 1, 0}},
    {"record_local_after", {3, 0, 0, 0, 0, 0, 0, 0, 4, 1, 0}},
    {"record_global", {3, 0, 0, 0, 0, 0, 0, 0, 3, 1, 0}},
    {"check_attributes_x", {44, 50, 18, 23, 22, 17, 18, 5, 6, 3, 0}},
    {"check_attributes_y", {44, 50, 18, 23, 22, 17, 18, 5, 6, 3, 0}},
    {"interpolate_attributes_x", {41, 32, 4, 2, 0, 0, 2, 4, 7, 9, 0}},
    {"interpolate_attributes_y", {33, 23, 2, 1, 0, 0, 2, 4, 7, 7, 0}},
    {"shade_visible", {14, 31, 2, 6, 2, 6, 1, 0, 6, 1, 0}},
    {"classify_occluded", {0, 0, 0, 0, 1, 1, 2, 0, 2, 1, 0}},
    {"store_identities", {4, 4, 0, 1, 2, 2, 2, 2, 2, 1, 0}},
    {"store_identities_shadows", {4, 4, 0, 1, 2, 2, 19, 2, 2, 1, 0}},
    {"find_suspects_4", {0, 0, 0, 0, 3, 2, 7, 0, 3, 1, 0}},
    {"find_suspects_8", {0, 0, 0, 0, 5, 4, 19, 0, 5, 1, 0}},
    // supersample.
    {"clear_traits", {0, 0, 0, 0, 0, 0, 0, 0, 1, 3, 0}},
    {"record_traits", {0, 0, 0, 0, 1, 1, 3, 0, 5, 1, 1}},
    {"record_traits_shadow", {0, 0, 0, 0, 1, 1, 1, 0, 3, 1, 0}},
    {"weigh_branch", {0, 0, 0, 3, 0, 0, 0, 0, 2, 1, 0}},
    {"record_branch", {2, 3, 0, 2, 2, 6, 3, 0, 7, 2, 1}},
    {"record_branch_shadow", {2, 3, 0, 0, 2, 2, 1, 0, 5, 1, 0}},
    {"test_subpixels", {42, 49, 21, 42, 48, 46, 54, 7, 12, 1, 0}},
    {"weigh_centres", {5, 7, 0, 7, 0, 0, 15, 3, 5, 1, 0}},
    {"weigh_centres_bilinear", {80, 47, 0, 79, 16, 8, 21, 18, 17, 1, 0}},
    {"pack_subpixels", {10, 9, 0, 3, 8, 11, 44, 8, 4, 10, 0}},
    {"pack_subpixels_atomic", {2, 0, 0, 0, 2, 2, 5, 1, 2, 3, 0}},
    {"generate_extra_rays", {17, 18, 2, 2, 0, 0, 43, 9, 1, 3, 0}},
    {"sum_subpixels", {7, 3, 0, 6, 2, 9, 18, 2, 4, 1, 0}},
    {"show_subpixels", {21, 21, 9, 8, 3, 3, 8, 9, 1, 2, 0}},
    {"show_subpixels_bilinear", {38, 31, 9, 26, 7, 5, 13, 14, 4, 2, 0}},
    {"settle_subpixels", {27, 21, 9, 25, 3, 3, 15, 9, 6, 2, 0}},
    {"propagate_subpixels", {18, 9, 0, 37, 18, 40, 56, 24, 5, 3, 0}},
    {"average_subpixels", {5, 5, 0, 7, 1, 3, 3, 3, 2, 1, 0}},
    // Scenes of instances: 2 (shift, to_float, mul) for the weights, 4 integer for the instance, and for normals 3
    // vector *
    // scalar, 2 vector + vector; for tangents 3 cross (6 mul 3 sub) besides, normalised, vector * scalar, mul.
    {"shade_surface_instanced", {25, 44, 2, 1, 1, 1, 7, 2, 3, 4, 3}},
    {"fetch_vertices_instanced", {43, 84, 2, 1, 0, 0, 37, 26, 4, 3, 2}},
    {"test_alpha_instanced", {30, 27, 2, 10, 7, 7, 15, 10, 5, 2, 3}},
    {"test_alpha_coloured_instanced", {36, 38, 2, 10, 8, 9, 19, 13, 5, 2, 4}},
    {"test_shadow_instanced", {52, 46, 2, 12, 8, 8, 35, 10, 18, 3, 3}},
    {"test_shadow_coloured_instanced", {64, 72, 2, 12, 9, 10, 48, 22, 18, 3, 4}},
    {"record_geometry_instanced", {0, 0, 0, 0, 1, 1, 6, 0, 5, 1, 1}},
    {"record_surface_instanced", {19, 27, 2, 1, 2, 2, 7, 0, 6, 2, 2}},
    {"record_secondary_instanced", {0, 0, 0, 0, 5, 8, 18, 0, 5, 1, 1}},
    {"record_traits_instanced", {0, 0, 0, 0, 1, 1, 6, 0, 5, 1, 1}},
    {"record_branch_instanced", {2, 3, 0, 2, 2, 6, 6, 0, 7, 2, 1}},
    // Mip maps: vector sub, dot, sqrt, add, 2 mul, abs, max, div, 2 and, or for the footprint.
    {"shade_surface_cones", {25, 38, 4, 3, 1, 1, 4, 0, 3, 4, 2}},
    // Of instances dot, 2 sqrt, 2 mul, div more.
    {"shade_surface_cones_instanced", {33, 54, 7, 3, 1, 1, 10, 2, 3, 4, 3}},
    // And, mul, max, min, shift, sub, add for the level; of the base texture another and, of looked up ones select.
    // The second level: and, or, sub; compare, select, add; sample; 3 (sub, mul, add) with colour, 1 with linear.
    {"shade_textured_mip", {32, 19, 0, 12, 4, 4, 31, 4, 18, 1, 1}},
    {"shade_textured_trilinear", {71, 37, 0, 22, 9, 9, 60, 8, 32, 1, 2}},
    {"shade_base_mip", {38, 30, 0, 12, 5, 7, 36, 8, 20, 2, 1}},
    {"shade_base_trilinear", {85, 56, 0, 22, 10, 12, 69, 16, 34, 2, 2}},
    {"shade_physical_mip", {35, 38, 1, 19, 8, 10, 29, 12, 9, 2, 2}},
    {"shade_physical_trilinear", {66, 60, 1, 29, 13, 15, 54, 24, 11, 2, 3}},
    {"shade_bump_mip", {54, 73, 4, 16, 5, 7, 31, 16, 9, 1, 2}},
    {"shade_bump_trilinear", {93, 103, 4, 26, 10, 12, 60, 32, 11, 1, 3}},
    {"shade_glow_mip", {35, 25, 0, 12, 5, 7, 31, 4, 23, 1, 2}},
    {"shade_glow_trilinear", {74, 43, 0, 22, 10, 12, 60, 8, 37, 1, 3}},
    {"shade_occluded_mip", {24, 24, 0, 12, 5, 7, 15, 8, 10, 1, 2}},
    {"shade_occluded_trilinear", {47, 38, 0, 22, 10, 12, 28, 16, 12, 1, 3}},
    // 2 max, less, select, add.
    {"count_coloured", {0, 0, 0, 2, 1, 1, 1, 0, 2, 0, 0}},
};

TEST(Graphs, OperationsAreThoseOfTheSource) {
  ASSERT_EQ(std::size(kByHand) + std::size(kReconstructByHand) + std::size(kEffectsByHand) + std::size(kPathByHand) +
                std::size(kBuildByHand) + std::size(kDenoiseByHand),
            kFirstFused);
  expect_counts(kByHand);
  expect_counts(kReconstructByHand);
  expect_counts(kEffectsByHand);
  expect_counts(kDenoiseByHand);
  expect_counts(kPathByHand);
  expect_counts(kBuildByHand);
}

TEST(Graphs, KernelsAreFoundByIdAndName) {
  for (std::size_t i = 0; i < kernel_catalogue().size(); ++i) {
    EXPECT_EQ(kernel_catalogue()[i].id, i);
    EXPECT_EQ(find_kernel(kernel_catalogue()[i].name), &kernel_catalogue()[i]);
    EXPECT_EQ(kernel_catalogue()[i].graph.kernel, kernel_catalogue()[i].name);
    EXPECT_FALSE(kernel_catalogue()[i].meaning.empty());
  }
  EXPECT_EQ(kKernelId<ShadeGlass>, find_kernel("shade_glass")->id);
  EXPECT_EQ(find_kernel("shade_nothing"), nullptr);
}

TEST(Graphs, InputsComeFirstUnlessCarried) {
  for (const KernelInfo& kernel : kernel_catalogue()) {
    for (std::uint32_t i = 0; i < kernel.graph.nodes.size(); ++i) {
      const GraphNode& node = kernel.graph.nodes[i];
      for_each_input(node, [&](std::uint32_t id) {
        EXPECT_LT(id, kernel.graph.nodes.size());
        EXPECT_TRUE(id < i || node.distance != 0) << kernel.name << " node " << i;
      });
      EXPECT_TRUE(node.distance == 0 || node.op == Op::kInput);
      EXPECT_EQ(node.stored.size() * 4, node.op == Op::kStoreLocal ? node.bytes : 0);
    }
  }
}

TEST(Graphs, LiteralsAreRecordedOnce) {
  for (const KernelInfo& kernel : kernel_catalogue()) {
    std::vector<std::uint32_t> bits;
    for (const GraphNode& node : kernel.graph.nodes) {
      if (node.op == Op::kConstant && node.label.empty()) bits.push_back(node.value);
    }
    std::ranges::sort(bits);
    EXPECT_EQ(std::ranges::adjacent_find(bits), bits.end()) << kernel.name;
  }
}

TEST(Graphs, CompactionIsALoopCarriedCount) {
  const Graph& graph = find_kernel("classify_hits")->graph;
  std::uint32_t carried = 0;
  for (const GraphNode& node : graph.nodes) {
    if (node.distance == 0) continue;
    ++carried;
    EXPECT_EQ(graph.nodes[node.inputs[0]].op, Op::kIntAdd);
  }
  EXPECT_EQ(carried, 2U);
}

TEST(Graphs, ListingShowsEveryNode) {
  const Graph& graph = find_kernel("combine_shadow")->graph;
  const std::string text = node_listing(graph);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text, '\n')), graph.nodes.size());
  EXPECT_NE(text.find("shadow_hits.triangle"), std::string::npos);
  EXPECT_NE(operation_summary(graph).find("combine_shadow: 11 operations"), std::string::npos);
}

}  // namespace
}  // namespace kernels
