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
    {"cornell", 3, 6.59},     // l2.mshrs
    {"cornell", 17, 1.34},    // dram.channels
    {"cornell", 24, 7.96},    // srp.data_cache.size
    {"cornell", 25, 1.82},    // l2.size
    {"cornell", 35, 2.90},    // dram.channels
    {"cornell", 40, 1.08},    // tni.trv.l1.size
    {"cornell", 42, 2.85},    // srp.data_cache.size
    {"cornell", 43, 6.86},    // l2.size
    {"cornell", 66, 7.13},    // l2.mshrs
    {"cornell", 91, 4.95},    // tni.ist.l1.mshrs
    {"cornell", 99, 5.95},    // tni.trv.l1.mshrs
    {"cornell", 107, 2.44},   // dram.channels
    {"cornell", 117, 3.51},   // tni.trv.l1.mshrs
    {"cornell", 118, 1.57},   // tni.ist.l1.mshrs
    {"cornell", 133, 4.74},   // l2.size
    {"cornell", 152, 4.05},   // dram.channels
    {"cornell", 154, 15.77},  // tni.ist.l1.mshrs
    {"cornell", 167, 2.38},   // tni.ist.l1.size
    {"cornell", 173, 2.47},   // srp.data_cache.mshrs
    {"cornell", 183, 1.85},   // l2.mshrs
    {"cornell", 184, 1.24},   // tni.trv.l1.size
    {"cornell", 189, 1.86},   // tni.trv.l1.mshrs
    {"chess", 0, 1.89},       // tni.trv.l1.mshrs
    {"chess", 57, 1.31},      // l2.mshrs
    {"chess", 58, 1.08},      // tni.trv.l1.size
    {"chess", 69, 3.45},      // srp.data_cache.size
    {"chess", 73, 7.85},      // tni.ist.l1.mshrs
    {"chess", 90, 2.15},      // tni.trv.l1.mshrs
    {"chess", 139, 2.58},     // tni.trv.l1.size
    {"chess", 154, 1.88},     // tni.ist.l1.mshrs
    {"chess", 162, 2.26},     // tni.trv.l1.mshrs
    {"chess", 167, 2.42},     // tni.ist.l1.size
    {"chess", 195, 1.16},     // srp.data_cache.size
};

}  // namespace

const KnownSlower* known_slower(std::string_view scene, std::uint64_t seed) {
  const auto* const found = std::ranges::find_if(
      kKnownSlower, [&](const KnownSlower& known) { return known.scene == scene && known.seed == seed; });
  return found == std::end(kKnownSlower) ? nullptr : found;
}

}  // namespace hw::test
