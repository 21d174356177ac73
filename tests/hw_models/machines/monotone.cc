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
    {"cornell", 6, 1.02},     // srp.data_cache.size
    {"cornell", 17, 1.34},    // dram.channels
    {"cornell", 27, 2.98},    // tni.trv.l1.mshrs
    {"cornell", 31, 1.30},    // tni.trv.l1.size
    {"cornell", 35, 2.90},    // dram.channels
    {"cornell", 40, 1.29},    // tni.trv.l1.size
    {"cornell", 43, 9.19},    // l2.size
    {"cornell", 55, 1.30},    // tni.ist.l1.mshrs
    {"cornell", 66, 2.82},    // l2.mshrs
    {"cornell", 78, 3.58},    // srp.data_cache.size
    {"cornell", 84, 1.96},    // l2.mshrs
    {"cornell", 99, 5.95},    // tni.trv.l1.mshrs
    {"cornell", 117, 2.78},   // tni.trv.l1.mshrs
    {"cornell", 118, 1.92},   // tni.ist.l1.mshrs
    {"cornell", 123, 4.42},   // srp.data_cache.size
    {"cornell", 133, 2.52},   // l2.size
    {"cornell", 154, 13.82},  // tni.ist.l1.mshrs
    {"cornell", 156, 1.03},   // l2.mshrs
    {"cornell", 158, 2.80},   // tni.ist.l1.size
    {"cornell", 169, 2.87},   // l2.size
    {"cornell", 177, 8.71},   // srp.data_cache.size
    {"cornell", 183, 1.57},   // l2.mshrs
    {"cornell", 184, 1.24},   // tni.trv.l1.size
    {"cornell", 187, 1.69},   // l2.size
    {"cornell", 189, 1.86},   // tni.trv.l1.mshrs
    {"cornell", 193, 2.03},   // tni.trv.l1.size
    {"chess", 10, 1.30},      // tni.ist.l1.mshrs
    {"chess", 84, 1.37},      // l2.mshrs
    {"chess", 117, 1.00},     // tni.trv.l1.mshrs
    {"chess", 118, 1.80},     // tni.ist.l1.mshrs
    {"chess", 150, 2.43},     // srp.data_cache.size
    {"chess", 167, 6.38},     // tni.ist.l1.size
    {"chess", 173, 2.62},     // srp.data_cache.mshrs
    {"chess", 182, 1.52},     // srp.data_cache.mshrs
    {"chess", 199, 2.24},     // tni.ist.l1.mshrs
};

}  // namespace

const KnownSlower* known_slower(std::string_view scene, std::uint64_t seed) {
  const auto* const found = std::ranges::find_if(
      kKnownSlower, [&](const KnownSlower& known) { return known.scene == scene && known.seed == seed; });
  return found == std::end(kKnownSlower) ? nullptr : found;
}

}  // namespace hw::test
