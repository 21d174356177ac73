#include "shader_kernels/programs/path_program.h"

#include "shader_kernels/kernels/path.h"
#include "shader_kernels/programs/path/path_tracer.h"

namespace kernels {
namespace {

/// Returns the configuration without the weight at which Whitted's paths end: roulette ends paths instead.
RenderConfig without_least_weight(RenderConfig config) {
  config.min_weight = 0;
  return config;
}

}  // namespace

PathProgram::PathProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                         const PathConfig& path, std::uint32_t samples, std::uint32_t frame, const PixelSink* sink)
    : FullProgram(image, camera, without_least_weight(config), samples, frame, sink), path_(path) {}

void PathProgram::shade_rays(Wavefront& wave, const GeneratePorts<float>& ports, Wavefront::Node generated,
                             std::uint32_t samples, const RetainedRecords& retained) const {
  PathTracer(wave, path_).run(ports, generated, samples, retained);
}

Wavefront::Node PathProgram::average_samples(TileGraph& graph, AverageColour::Ports<float>& ports,
                                             std::uint32_t samples) const {
  return graph.launch<AveragePaths>(ports, samples);
}

}  // namespace kernels
