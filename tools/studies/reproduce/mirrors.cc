#include "tools/studies/reproduce/mirrors.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "shader_kernels/programs/program_spec.h"
#include "traces/accel/bvh_tracer.h"

namespace tools::reproduce {
namespace {

using traces::MaterialRecord;

constexpr float kMirrored = 0.3F;  ///< share of the light that what is made a mirror reflects
constexpr double kTolerance = 0.01;
constexpr std::uint32_t kProbePixels = 96;  ///< width of the picture that shares are counted in

void make_mirror(MaterialRecord& m) {
  m.mirrored = glm::vec3(kMirrored);
  m.diffuse_share = 1 - kMirrored;
  m.flags |= traces::kMirror;
}

void make_dull(MaterialRecord& m) {
  m.mirrored = glm::vec3(0);
  m.diffuse_share = 1;
  m.flags = (m.flags & ~std::uint32_t{traces::kMirror}) | traces::kDiffuse;
}

bool is_fixed(const MaterialRecord& m) {
  constexpr std::uint32_t kOthers = traces::kGlass | traces::kPhysical | traces::kBlended;
  return m.entering > 0 || (m.flags & kOthers) != 0;
}

}  // namespace

double reflective_share(Inputs& inputs, std::uint32_t threads) {
  kernels::RenderConfig& config = inputs.config.render;
  const kernels::RenderConfig before = config;
  config.height = std::max(1U, kProbePixels * config.height / config.width);
  config.width = kProbePixels;
  config.depth = 2;
  const double pixels = static_cast<double>(config.width) * config.height;
  const RenderResult result = render_frame(inputs, {}, traces::BvhTracer(inputs.image), threads);
  config = before;
  return static_cast<double>(result.rays[static_cast<std::size_t>(traces::RayKind::kReflection)]) / pixels;
}

void set_reflective_share(Inputs& inputs, double share, std::uint32_t threads) {
  std::vector<MaterialRecord>& materials = inputs.image.materials;
  const std::vector<MaterialRecord> originals = materials;
  for (MaterialRecord& m : materials) {
    if (!is_fixed(m)) make_dull(m);
  }
  double reached = reflective_share(inputs, threads);
  const double of_glass = reached;

  std::vector<std::pair<double, std::size_t>> covers;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (is_fixed(materials[i])) continue;
    make_mirror(materials[i]);
    covers.emplace_back(reflective_share(inputs, threads) - of_glass, i);
    make_dull(materials[i]);
  }
  std::ranges::sort(covers, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  for (const auto& [cover, i] : covers) {
    if (reached + cover > share + kTolerance) continue;
    reached += cover;
    materials[i] = originals[i];
    if ((materials[i].flags & traces::kMirror) == 0) make_mirror(materials[i]);
  }
}

}  // namespace tools::reproduce
