#pragma once
#include <cstdint>

#include "shader_kernels/kernels/denoise.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Returns the projection of a camera.
ProjectionUniforms<float> projection_of(const CameraUniforms<float>& camera);

/// What the kernels that record guides need.
struct GuideUniforms {
  MotionUniforms<float> motion{};
  bool has_moved = false;  ///< triangles moved since the previous frame
  const std::uint32_t* region = nullptr;
  std::uint64_t past_word = 0;  ///< first word in `region` of the triangles' previous corners
};

/// Launches the kernel that records the guides of first hits, over the surfaces of a bounce.
LaunchResult launch_guides(const WaveContext& wave, const WaveBounce& bounce, const StageInput& in);
inline constexpr WaveStage kGuides{&StageQueues::surfaces, launch_guides, WaitsFor::kBounce, kRecordsHits};

}  // namespace kernels
