#pragma once
#include <array>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/sample_grid.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Clamps a shaded sample's colour, whose parts are filtered one by one: what its surface shows, then the branches. The
/// parts' sum is the clamped colour.
template <std::uint32_t kBranches>
struct LimitColours {
  static constexpr std::array<std::string_view, 3> kNames{"limit_colours", "limit_colours_branch",
                                                          "limit_colours_branches"};
  static constexpr std::string_view kName = kNames[kBranches];
  static constexpr std::string_view kMeaning = "shaded sample -> parts of its colour that sum to at most 1";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> colours;
    LatticeUniforms<V> lattice;
    I<V> branch;  ///< from a sample to that of its next branch
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.colours));
      LatticeUniforms<V>::describe(p.lattice, port);
      if constexpr (kBranches != 0) port(NAMED(p.branch));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    I<V> sample = lattice_sample<V>(item, at.lattice);
    const auto limited = [](const Vec3<V>& a) { return Vec3<V>{min(a.x, 1.0F), min(a.y, 1.0F), min(a.z, 1.0F)}; };
    Vec3<V> sum = limited(at.colours.load(sample).rgb);
    at.colours.store(sample, {sum});
    for (std::uint32_t branch = 0; branch < kBranches; ++branch) {
      sample = sample + at.branch;
      const Vec3<V> next = limited(sum + at.colours.load(sample).rgb);
      at.colours.store(sample, {next - sum});
      sum = next;
    }
  }
};

}  // namespace kernels
