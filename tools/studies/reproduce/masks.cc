#include "tools/studies/reproduce/masks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shader_kernels/programs/wavefront/wavefront.h"
#include "tools/analysis/picture.h"
#include "tools/host/parallel.h"
#include "traces/accel/bvh_tracer.h"

namespace tools::reproduce {
namespace {

constexpr std::uint32_t kGrid = 4, kSamples = kGrid * kGrid;
constexpr float kSameNormal = 0.9F;  ///< as in the checks of adaptive sampling
constexpr float kTextureContrast = 0.1F;

/// Traces and shades the samples of pixel rows, and classifies the pixels.
class RowClassifier {
 public:
  explicit RowClassifier(const Inputs& inputs)
      : config_(inputs.config.render),
        scene_(inputs.image, config_),
        camera_(kernels::camera_uniforms(inputs.camera, config_.width, config_.height)),
        tracer_(inputs.image) {}

  void classify_row(std::uint32_t y, kernels::TileResult& out, Mask* row) const {
    const std::uint32_t pitch = kGrid * config_.width, samples = pitch * kGrid;
    out.buffer.reserve_samples(samples);
    out.buffer.reserve_wave(samples);
    std::iota(out.buffer.checks.samples.entries.begin(), out.buffer.checks.samples.entries.end(), 0U);
    kernels::Wavefront wave(scene_, tracer_, false, kernels::cone_uniforms(camera_, kGrid), out);
    kernels::GenerateListedRays::Ports<float> ports;
    ports.camera = camera_;
    ports.grid = {.x0 = 0,
                  .y0 = static_cast<float>(kGrid * y),
                  .pitch = static_cast<float>(pitch),
                  .inverse_pitch = 1.0F / static_cast<float>(pitch),
                  .grid = kGrid,
                  .inverse_grid = 1.0F / kGrid};
    kernels::RetainedRecords retained;
    retained.geometry = retained.secondary = true;
    const auto made =
        wave.generate_listed_rays(ports, out.buffer.checks.samples, kernels::Wavefront::kNone, samples, retained);
    wave.run(made, samples, retained);
    for (std::uint32_t x = 0; x < config_.width; ++x) row[x] = classify_pixel(x, pitch, out);
  }

 private:
  static Mask classify_pixel(std::uint32_t x, std::uint32_t pitch, const kernels::TileResult& out) {
    const auto any = [&](auto&& differs) {
      for (std::uint32_t i = 1; i < kSamples; ++i) {
        if (differs(kGrid * x, i / kGrid * pitch + kGrid * x + i % kGrid)) return true;
      }
      return false;
    };
    const kernels::TileBuffer& found = out.buffer;
    const auto& geometry = found.samples.geometry;
    const auto& secondary = found.samples.secondary;
    if (any([&](std::uint32_t a, std::uint32_t b) {
          return geometry[a].object != geometry[b].object || dot(geometry[a].normal, geometry[b].normal) < kSameNormal;
        })) {
      return Mask::kObjectEdge;
    }
    if (any([&](std::uint32_t a, std::uint32_t b) { return geometry[a].shadows != geometry[b].shadows; })) {
      return Mask::kShadowEdge;
    }
    if (any([&](std::uint32_t a, std::uint32_t b) {
          return secondary[a].objects != secondary[b].objects || secondary[a].shadows != secondary[b].shadows;
        })) {
      return Mask::kReflectionEdge;
    }
    const bool is_textured = (geometry[std::size_t{kGrid} * x].object & kernels::kTexturedObject) != 0;
    const bool is_edge = is_textured && any([&](std::uint32_t a, std::uint32_t b) {
                           const glm::vec3 one = out.averaged_colour(a), other = out.averaged_colour(b);
                           float most = 0;
                           for (int c = 0; c < 3; ++c)
                             most = std::max(most, std::abs(srgb_encoded(one[c]) - srgb_encoded(other[c])));
                           return most > kTextureContrast;
                         });
    return is_edge ? Mask::kTextureEdge : Mask::kElsewhere;
  }

  const kernels::RenderConfig config_;
  const kernels::SceneTables scene_;
  const kernels::CameraUniforms<float> camera_;
  const traces::BvhTracer tracer_;
};

}  // namespace

std::vector<Mask> masks_of(const Inputs& inputs, std::uint32_t threads) {
  const RowClassifier classifier(inputs);
  const std::uint32_t width = inputs.config.render.width, height = inputs.config.render.height;
  std::vector<Mask> masks(std::size_t{width} * height);
  const std::uint32_t workers = std::max(1U, threads);
  run_on_threads(workers, [&](std::size_t worker) {
    kernels::TileResult out;
    for (auto y = static_cast<std::uint32_t>(worker); y < height; y += workers) {
      classifier.classify_row(y, out, masks.data() + std::size_t{y} * width);
    }
  });
  return masks;
}

MaskedErrors masked_errors(std::span<const Mask> masks, std::span<const float> a, std::span<const float> b) {
  std::array<std::vector<float>, static_cast<std::size_t>(Mask::kCount)> ours, theirs;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const auto of = static_cast<std::size_t>(masks[i]);
    ours[of].insert(ours[of].end(), a.begin() + static_cast<std::ptrdiff_t>(3 * i),
                    a.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
    theirs[of].insert(theirs[of].end(), b.begin() + static_cast<std::ptrdiff_t>(3 * i),
                      b.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
  }
  MaskedErrors errors;
  for (std::size_t m = 0; m < errors.size(); ++m) {
    if (!ours[m].empty()) errors[m] = mean_squared_error(ours[m], theirs[m]);
  }
  return errors;
}

}  // namespace tools::reproduce
