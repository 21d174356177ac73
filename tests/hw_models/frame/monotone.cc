#include "tests/hw_models/frame/monotone.h"

#include <algorithm>
#include <iterator>

namespace hw::testing {

const std::array<Improvement, 9> kImprovements = {{
    {"tni.trv.l1.mshrs", [](GpuConfig& c) { c.tni.trv.l1.mshrs *= 2; }},
    {"tni.ist.l1.mshrs", [](GpuConfig& c) { c.tni.ist.l1.mshrs *= 2; }},
    {"srp.data_cache.mshrs", [](GpuConfig& c) { c.srp.data_cache.mshrs *= 2; }},
    {"l2.mshrs", [](GpuConfig& c) { c.l2.cache.mshrs *= 2; }},
    {"tni.trv.l1.size", [](GpuConfig& c) { c.tni.trv.l1.size.bytes *= 2; }},
    {"tni.ist.l1.size", [](GpuConfig& c) { c.tni.ist.l1.size.bytes *= 2; }},
    {"srp.data_cache.size", [](GpuConfig& c) { c.srp.data_cache.size.bytes *= 2; }},
    {"l2.size", [](GpuConfig& c) { c.l2.cache.size.bytes *= 2; }},
    {"dram.channels", [](GpuConfig& c) { c.dram.channels *= 2; }},
}};

const Improvement& improvement_of(std::uint64_t seed) { return kImprovements[seed % kImprovements.size()]; }

namespace {

constexpr KnownSlower kKnownSlower[] = {
    {"cornell", 0, 24.03},  // tni.trv.l1.mshrs
    {"cornell", 3, 3.85},   // l2.mshrs
};

}  // namespace

const KnownSlower* known_slower(std::string_view scene, std::uint64_t seed) {
  const auto* const found = std::ranges::find_if(
      kKnownSlower, [&](const KnownSlower& known) { return known.scene == scene && known.seed == seed; });
  return found == std::end(kKnownSlower) ? nullptr : found;
}

}  // namespace hw::testing
