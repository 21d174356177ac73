#include "tests/hw_models/machines/monotone.h"

#include <algorithm>
#include <iterator>

namespace hw::test {

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
    {"cornell", 0, 24.03},   // tni.trv.l1.mshrs
    {"cornell", 3, 3.85},    // l2.mshrs
    {"cornell", 27, 1.34},   // tni.trv.l1.mshrs
    {"cornell", 49, 1.02},   // tni.trv.l1.size
    {"cornell", 66, 3.45},   // l2.mshrs
    {"cornell", 77, 3.27},   // tni.ist.l1.size
    {"cornell", 78, 8.79},   // srp.data_cache.size
    {"cornell", 87, 1.70},   // srp.data_cache.size
    {"cornell", 90, 4.36},   // tni.trv.l1.mshrs
    {"cornell", 94, 1.02},   // tni.trv.l1.size
    {"cornell", 118, 2.38},  // tni.ist.l1.mshrs
    {"cornell", 132, 1.45},  // srp.data_cache.size
    {"cornell", 139, 1.03},  // tni.trv.l1.size
    {"cornell", 154, 2.33},  // tni.ist.l1.mshrs
    {"cornell", 156, 1.66},  // l2.mshrs
    {"cornell", 162, 2.56},  // tni.trv.l1.mshrs
    {"cornell", 171, 2.11},  // tni.trv.l1.mshrs
    {"cornell", 172, 1.92},  // tni.ist.l1.mshrs
    {"cornell", 173, 1.01},  // srp.data_cache.mshrs
    {"cornell", 195, 3.39},  // srp.data_cache.size
    {"chess", 24, 1.76},     // srp.data_cache.size
    {"chess", 25, 1.76},     // l2.size
    {"chess", 73, 6.74},     // tni.ist.l1.mshrs
    {"chess", 75, 1.05},     // l2.mshrs
    {"chess", 93, 3.77},     // l2.mshrs
    {"chess", 118, 2.25},    // tni.ist.l1.mshrs
    {"chess", 150, 1.62},    // srp.data_cache.size
    {"chess", 162, 1.63},    // tni.trv.l1.mshrs
};

}  // namespace

const KnownSlower* known_slower(std::string_view scene, std::uint64_t seed) {
  const auto* const found = std::ranges::find_if(
      kKnownSlower, [&](const KnownSlower& known) { return known.scene == scene && known.seed == seed; });
  return found == std::end(kKnownSlower) ? nullptr : found;
}

}  // namespace hw::test
