#include <cmath>

#include "sim/io/json.h"
#include "tools/analysis/kernel_shares.h"
#include "tools/analysis/report.h"

namespace tools {

using sim::Json;

namespace {

double share_of(std::uint64_t part, std::uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

Json named_counts(const auto& names, const auto& counts) {
  Json out = Json::object();
  for (std::size_t i = 0; i < counts.size(); ++i) out[names[i]] = counts[i];
  return out;
}

}  // namespace

Json sampling_json(const FrameResult& simulation) {
  const kernels::Sampling& s = simulation.function.sampling;
  Json out = {{"wanted", s.wanted},         {"traced", s.traced},         {"halo", s.halo},
              {"correction", s.correction}, {"background", s.background}, {"traced_background", s.traced_background}};
  if (s.wanted > s.background) {
    out["traced_ratio_without_background"] = share_of(s.traced - s.traced_background, s.wanted - s.background);
  }
  const bool is_subdivided = simulation.program.kind == kernels::ProgramSpec::Kind::kSupersample;
  if (is_subdivided) {
    out["active"] = s.active;
    out["reasons"] = named_counts(names_of(kernels::Attribute{}), s.reasons);
    out["first_reasons"] = named_counts(names_of(kernels::Attribute{}), s.first_reasons);
    out["padding"] = s.padding;
    if (s.propagated != 0) out["propagated"] = s.propagated;
  }
  if (s.checked != 0) {
    out["checked"] = s.checked;
    out["passed"] = s.passed;
    out["similar_ratio"] = share_of(s.passed, s.checked);
    if (s.rough != 0) out["rough"] = s.rough;
    out["failed"] = named_counts(names_of(kernels::Check{}), s.failed);
    out["first_failed"] = named_counts(names_of(kernels::Check{}), s.first_failed);
  }
  if (!is_subdivided && s.checked == 0) return out;
  const auto add = [&](const char* key, const std::optional<double>& share) {
    if (share) out[key] = *share;
  };
  add("check_share", kernel_share(simulation, KernelGroup::kCheck));
  add("interpolation_share", kernel_share(simulation, KernelGroup::kInterpolation));
  add("correction_share", kernel_share(simulation, KernelGroup::kCorrection));
  add("starved_share", starved_share(simulation));
  return out;
}

Json tiles_json(const kernels::Sampling& sampling) {
  Json similar = Json::array();
  for (const float share : sampling.similar) similar.push_back(std::round(1e4 * share) / 1e4);
  return {{"side", sampling.tile_side}, {"similar_ratio", std::move(similar)}, {"blocks", sampling.blocks}};
}

}  // namespace tools
