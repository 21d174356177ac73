#include "shader_kernels/programs/programs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "shader_kernels/programs/adaptive/multirate.h"
#include "shader_kernels/programs/adaptive/reconstruct.h"
#include "shader_kernels/programs/adaptive/supersample.h"
#include "shader_kernels/programs/adaptive/undersample.h"
#include "shader_kernels/programs/build_pass.h"
#include "shader_kernels/programs/denoise/denoised.h"
#include "shader_kernels/programs/full.h"
#include "shader_kernels/programs/geometry_pass.h"
#include "shader_kernels/programs/path_program.h"
#include "shader_kernels/programs/upsampled.h"
#include "sim/error.h"

namespace kernels {
namespace {

/// Throws InputError if the frame has occlusion or soft shadows, because program undersample lights interpolated
/// surfaces without rays.
void check_undersample_effects(const Effects& effects) {
  for (const Effect effect : {Effect::kOcclusion, Effect::kSoftShadows}) {
    if (!effects.has(effect)) continue;
    throw sim::InputError(fmt::format(
        "render.effects: {}: undersample lights surfaces between its samples without rays; allowed: shadows, "
        "reflections, refractions, or another program",
        names_of(effect)[static_cast<std::size_t>(effect)]));
  }
}

/// Throws InputError if the effects are not those of a path tracer: shadows of either kind, reflections, refractions.
void check_path_effects(const Effects& effects) {
  const bool has_shadows = effects.has(Effect::kShadows) || effects.has(Effect::kSoftShadows);
  const bool has_all = has_shadows && effects.has(Effect::kReflections) && effects.has(Effect::kRefractions);
  if (has_all && !effects.has(Effect::kOcclusion) && !effects.has(Effect::kBounce)) return;
  throw sim::InputError(
      "render.effects: the program path traces all light; allowed: shadows or soft_shadows, with reflections and "
      "refractions and without occlusion and bounce, or another program");
}

/// Throws InputError if effect rays are to be traced at only some pixels and the program is not full:1. Only full:1 can
/// compute the effects of the other pixels.
void check_effect_rate(const ProgramSpec& spec, EffectRate rate) {
  if (rate == EffectRate::kFull || (spec.kind == ProgramSpec::Kind::kFull && spec.samples == 1)) return;
  throw sim::InputError(fmt::format(
      "render.effect_rate: {}: the program {} has effects at every sample; allowed: full, or the program full:1",
      names_of(rate)[static_cast<std::size_t>(rate)], spec.name()));
}

std::unique_ptr<FrameProgram> make_denoised(const ProgramSpec& spec, const Frame& f) {
  check_denoise(spec, f.render, f.programs.denoise);
  check_effect_rate(spec, f.render.effect_rate);
  const auto grid = static_cast<std::uint32_t>(std::lround(std::sqrt(spec.samples)));
  const bool is_path = spec.kind == ProgramSpec::Kind::kPath;
  if (is_path) check_path_effects(parse_effects(f.render.effects));
  const bool is_low_rate = f.render.effect_rate != EffectRate::kFull && f.render.has_low_rate_effects();
  const auto make = [&](const PixelSink& sink) -> std::unique_ptr<FrameProgram> {
    if (is_low_rate) {
      return std::make_unique<UpsampledProgram>(f.image, f.camera, f.render, f.programs.reconstruct, f.scene_size,
                                                f.number, &sink);
    }
    if (!is_path) return std::make_unique<FullProgram>(f.image, f.camera, f.render, spec.samples, f.number, &sink);
    return std::make_unique<PathProgram>(f.image, f.camera, f.render, f.programs.path, spec.samples, f.number, &sink);
  };
  const FinishedTiles tiles = is_low_rate ? UpsampledProgram::tiles_of(f.render)
                                          : FinishedTiles(f.render.width, f.render.height, f.render.tile / grid, 0);
  return std::make_unique<DenoisedProgram>(f.image, f.camera, f.render, f.programs.denoise, f.history, f.number,
                                           NoisyProgram{tiles, !is_path, make});
}

std::unique_ptr<FrameProgram> make_plain_program(const ProgramSpec& spec, const Frame& f) {
  if (f.programs.denoise.has_kernels()) return make_denoised(spec, f);
  check_effect_rate(spec, f.render.effect_rate);
  if (f.render.effect_rate != EffectRate::kFull && f.render.has_low_rate_effects()) {
    return std::make_unique<UpsampledProgram>(f.image, f.camera, f.render, f.programs.reconstruct, f.scene_size,
                                              f.number);
  }
  switch (spec.kind) {
    case ProgramSpec::Kind::kMultirate:
      return std::make_unique<MultirateProgram>(f.image, f.camera, f.render, f.programs.multirate,
                                                spec.samples == 1 ? 1 : 2, f.rates, f.number);
    case ProgramSpec::Kind::kSupersample:
      return std::make_unique<SupersampleProgram>(f.image, f.camera, f.render, f.programs.supersample, f.number);
    case ProgramSpec::Kind::kUndersample:
      check_undersample_effects(parse_effects(f.render.effects));
      return std::make_unique<UndersampleProgram>(f.image, f.camera, f.render, f.programs.undersample, f.scene_size,
                                                  f.number);
    case ProgramSpec::Kind::kReconstruct:
    case ProgramSpec::Kind::kSraa: {
      using Filters = ReconstructProgram::Filters;
      const Filters filters = spec.kind == ProgramSpec::Kind::kSraa ? Filters::kOne : Filters::kApart;
      return std::make_unique<ReconstructProgram>(f.image, f.camera, f.render, f.programs.reconstruct, filters,
                                                  f.scene_size, f.number);
    }
    case ProgramSpec::Kind::kPath:
      check_path_effects(parse_effects(f.render.effects));
      return std::make_unique<PathProgram>(f.image, f.camera, f.render, f.programs.path, spec.samples, f.number);
    case ProgramSpec::Kind::kFull:
      break;
  }
  return std::make_unique<FullProgram>(f.image, f.camera, f.render, spec.samples, f.number);
}

/// Returns the desired side of a tile in pixels.
std::uint32_t desired_tile_side(const ProgramSpec& spec, const Frame& f) {
  std::uint32_t grid = static_cast<std::uint32_t>(std::lround(std::sqrt(spec.samples)));
  using Kind = ProgramSpec::Kind;
  const bool has_four = spec.kind == Kind::kReconstruct || spec.kind == Kind::kSraa;
  if (has_four || spec.kind == Kind::kSupersample) grid = 2;  // samples or sub-pixels
  if (f.render.effect_rate != EffectRate::kFull) grid = 2;
  if (spec.kind == ProgramSpec::Kind::kUndersample) grid = f.programs.undersample.pixel_grid_side();
  return std::max(1U, f.render.tile / grid);
}

}  // namespace

void check_denoise(const ProgramSpec& spec, const RenderConfig& render, const DenoiseConfig& denoise) {
  if (!denoise.has_kernels()) return;
  if (spec.kind != ProgramSpec::Kind::kFull && spec.kind != ProgramSpec::Kind::kPath) {
    throw sim::InputError(fmt::format(
        "denoise.filter: atrous: the program {} has no tiles of whole pixels to filter; allowed: off, full:N, path:N",
        spec.name()));
  }
  // Kernels compute pixel numbers in floats.
  constexpr std::uint64_t kMostPixels = 1U << 24;
  if (std::uint64_t{render.width} * render.height > kMostPixels) {
    throw sim::InputError(fmt::format("denoise.filter: atrous: the picture has {} pixels; allowed: at most {}",
                                      std::uint64_t{render.width} * render.height, kMostPixels));
  }
}

namespace {

/// Adds the geometry pass of a rasteriser, if primary hits are rasterised.
std::unique_ptr<FrameProgram> add_geometry_pass(std::unique_ptr<FrameProgram> program, const ProgramSpec& spec,
                                                const Frame& f) {
  if (f.render.primary == Primary::kRays) return program;
  auto rasteriser =
      make_rasteriser(f.image, f.camera, f.render.width, f.render.height, f.render.raster, desired_tile_side(spec, f));
  return std::make_unique<GeometryPass>(std::move(program), std::move(rasteriser), f.number);
}

}  // namespace

std::unique_ptr<FrameProgram> make_program(const ProgramSpec& spec, const Frame& f) {
  std::unique_ptr<FrameProgram> program = add_geometry_pass(make_plain_program(spec, f), spec, f);
  if (f.builds == nullptr) return program;
  return std::make_unique<BuildPass>(std::move(program), f.image, *f.builds, f.number);
}

}  // namespace kernels
