#pragma once
#include <cstdint>

#include "shader_kernels/programs/full.h"
#include "shader_kernels/programs/path/path_config.h"

namespace kernels {

/// Frame program path:N: traces N paths through every pixel (docs/paths.md).
///
///   generate_rays -> seed_paths -> PathTracer -> average_paths -> pack_colour -> transfer to the frame buffer
class PathProgram final : public FullProgram {
 public:
  PathProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
              const PathConfig& path, std::uint32_t samples, std::uint32_t frame, const PixelSink* sink = nullptr);

 protected:
  void shade_rays(Wavefront& wave, const GeneratePorts<float>& ports, Wavefront::Node generated, std::uint32_t samples,
                  const RetainedRecords& retained) const override;
  Wavefront::Node average_samples(TileGraph& graph, AverageColour::Ports<float>& ports,
                                  std::uint32_t samples) const override;

 private:
  const PathConfig path_;
};

}  // namespace kernels
