#include "tools/analysis/kernel_shares.h"

#include <string_view>

#include "hw_models/srp/srp.h"
#include "tools/analysis/units.h"

namespace tools {
namespace {

struct Named {
  std::string_view begins;  ///< the kernel's name, or how it begins
  KernelGroup group;
};

/// All others trace and shade.
constexpr Named kGroups[] = {{"check_", KernelGroup::kCheck},
                             {"test_subpixels", KernelGroup::kCheck},
                             {"interpolate_", KernelGroup::kInterpolation},
                             {"find_suspects", KernelGroup::kCorrection},
                             {"store_identities", KernelGroup::kCorrection}};

KernelGroup group_of(std::string_view kernel) {
  for (const Named& named : kGroups) {
    if (kernel.starts_with(named.begins)) return named.group;
  }
  return KernelGroup::kTracing;
}

}  // namespace

std::optional<double> kernel_share(const Simulation& simulation, KernelGroup group) {
  std::uint64_t all = 0, those = 0;
  for (std::size_t k = 0; k < simulation.kernels.size(); ++k) {
    const std::uint64_t cycles = simulation.kernel_use[k].cycles;
    all += cycles;
    if (group_of(simulation.kernels[k].kernel) == group) those += cycles;
  }
  if (all == 0) return {};
  return static_cast<double>(those) / static_cast<double>(all);
}

std::optional<double> starved_share(const Simulation& simulation) {
  const std::uint64_t elapsed = Units<hw::Srp>(simulation.units).elapsed();
  std::uint64_t starved = 0;
  for (std::size_t k = 0; k < simulation.kernels.size(); ++k) {
    const KernelGroup group = group_of(simulation.kernels[k].kernel);
    if (group == KernelGroup::kCheck || group == KernelGroup::kInterpolation)
      starved += simulation.kernel_use[k].starved;
  }
  if (elapsed == 0) return {};
  return static_cast<double>(starved) / static_cast<double>(elapsed);
}

}  // namespace tools
