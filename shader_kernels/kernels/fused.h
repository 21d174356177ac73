#pragma once
#include <array>
#include <string_view>

#include "shader_kernels/fusion.h"
#include "shader_kernels/kernels/classify.h"
#include "shader_kernels/kernels/effects.h"
#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/kernels/light.h"
#include "shader_kernels/kernels/pixels.h"
#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/kernels/record_hits.h"
#include "shader_kernels/kernels/shade_surface.h"
#include "shader_kernels/kernels/similarity.h"

namespace kernels {

// Fused kernels (shader_kernels/fusion.h). With render.fusion they are launched instead of their parts.

// Surface kernels. They fetch and classify a surface. They also add ambient light and the first light, if no other
// kernel must run in between.

template <bool kInstanced, bool kCones = false>
struct FetchSurface : Fused<ShadeSurface<kInstanced, kCones>, ClassifyDetails> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_surface", "fetch_surface_instanced", "fetch_surface_cones", "fetch_surface_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, classify_details";
};

/// Parts of fused kernels that classify and light a surface whose texture details have been applied.
template <class... Record>
using LightParts =
    Fused<ClassifySurfaces, ListDeferred, LightImmediately<ShadeAmbient>, LightImmediately<ShadeDiffuse>, Record...>;

struct LightSurface : LightParts<> {
  static constexpr std::string_view kName = "light_surface";
  static constexpr std::string_view kMeaning = "classify_surfaces, shade_ambient, shade_diffuse of the first light";
};

template <bool kInstanced>
struct LightSurfaceGeometry : LightParts<RecordGeometry<kInstanced>> {
  static constexpr std::string_view kName = kInstanced ? "light_surface_geometry_instanced" : "light_surface_geometry";
  static constexpr std::string_view kMeaning = "light_surface, record_geometry";
};

template <bool kInstanced>
struct LightSurfaceKept : LightParts<RecordSurface<kInstanced>> {
  static constexpr std::string_view kName = kInstanced ? "light_surface_kept_instanced" : "light_surface_kept";
  static constexpr std::string_view kMeaning = "light_surface, record_surface";
};

template <bool kInstanced>
struct LightSurfaceSecondary : LightParts<RecordSecondary<kInstanced>> {
  static constexpr std::string_view kName =
      kInstanced ? "light_surface_secondary_instanced" : "light_surface_secondary";
  static constexpr std::string_view kMeaning = "light_surface, record_secondary";
};

/// Parts of fused kernels that fetch, classify and light a surface, for scenes without texture details.
template <bool kInstanced, bool kCones, class... Record>
using FetchAndLightParts = Fused<ShadeSurface<kInstanced, kCones>, ClassifySurfaces, ListDeferred,
                                 LightImmediately<ShadeAmbient>, LightImmediately<ShadeDiffuse>, Record...>;

template <bool kInstanced, bool kCones = false>
struct FetchLit : FetchAndLightParts<kInstanced, kCones> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_lit", "fetch_lit_instanced", "fetch_lit_cones", "fetch_lit_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface";
};

template <bool kInstanced, bool kCones = false>
struct FetchLitGeometry : FetchAndLightParts<kInstanced, kCones, RecordGeometry<kInstanced>> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_lit_geometry", "fetch_lit_geometry_instanced", "fetch_lit_geometry_cones",
      "fetch_lit_geometry_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface, record_geometry";
};

template <bool kInstanced, bool kCones = false>
struct FetchLitKept : FetchAndLightParts<kInstanced, kCones, RecordSurface<kInstanced>> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_lit_kept", "fetch_lit_kept_instanced", "fetch_lit_kept_cones", "fetch_lit_kept_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface, record_surface";
};

template <bool kInstanced, bool kCones = false>
struct FetchLitSecondary : FetchAndLightParts<kInstanced, kCones, RecordSecondary<kInstanced>> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_lit_secondary", "fetch_lit_secondary_instanced", "fetch_lit_secondary_cones",
      "fetch_lit_secondary_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface, record_secondary";
};

/// Lights the surfaces whose lighting had to wait for their textures. Texture kernels are not fused with it: a loop
/// with a longer initiation interval has fewer items in flight and hides less load latency.
struct LightDeferred : Fused<ShadeAmbient, ShadeDiffuse> {
  static constexpr std::string_view kName = "light_later";
  static constexpr std::string_view kMeaning = "shade_ambient, shade_diffuse of the first light";
};

