#include "tools/analysis/kernel_shares.h"

#include <string_view>

#include "hw_models/srp/srp.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"
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
    const double ops = kernels::executed_ops(kernels::find_kernel(part)->graph);
    all += ops;
    if (group_of(part) == group) those += ops;
  }
  return those / all;
}

}  // namespace

std::optional<double> kernel_share(const FrameResult& simulation, KernelGroup group) {
  double all = 0, those = 0;
  for (std::size_t k = 0; k < simulation.kernels.size(); ++k) {
    const auto cycles = static_cast<double>(simulation.kernel_use[k].cycles);
    all += cycles;
    those += cycles * part_of(simulation.kernels[k].kernel, group);
  }
  if (all == 0) return {};
  return those / all;
}

std::optional<double> starved_share(const FrameResult& simulation) {
  const std::uint64_t elapsed = Units<hw::Srp>(simulation.units).elapsed();
  double starved = 0;
  for (std::size_t k = 0; k < simulation.kernels.size(); ++k) {
    const std::string_view kernel = simulation.kernels[k].kernel;
    const double part = part_of(kernel, KernelGroup::kCheck) + part_of(kernel, KernelGroup::kInterpolation);
    starved += part * static_cast<double>(simulation.kernel_use[k].starved);
  }
  if (elapsed == 0) return {};
  return starved / static_cast<double>(elapsed);
}

}  // namespace tools
