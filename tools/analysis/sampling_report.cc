#include "tools/analysis/sampling_report.h"

#include <cmath>
#include <string_view>

#include "hw_models/srp/srp.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"
#include "sim/io/json.h"
#include "tools/analysis/report.h"
#include "tools/analysis/units.h"

namespace tools {
namespace {

struct Named {
  std::string_view begins;  ///< prefix of the kernel's name
  KernelGroup group;
};

/// All other kernels trace and shade.
constexpr Named kGroups[] = {{"check_", KernelGroup::kCheck},
                             {"test_subpixels", KernelGroup::kCheck},
                             {"list_contrasts", KernelGroup::kCheck},
                             {"interpolate_", KernelGroup::kInterpolation},
                             {"find_suspects", KernelGroup::kCorrection},
                             {"store_identities", KernelGroup::kCorrection},
                             {"show_subpixels", KernelGroup::kCorrection},
                             {"settle_subpixels", KernelGroup::kCorrection},
                             {"propagate_subpixels", KernelGroup::kCorrection},
                             {"average_subpixels", KernelGroup::kCorrection},
                             {"average_contrasts", KernelGroup::kCorrection}};

KernelGroup group_of(std::string_view kernel) {
  for (const Named& named : kGroups) {
    if (kernel.starts_with(named.begins)) return named.group;
  }
  return KernelGroup::kTracing;
}

/// Returns the share of a kernel's cycles in a group: 0 or 1; for a fused kernel by the operations of its parts.
double part_of(std::string_view kernel, KernelGroup group) {
  const kernels::KernelInfo* info = kernels::find_kernel(kernel);
  if (info == nullptr || info->parts.empty()) return group_of(kernel) == group ? 1 : 0;
  double all = 0, those = 0;
  for (const std::string_view part : info->parts) {
    const double ops = kernels::count_executed_ops(kernels::find_kernel(part)->graph);
    all += ops;
    if (group_of(part) == group) those += ops;
  }
  return those / all;
}

}  // namespace

std::optional<double> kernel_share(const FrameResult& run, KernelGroup group) {
  double all = 0, those = 0;
  for (std::size_t k = 0; k < run.kernels.size(); ++k) {
    const auto cycles = static_cast<double>(run.kernel_use[k].cycles);
    all += cycles;
    those += cycles * part_of(run.kernels[k].kernel, group);
  }
  if (all == 0) return {};
  return those / all;
}

std::optional<double> starved_share(const FrameResult& run) {
  const std::uint64_t elapsed = Units<hw::Srp>(run.units).elapsed();
  double starved = 0;
  for (std::size_t k = 0; k < run.kernels.size(); ++k) {
    const std::string_view kernel = run.kernels[k].kernel;
    const double part = part_of(kernel, KernelGroup::kCheck) + part_of(kernel, KernelGroup::kInterpolation);
    starved += part * static_cast<double>(run.kernel_use[k].starved);
  }
  if (elapsed == 0) return {};
  return starved / static_cast<double>(elapsed);
}

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

Json sampling_json(const FrameResult& run) {
  const kernels::Sampling& s = run.rendered.sampling;
  Json out = {{"wanted", s.wanted},         {"traced", s.traced},         {"halo", s.halo},
              {"correction", s.correction}, {"background", s.background}, {"traced_background", s.traced_background}};
  if (s.wanted > s.background) {
    out["traced_ratio_without_background"] = share_of(s.traced - s.traced_background, s.wanted - s.background);
  }
  const bool is_subdivided = run.program.kind == kernels::ProgramSpec::Kind::kSupersample;
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
  add("check_share", kernel_share(run, KernelGroup::kCheck));
  add("interpolation_share", kernel_share(run, KernelGroup::kInterpolation));
  add("correction_share", kernel_share(run, KernelGroup::kCorrection));
  add("starved_share", starved_share(run));
  return out;
}

Json tiles_json(const kernels::Sampling& sampling) {
  Json similar = Json::array();
  for (const float share : sampling.similar) similar.push_back(std::round(1e4 * share) / 1e4);
  return {{"side", sampling.tile_side}, {"similar_ratio", std::move(similar)}, {"blocks", sampling.blocks}};
}

}  // namespace tools