// Kernels that generate primary rays and clear the records of their samples.

struct GenerateGeometry : Fused<GenerateListedRays, ClearGeometry> {
  static constexpr std::string_view kName = "generate_geometry";
  static constexpr std::string_view kMeaning = "generate_listed_rays, clear_geometry";
};

struct GenerateSecondary : Fused<GenerateListedRays, ClearGeometry, ClearSecondary> {
  static constexpr std::string_view kName = "generate_secondary";
  static constexpr std::string_view kMeaning = "generate_listed_rays, clear_geometry, clear_secondary";
};

struct GenerateSurface : Fused<GenerateListedRays, ClearSurface> {
  static constexpr std::string_view kName = "generate_surface";
  static constexpr std::string_view kMeaning = "generate_listed_rays, clear_surface";
};

struct GenerateTraits : Fused<GenerateListedRays, ClearTraits> {
  static constexpr std::string_view kName = "generate_traits";
  static constexpr std::string_view kMeaning = "generate_listed_rays, clear_traits";
};

// Kernels that add the light of shadow rays and record the shadows of their samples.

struct CombineRecordShadow : Fused<CombineShadow, RecordShadow> {
  static constexpr std::string_view kName = "combine_record_shadow";
  static constexpr std::string_view kMeaning = "combine_shadow, record_shadow";
};

struct CombineRecordSecondaryShadow : Fused<CombineShadow, RecordSecondaryShadow> {
  static constexpr std::string_view kName = "combine_record_secondary_shadow";
  static constexpr std::string_view kMeaning = "combine_shadow, record_secondary_shadow";
};

struct CombineRecordTraitsShadow : Fused<CombineShadow, RecordTraitsShadow> {
  static constexpr std::string_view kName = "combine_record_traits_shadow";
  static constexpr std::string_view kMeaning = "combine_shadow, record_traits_shadow";
};

struct CombineRecordBranchShadow : Fused<CombineShadow, RecordBranchShadow> {
  static constexpr std::string_view kName = "combine_record_branch_shadow";
  static constexpr std::string_view kMeaning = "combine_shadow, record_branch_shadow";
};

struct CombineRecordVisibleShadow : Fused<CombineShadow, RecordVisibleShadow> {
  static constexpr std::string_view kName = "combine_record_visible_shadow";
  static constexpr std::string_view kMeaning = "combine_shadow, record_visible_shadow";
};

// Kernels that check and interpolate samples between two reference samples.

/// Checks a sample and interpolates it, in one kernel. Used where no later kernel reads the list of samples that
/// passed.
template <bool kAlongY, bool kSecondary, bool kTexture>
struct CheckInterpolate : Fused<CheckSimilarity<kAlongY, kSecondary, kTexture>,
                                InterpolateAll<kAlongY, InterpolateSample<kAlongY, kSecondary && !kAlongY>>> {
  static constexpr std::array<std::string_view, 8> kNames{"check_interpolate_x",
                                                          "check_interpolate_y",
                                                          "check_interpolate_x_secondary",
                                                          "check_interpolate_y_secondary",
                                                          "check_interpolate_x_texture",
                                                          "check_interpolate_y_texture",
                                                          "check_interpolate_x_secondary_texture",
                                                          "check_interpolate_y_secondary_texture"};
  static constexpr std::string_view kName = kNames[(kAlongY ? 1 : 0) + (kSecondary ? 2 : 0) + (kTexture ? 4 : 0)];
  static constexpr std::string_view kMeaning = "check_similarity, interpolate: all samples, as the others are traced";
  static constexpr std::array<std::string_view, 1> kRegisters{"passed"};
};

template <bool kAlongY>
struct InterpolateLit : Fused<InterpolateAttributes<kAlongY>, ClassifySurfaces, ListDeferred,
                              LightImmediately<ShadeAmbient>, LightImmediately<ShadeVisible>> {
  static constexpr std::string_view kName = kAlongY ? "interpolate_lit_y" : "interpolate_lit_x";
  static constexpr std::string_view kMeaning =
      "interpolate_attributes, classify_surfaces, shade_ambient, shade_visible of the first light";
};

