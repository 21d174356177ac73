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
    {"cornell", 3, 5.79},     // l2.mshrs
    {"cornell", 17, 1.34},    // dram.channels
    {"cornell", 31, 1.30},    // tni.trv.l1.size
    {"cornell", 35, 2.90},    // dram.channels
    {"cornell", 43, 9.48},    // l2.size
    {"cornell", 66, 3.41},    // l2.mshrs
    {"cornell", 78, 6.73},    // srp.data_cache.size
    {"cornell", 99, 5.95},    // tni.trv.l1.mshrs
    {"cornell", 109, 1.29},   // tni.ist.l1.mshrs
    {"cornell", 117, 2.78},   // tni.trv.l1.mshrs
    {"cornell", 123, 4.42},   // srp.data_cache.size
    {"cornell", 133, 2.52},   // l2.size
    {"cornell", 154, 19.06},  // tni.ist.l1.mshrs
    {"cornell", 156, 1.03},   // l2.mshrs
    {"cornell", 169, 1.52},   // l2.size
    {"cornell", 177, 8.18},   // srp.data_cache.size
    {"cornell", 183, 1.57},   // l2.mshrs
    {"cornell", 184, 1.24},   // tni.trv.l1.size
    {"cornell", 189, 1.86},   // tni.trv.l1.mshrs
    {"cornell", 192, 1.18},   // l2.mshrs
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
