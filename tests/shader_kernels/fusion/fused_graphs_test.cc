#include "tests/shader_kernels/hand_counts.h"

namespace kernels {
namespace {

// Checks that a fused kernel has the operations of its parts, without those that an earlier part has done. Counted by
// hand. light_surface: classify_surfaces; and, compare, and, next for `later`; and, compare for what is lit;
// shade_ambient with 3 select; shade_diffuse with and, less 3 mul that shade_ambient has done; once each of surfaces,
// mattes, paths, colours, places.
constexpr Hand kFusedByHand[] = {
    //                         add mul d/s oth cmp sel int cnv  ld  st  $
    {"fetch_surface", {19, 33, 2, 1, 9, 9, 17, 0, 3, 12, 2}},
    {"fetch_surface_instanced", {25, 44, 2, 1, 9, 9, 23, 2, 3, 12, 3}},
    {"light_surface", {15, 35, 2, 6, 8, 10, 16, 0, 5, 9, 0}},
    // record_*: also hits and texcoords.
    {"light_surface_geometry", {15, 35, 2, 6, 9, 11, 19, 0, 6, 10, 1}},
    {"light_surface_geometry_instanced", {15, 35, 2, 6, 9, 11, 22, 0, 6, 10, 1}},
    {"light_surface_kept", {28, 53, 4, 7, 10, 12, 19, 0, 7, 11, 1}},
    {"light_surface_kept_instanced", {34, 62, 4, 7, 10, 12, 23, 0, 7, 11, 2}},
    {"light_surface_secondary", {15, 35, 2, 6, 13, 18, 31, 0, 7, 10, 1}},
    {"light_surface_secondary_instanced", {15, 35, 2, 6, 13, 18, 34, 0, 7, 10, 1}},
    // shade_surface: also rays, hits, paths, colours, besides surfaces; record_* without triangle_index_of (1 integer)
    // and
    // instance_index_of (4), which shade_surface has done, as it has loaded the instance.
    {"fetch_lit", {34, 68, 4, 7, 9, 11, 17, 0, 5, 13, 2}},
    {"fetch_lit_instanced", {40, 79, 4, 7, 9, 11, 23, 2, 5, 13, 3}},
    {"fetch_lit_geometry", {34, 68, 4, 7, 10, 12, 19, 0, 5, 14, 3}},
    {"fetch_lit_geometry_instanced", {40, 79, 4, 7, 10, 12, 25, 2, 5, 14, 3}},
    {"fetch_lit_kept", {47, 86, 6, 8, 11, 13, 19, 0, 5, 15, 3}},
    {"fetch_lit_kept_instanced", {59, 106, 6, 8, 11, 13, 25, 2, 5, 15, 4}},
    {"fetch_lit_secondary", {34, 68, 4, 7, 14, 19, 31, 0, 6, 14, 3}},
    {"fetch_lit_secondary_instanced", {40, 79, 4, 7, 14, 19, 37, 2, 6, 14, 3}},
    {"light_later", {15, 35, 2, 6, 1, 1, 1, 0, 5, 3, 0}},
    {"generate_geometry", {20, 20, 2, 4, 0, 0, 0, 1, 1, 4, 0}},
    {"generate_secondary", {20, 20, 2, 4, 0, 0, 0, 1, 1, 5, 0}},
    {"generate_surface", {20, 20, 2, 4, 0, 0, 0, 1, 1, 6, 0}},
    {"generate_traits", {20, 20, 2, 4, 0, 0, 0, 1, 1, 6, 0}},
    // One comparison, one load each of shadow_hits and shadow_paths.
    {"combine_record_shadow", {3, 0, 0, 0, 1, 4, 1, 0, 4, 2, 0}},
    {"combine_record_secondary_shadow", {3, 0, 0, 0, 1, 4, 1, 0, 4, 2, 0}},
    {"combine_record_traits_shadow", {3, 0, 0, 0, 1, 4, 1, 0, 4, 2, 0}},
    {"combine_record_branch_shadow", {5, 3, 0, 0, 2, 5, 1, 0, 6, 2, 0}},
    // Instead of `passed` to_float, add, mul; the stream `passed` is not stored, which saves shift, or; once each of
    // geometry and secondary.
    {"check_interpolate_x", {33, 28, 2, 15, 7, 6, 5, 6, 4, 4, 0}},
    {"check_interpolate_x_secondary", {53, 52, 6, 18, 10, 9, 8, 6, 6, 5, 0}},
    {"check_interpolate_y", {19, 16, 0, 14, 7, 6, 5, 6, 4, 3, 0}},
    {"check_interpolate_y_secondary", {23, 22, 0, 15, 10, 9, 8, 6, 6, 3, 0}},
    // With textures: 6 encoded, vector sub, dot, and what the check counts; colours are loaded and clamped already.
    {"check_interpolate_x_texture", {50, 55, 20, 15, 17, 15, 11, 6, 4, 4, 0}},
    {"check_interpolate_x_secondary_texture", {70, 79, 24, 18, 20, 18, 14, 6, 6, 5, 0}},
    {"check_interpolate_y_texture", {36, 43, 18, 14, 17, 15, 11, 6, 4, 3, 0}},
    {"check_interpolate_y_secondary_texture", {40, 49, 18, 15, 20, 18, 14, 6, 6, 3, 0}},
    // As light_surface, with shade_visible in place of shade_diffuse; all but the references is in registers, and the
    // colour is stored once.
    {"interpolate_lit_x", {58, 66, 6, 8, 9, 15, 18, 4, 7, 15, 0}},
    {"interpolate_lit_y", {50, 57, 4, 7, 9, 15, 18, 4, 7, 13, 0}},
    // Without 2 wraps, or; 2 (has, select, or), and.
    {"check_attributes_x_untextured", {38, 50, 18, 15, 16, 15, 10, 5, 6, 3, 0}},
    {"check_attributes_y_untextured", {38, 50, 18, 15, 16, 15, 10, 5, 6, 3, 0}},
    // As pack_colour; along rows to_float, div_mod, 2 mul, 2 add, to_int.
    {"pack_sample", {9, 15, 9, 6, 3, 3, 5, 3, 1, 1, 0}},
    {"pack_grid_sample", {13, 19, 9, 7, 3, 3, 5, 5, 1, 1, 0}},
    // As without cones, and 6 add, 5 mul, 2 div_sqrt, 2 other, 3 integer for the footprint.
    {"fetch_surface_cones", {25, 38, 4, 3, 9, 9, 20, 0, 3, 12, 2}},
    {"fetch_surface_cones_instanced", {33, 54, 7, 3, 9, 9, 26, 2, 3, 12, 3}},
    {"fetch_lit_cones", {40, 73, 6, 9, 9, 11, 20, 0, 5, 13, 2}},
    {"fetch_lit_cones_instanced", {48, 89, 9, 9, 9, 11, 26, 2, 5, 13, 3}},
    {"fetch_lit_geometry_cones", {40, 73, 6, 9, 10, 12, 22, 0, 5, 14, 3}},
    {"fetch_lit_geometry_cones_instanced", {48, 89, 9, 9, 10, 12, 28, 2, 5, 14, 3}},
    {"fetch_lit_kept_cones", {53, 91, 8, 10, 11, 13, 22, 0, 5, 15, 3}},
    {"fetch_lit_kept_cones_instanced", {67, 116, 11, 10, 11, 13, 28, 2, 5, 15, 4}},
    {"fetch_lit_secondary_cones", {40, 73, 6, 9, 14, 19, 34, 0, 6, 14, 3}},
    {"fetch_lit_secondary_cones_instanced", {48, 89, 9, 9, 14, 19, 40, 2, 6, 14, 3}},
    // As pack_grid_sample, and store_identities less the sample's index.
    {"pack_identified", {13, 19, 9, 7, 5, 5, 7, 5, 3, 2, 0}},
    {"pack_identified_shadows", {13, 19, 9, 7, 5, 5, 24, 5, 3, 2, 0}},
    // Less one load of samples; the sum of the global colour is in registers.
    {"record_counted", {3, 0, 0, 2, 1, 1, 1, 0, 3, 1, 0}},
    // Without 6 encoded, vector sub, dot, less, select, or.
    {"check_attributes_x_local", {27, 23, 0, 11, 15, 10, 17, 5, 4, 3, 0}},
    {"check_attributes_y_local", {27, 23, 0, 11, 15, 10, 17, 5, 4, 3, 0}},
    {"check_attributes_x_local_untextured", {21, 23, 0, 3, 9, 8, 9, 5, 4, 3, 0}},
    {"check_attributes_y_local_untextured", {21, 23, 0, 3, 9, 8, 9, 5, 4, 3, 0}},
    // As combine_record_shadow.
    {"combine_record_visible_shadow", {3, 0, 0, 0, 1, 4, 1, 0, 4, 2, 0}},
    // As light_surface, with shade_open in place of shade_diffuse: the colour is stored once. With shade_soft: 17 add,
    // 23 mul, div_sqrt, 7 other, compare, select, 25 integer, 2 convert, rays more. Occlusion: without shade_ambient.
    {"light_surface_open", {17, 34, 2, 6, 8, 12, 15, 0, 5, 7, 0}},
    {"light_surface_soft", {32, 58, 3, 13, 9, 11, 41, 2, 6, 9, 0}},
    {"light_surface_occlusion", {21, 36, 3, 10, 10, 9, 41, 2, 5, 8, 0}},
    // Also shade_surface, as in fetch_lit.
    {"fetch_lit_open", {36, 67, 4, 7, 9, 13, 16, 0, 5, 11, 2}},
    {"fetch_lit_open_instanced", {42, 78, 4, 7, 9, 13, 22, 2, 5, 11, 3}},
    {"fetch_lit_open_cones", {42, 72, 6, 9, 9, 13, 19, 0, 5, 11, 2}},
    {"fetch_lit_open_cones_instanced", {50, 88, 9, 9, 9, 13, 25, 2, 5, 11, 3}},
    {"fetch_lit_soft", {51, 91, 5, 14, 10, 12, 42, 2, 5, 13, 2}},
    {"fetch_lit_soft_instanced", {57, 102, 5, 14, 10, 12, 48, 4, 5, 13, 3}},
    {"fetch_lit_soft_cones", {57, 96, 7, 16, 10, 12, 45, 2, 5, 13, 2}},
    {"fetch_lit_soft_cones_instanced", {65, 112, 10, 16, 10, 12, 51, 4, 5, 13, 3}},
    {"fetch_lit_occlusion", {40, 69, 5, 11, 11, 10, 42, 2, 4, 12, 2}},
    {"fetch_lit_occlusion_instanced", {46, 80, 5, 11, 11, 10, 48, 4, 4, 12, 3}},
    {"fetch_lit_occlusion_cones", {46, 74, 7, 13, 11, 10, 45, 2, 4, 12, 2}},
    {"fetch_lit_occlusion_cones_instanced", {54, 90, 10, 13, 11, 10, 51, 4, 4, 12, 3}},
    // Once each of surfaces; places and mattes are in registers.
    {"fetch_visible", {24, 36, 2, 1, 6, 6, 11, 0, 4, 10, 2}},
    {"fetch_visible_instanced", {30, 47, 2, 1, 6, 6, 17, 2, 4, 10, 3}},
    {"fetch_visible_cones", {30, 41, 4, 3, 6, 6, 14, 0, 4, 10, 2}},
    {"fetch_visible_cones_instanced", {38, 57, 7, 3, 6, 6, 20, 2, 4, 10, 3}},
};

TEST(FusedGraphs, OperationsAreThoseOfThePartsLessWhatIsShared) {
  ASSERT_EQ(kFirstFused + std::size(kFusedByHand), kernel_catalogue().size());
  expect_counts(kFusedByHand);
}

}  // namespace
}  // namespace kernels