// Kernels that store pixels with one sample.

struct PackSample : Fused<TakeSample, PackClamped> {
  static constexpr std::string_view kName = "pack_sample";
  static constexpr std::string_view kMeaning = "average_colour of one sample, pack_colour";
  static constexpr std::array<std::string_view, 1> kRegisters{"pixels"};
};

struct PackGridSample : Fused<TakeGridSample, PackClamped> {
  static constexpr std::string_view kName = "pack_grid_sample";
  static constexpr std::string_view kMeaning = "average_samples of one sample, pack_colour";
  static constexpr std::array<std::string_view, 1> kRegisters{"pixels"};
};

struct RecordCounted : Fused<RecordGlobal, CountColoured> {
  static constexpr std::string_view kName = "record_counted";
  static constexpr std::string_view kMeaning = "record_global, count_coloured";
};

/// Fused kernel for a pixel with one sample: packs the colour, and stores the sample's identity word for the first scan
/// of post-correction.
template <bool kShadows>
struct PackIdentified : Fused<TakeGridSample, PackClamped, StoreIdentities<kShadows>> {
  using Identities = StoreIdentities<kShadows>;
  static constexpr std::string_view kName = kShadows ? "pack_identified_shadows" : "pack_identified";
  static constexpr std::string_view kMeaning = "average_samples of one sample, pack_colour, store_identities";
  static constexpr std::array<std::string_view, 1> kRegisters{"pixels"};
};

// Variants of light_surface and fetch_lit for frames without shadows, with soft shadows or with occlusion
// (docs/design/effects.md). The last part is the first launch of the effect: the first ray of the first light, or the
// first occlusion ray.

template <class... Local>
using LightPartsWithEffect = Fused<ClassifySurfaces, ListDeferred, LightImmediately<Local>...>;
template <bool kInstanced, bool kCones, class... Local>
using FetchAndLightPartsWithEffect =
    Fused<ShadeSurface<kInstanced, kCones>, ClassifySurfaces, ListDeferred, LightImmediately<Local>...>;

struct LightSurfaceOpen : LightPartsWithEffect<ShadeAmbient, ShadeOpen> {
  static constexpr std::string_view kName = "light_surface_open";
  static constexpr std::string_view kMeaning = "classify_surfaces, shade_ambient, shade_open of the first light";
};

struct LightSurfaceSoft : LightPartsWithEffect<ShadeAmbient, ShadeSoft> {
  static constexpr std::string_view kName = "light_surface_soft";
  static constexpr std::string_view kMeaning = "classify_surfaces, shade_ambient, shade_soft of the first light";
};

struct LightSurfaceOcclusion : LightPartsWithEffect<CastOcclusion> {
  static constexpr std::string_view kName = "light_surface_occlusion";
  static constexpr std::string_view kMeaning = "classify_surfaces, cast_occlusion of the first ray";
};

template <bool kInstanced, bool kCones>
struct FetchLitOpen : FetchAndLightPartsWithEffect<kInstanced, kCones, ShadeAmbient, ShadeOpen> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_lit_open", "fetch_lit_open_instanced", "fetch_lit_open_cones", "fetch_lit_open_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface_open";
};

template <bool kInstanced, bool kCones>
struct FetchLitSoft : FetchAndLightPartsWithEffect<kInstanced, kCones, ShadeAmbient, ShadeSoft> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_lit_soft", "fetch_lit_soft_instanced", "fetch_lit_soft_cones", "fetch_lit_soft_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface_soft";
};

template <bool kInstanced, bool kCones>
struct FetchLitOcclusion : FetchAndLightPartsWithEffect<kInstanced, kCones, CastOcclusion> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_lit_occlusion", "fetch_lit_occlusion_instanced", "fetch_lit_occlusion_cones",
      "fetch_lit_occlusion_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface_occlusion";
};

/// Fetches a surface without texture details. Records its normal and depth, so that the upsampling filter can compare
/// them.
template <bool kInstanced, bool kCones>
struct FetchVisible : Fused<ShadeSurface<kInstanced, kCones>, ClassifySurfaces, RecordVisible> {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "fetch_visible", "fetch_visible_instanced", "fetch_visible_cones", "fetch_visible_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, classify_surfaces, record_visible";
};

}  // namespace kernels
