#include "shader_kernels/programs/full.h"

#include <algorithm>
#include <cmath>

#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {
namespace {

std::uint32_t tiles_along(std::uint32_t pixels, std::uint32_t side) { return (pixels + side - 1) / side; }

float reciprocal_of(std::uint32_t n) { return 1.0F / static_cast<float>(n); }

}  // namespace

FullProgram::FullProgram(const traces::MemoryImage& image, const traces::Camera& camera, const RenderConfig& config,
                         std::uint32_t samples, std::uint32_t frame, const PixelSink* sink)
    : FrameProgram(config.width, config.height),
      config_(config),
      scene_(image, config),
      camera_(camera_uniforms(camera, config.width, config.height)),
      samples_(samples),
      grid_(static_cast<std::uint32_t>(std::lround(std::sqrt(samples)))),
      frame_(frame),
      side_(std::max(1U, config.tile / grid_)),
      tiles_across_(tiles_along(config.width, side_)),
      tiles_down_(tiles_along(config.height, side_)),
      seed_(jitter_seed(frame)),
      sink_(sink) {}

FrameRequirements FullProgram::requirements() const {
  return {tile_samples(), 0, 0, 0, {std::uint64_t{tiles()} * tile_pixels() * kPixelBytes, 0, 0}};
}

void FullProgram::run_tile(std::uint32_t tile, const traces::Tracer& tracer, bool record, TileResult& out) const {
  out.tile = tile;
  out.x = tile % tiles_across_ * side_;
  out.y = tile / tiles_across_ * side_;
  out.width = std::min(side_, config_.width - out.x);
  out.height = std::min(side_, config_.height - out.y);
  const std::uint32_t pixels = out.width * out.height;
  const std::uint32_t samples = pixels * samples_;
  out.linear.resize(pixels);
  out.packed.resize(pixels);
  out.work.frame = frame_;
  out.work.tile = tile;
  out.work.samples = samples;
  out.buffer.reserve_wave(samples);
  if (out.buffer.samples.colours.size() < samples) out.buffer.samples.colours.resize(samples);

  Wavefront wave(scene_, tracer, record, cone_uniforms(camera_, grid_), out);
  TileGraph& graph = wave.tile_graph();
  GeneratePorts<float> generate;
  generate.camera = camera_;
  generate.tile = {.x0 = static_cast<float>(out.x),
                   .y0 = static_cast<float>(out.y),
                   .width = static_cast<float>(out.width),
                   .inverse_width = reciprocal_of(out.width),
                   .samples = static_cast<float>(samples_),
                   .inverse_samples = reciprocal_of(samples_),
                   .grid = static_cast<float>(grid_),
                   .inverse_grid = reciprocal_of(grid_)};
  generate.image_width = config_.width;
  generate.seed = seed_;
  const Wavefront::Node generated = launch_rays(graph, generate, samples);
  if (wave.wave_tracer().counts_pixels()) {
    for (std::uint32_t i = 0; i < samples; ++i) {
      const std::uint32_t pixel = i / samples_;
      wave.wave_tracer().assign_ray_to_pixel(i, out.x + pixel % out.width, out.y + pixel / out.width);
    }
  }
  RetainedRecords retained;
  if (sink_ != nullptr) sink_->begin_rays(graph, generated, samples, samples, out, retained);
  shade_rays(wave, generate, generated, samples, retained);

  sink_ != nullptr ? sink_->write_tile(graph, samples, samples_, out) : write_pixels(graph, samples, out);
  wave.finish();
  out.sampling = {};
  out.sampling.wanted = out.sampling.traced = samples;
  out.sampling.background = out.sampling.traced_background = out.background.size();
}

void FullProgram::shade_rays(Wavefront& wave, const GeneratePorts<float>& /*ports*/, Wavefront::Node generated,
                             std::uint32_t samples, const RetainedRecords& retained) const {
  wave.run(generated, samples, retained);
}

Wavefront::Node FullProgram::average_samples(TileGraph& graph, AverageColour::Ports<float>& ports,
                                             std::uint32_t samples) const {
  return graph.launch<AverageColour>(ports, samples);
}

Wavefront::Node FullProgram::launch_rays(TileGraph& graph, GeneratePorts<float>& ports, std::uint32_t samples) const {
  if (samples_ == 1 || config_.samples == SamplePattern::kRegular) {  // a single sample is always at the pixel's centre
    return graph.launch<GenerateRays>(ports, samples);
  }
  if (config_.samples == SamplePattern::kJittered) return graph.launch<GenerateJitteredRays>(ports, samples);
  GenerateRotatedRays::Ports<float> rotated;
  static_cast<GeneratePorts<float>&>(rotated) = ports;
  rotated.cycle = static_cast<float>(samples_ + 1);
  rotated.inverse_cycle = reciprocal_of(samples_ + 1);
  return graph.launch<GenerateRotatedRays>(rotated, samples);
}

void FullProgram::write_pixels(TileGraph& graph, std::uint32_t samples, TileResult& out) const {
  const std::uint64_t offset = std::uint64_t{out.tile} * tile_pixels() * kPixelBytes;
  if (scene_.dma_encodes && samples_ == 1) {
    for (std::uint32_t i = 0; i < samples; ++i) out.linear[i] = out.averaged_colour(i);
    graph.wait_for_colour_writers(graph.write_linear_pixels(offset));
    return;
  }
  if (scene_.fuses && samples_ == 1) {
    const Wavefront::Node packed = graph.launch<PackSample>(samples);
    graph.wait_for_colour_writers(packed);
    graph.write_packed_pixels(packed, offset);
    return;
  }
  AverageColour::Ports<float> average;
  average.samples = static_cast<float>(samples_);
  average.inverse_samples = reciprocal_of(samples_);
  const Wavefront::Node averaged = average_samples(graph, average, samples);
  graph.wait_for_colour_writers(averaged);
  graph.write_pixels(averaged, offset);
}

}  // namespace kernels
