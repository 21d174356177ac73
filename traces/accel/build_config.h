#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "sim/config/field.h"
#include "sim/named.h"

namespace traces {

/// What builds and refits the trees of moving scenes.
enum class BuildEngine : std::uint8_t {
  kHost,  ///< the host, free of charge
  kSrp,   ///< kernels on the shader cores (shader_kernels/programs/build_kernels.h)
  kUnit,  ///< the machine's tree builder (hw_models/build)
};
constexpr std::array<std::string_view, 3> names_of(BuildEngine) { return {"host", "srp", "unit"}; }

/// When the tree of a moving scene is rebuilt; otherwise it is refitted.
enum class BuildPolicy : std::uint8_t {
  kUpdate,   ///< rebuilt or refitted as the key bvh.update selects
  kRefit,    ///< never after the first frame
  kRebuild,  ///< each frame
  kPeriod,   ///< each frame whose number is a multiple of `period`
  kCost,     ///< after a frame in which the tree's expected cost has grown by the share `cost_growth`
};
constexpr std::array<std::string_view, 5> names_of(BuildPolicy) {
  return {"update", "refit", "rebuild", "period", "cost"};
}

/// Whether rays wait for the frame's trees.
enum class BuildOverlap : std::uint8_t {
  kOff,  ///< trees are finished before the first tile of their frame
  kOn,   ///< trees are built while the tiles of the previous frame are traced
};
constexpr std::array<std::string_view, 2> names_of(BuildOverlap) { return {"off", "on"}; }

/// Configuration keys for building the trees of moving scenes.
struct BuildConfig {
  BuildEngine engine = BuildEngine::kHost;
  BuildPolicy policy = BuildPolicy::kUpdate;
  std::uint32_t period = 8;
  double cost_growth = 0.3;
  BuildOverlap overlap = BuildOverlap::kOff;

  static void describe(auto& c, auto&& field) {
    using enum sim::Affects;
    field(NAMED(c.engine), "",
          "what builds and refits trees of moving scenes: the host, free of charge, kernels on the shader cores, or a "
          "unit",
          sim::any(), kFunction);
    field(NAMED(c.policy), "",
          "when the tree of a moving scene is rebuilt instead of refitted: as bvh.update selects, never, each frame, "
          "every `period` frames, or once its cost has grown by `cost_growth`",
          sim::any(), kFunction);
    field(NAMED(c.period), "frames", "frames from one rebuild to the next (policy: period)", sim::between(1, 1000000),
          kFunction);
    field(NAMED(c.cost_growth), "", "growth of the tree's SAH cost since the last rebuild (policy: cost)",
          sim::between(0, 1000), kFunction);
    field(NAMED(c.overlap), "",
          "trees are built before their frame's tiles, or during the previous frame's, into a second copy", sim::any(),
          kFunction);
  }
  void check(auto&& complain) const {
    if (engine == BuildEngine::kSrp && overlap == BuildOverlap::kOn) {
      complain("overlap", "is on, but shader cores trace the tiles; allowed with engine: srp: off");
    }
  }
};

}  // namespace traces
