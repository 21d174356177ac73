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
    {"cornell", 13, 3.45},    // tni.trv.l1.size
    {"cornell", 24, 7.66},    // srp.data_cache.size
    {"cornell", 25, 1.64},    // l2.size
    {"cornell", 30, 1.33},    // l2.mshrs
    {"cornell", 42, 1.18},    // srp.data_cache.size
    {"cornell", 63, 1.50},    // tni.trv.l1.mshrs
    {"cornell", 68, 1.64},    // tni.ist.l1.size
    {"cornell", 73, 2.17},    // tni.ist.l1.mshrs
    {"cornell", 75, 1.61},    // l2.mshrs
    {"cornell", 78, 4.87},    // srp.data_cache.size
    {"cornell", 87, 1.64},    // srp.data_cache.size
    {"cornell", 90, 1.51},    // tni.trv.l1.mshrs
    {"cornell", 102, 1.94},   // l2.mshrs
    {"cornell", 105, 2.08},   // srp.data_cache.size
    {"cornell", 107, 6.66},   // dram.channels
    {"cornell", 117, 1.03},   // tni.trv.l1.mshrs
    {"cornell", 121, 4.20},   // tni.trv.l1.size
    {"cornell", 139, 10.83},  // tni.trv.l1.size
    {"cornell", 169, 1.03},   // l2.size
    {"cornell", 184, 2.42},   // tni.trv.l1.size
    {"cornell", 186, 1.41},   // srp.data_cache.size
    {"cornell", 192, 1.30},   // l2.mshrs
    {"chess", 0, 1.89},      // tni.trv.l1.mshrs
    {"chess", 3, 1.63},       // l2.mshrs
    {"chess", 6, 1.78},       // srp.data_cache.size
    {"chess", 10, 1.07},      // tni.ist.l1.mshrs
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
