#pragma once
#include <string_view>

#include "shader_kernels/kernels/cast_occlusion.h"
#include "shader_kernels/kernels/fused.h"
#include "shader_kernels/kernels/record_visible.h"
#include "shader_kernels/kernels/shade_open.h"
#include "shader_kernels/kernels/shade_soft.h"

namespace kernels {

// As light_surface and fetch_lit, in frames of other effects than hard shadows (docs/design/effects.md): surfaces are
// lit by what comes first, ambient light and the first light or its first ray, or the first occlusion ray.

template <class... Local>
using LitBy = Fused<ClassifySurfaces, ListLater, AtOnce<Local>...>;
template <bool kInstanced, bool kCones, class... Local>
using FetchedAndLitBy = Fused<ShadeSurface<kInstanced, kCones>, ClassifySurfaces, ListLater, AtOnce<Local>...>;

struct LightSurfaceOpen : LitBy<ShadeAmbient, ShadeOpen> {
  static constexpr std::string_view kName = "light_surface_open";
  static constexpr std::string_view kMeaning = "classify_surfaces, shade_ambient, shade_open of the first light";
};

struct LightSurfaceSoft : LitBy<ShadeAmbient, ShadeSoft> {
  static constexpr std::string_view kName = "light_surface_soft";
  static constexpr std::string_view kMeaning = "classify_surfaces, shade_ambient, shade_soft of the first light";
};

struct LightSurfaceOcclusion : LitBy<CastOcclusion> {
  static constexpr std::string_view kName = "light_surface_occlusion";
  static constexpr std::string_view kMeaning = "classify_surfaces, cast_occlusion of the first ray";
};

template <bool kInstanced, bool kCones>
struct FetchLitOpen : FetchedAndLitBy<kInstanced, kCones, ShadeAmbient, ShadeOpen> {
  static constexpr std::string_view kName = by_surface<kInstanced, kCones>(
      "fetch_lit_open", "fetch_lit_open_instanced", "fetch_lit_open_cones", "fetch_lit_open_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface_open";
};

template <bool kInstanced, bool kCones>
struct FetchLitSoft : FetchedAndLitBy<kInstanced, kCones, ShadeAmbient, ShadeSoft> {
  static constexpr std::string_view kName = by_surface<kInstanced, kCones>(
      "fetch_lit_soft", "fetch_lit_soft_instanced", "fetch_lit_soft_cones", "fetch_lit_soft_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface_soft";
};

template <bool kInstanced, bool kCones>
struct FetchLitOcclusion : FetchedAndLitBy<kInstanced, kCones, CastOcclusion> {
  static constexpr std::string_view kName =
      by_surface<kInstanced, kCones>("fetch_lit_occlusion", "fetch_lit_occlusion_instanced",
                                     "fetch_lit_occlusion_cones", "fetch_lit_occlusion_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, light_surface_occlusion";
};

/// Surfaces without details whose light is kept for an upsampling.
template <bool kInstanced, bool kCones>
struct FetchVisible : Fused<ShadeSurface<kInstanced, kCones>, ClassifySurfaces, RecordVisible> {
  static constexpr std::string_view kName = by_surface<kInstanced, kCones>(
      "fetch_visible", "fetch_visible_instanced", "fetch_visible_cones", "fetch_visible_cones_instanced");
  static constexpr std::string_view kMeaning = "shade_surface, classify_surfaces, record_visible";
};

}  // namespace kernels
