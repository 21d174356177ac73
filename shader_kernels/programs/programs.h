#pragma once
#include <cstdint>
#include <memory>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/adaptive/rate_map.h"
#include "shader_kernels/programs/denoise/denoise_config.h"
#include "shader_kernels/programs/path/path_config.h"
#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"
#include "traces/accel/tree_builds.h"
#include "traces/scene/scene.h"

namespace kernels {

/// Configuration keys of the frame programs, with one group for each program.
struct ProgramConfig {
  MultirateConfig multirate;
  ReconstructConfig reconstruct;
  SupersampleConfig supersample;
  UndersampleConfig undersample;
  DenoiseConfig denoise;
  PathConfig path;

  static void describe(auto& c, auto&& field) {
    field.group(NAMED(c.multirate), "frame programs multirate:under and multirate:super");
    field.group(NAMED(c.undersample), "frame program undersample");
    field.group(NAMED(c.supersample), "frame program supersample");
    field.group(NAMED(c.reconstruct), "frame programs reconstruct and reconstruct:sraa");
    field.group(NAMED(c.denoise), "filter of a frame's noise");
    field.group(NAMED(c.path), "frame program path:N");
  }
};

/// What a frame program renders. The image and the rates must outlive the program.
struct Frame {
  const traces::MemoryImage& image;
  const traces::Camera& camera;
  const RenderConfig& render;
  const ProgramConfig& programs;
  const RateMap& rates;
  std::uint32_t number = 0;
  float scene_size = 1;                        ///< longest side of the scene's bounds, in frame 0
  const traces::TreeBuilds* builds = nullptr;  ///< trees that the machine builds; null: the host builds them
  const DenoiseHistory* history = nullptr;     ///< of the previous frame, for the denoiser; null: none
};

/// Throws InputError if the program cannot be denoised as configured.
void check_denoise(const ProgramSpec& spec, const RenderConfig& render, const DenoiseConfig& denoise);

std::unique_ptr<FrameProgram> make_program(const ProgramSpec& spec, const Frame& frame);

}  // namespace kernels
