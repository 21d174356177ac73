#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "sim/named.h"

namespace kernels {

/// Way in which active sub-pixels are listed for the kernels that sample them.
enum class Packing : std::uint8_t { kBlock, kAtomic, kNone };
constexpr std::array<std::string_view, 3> names_of(Packing) { return {"block", "atomic", "none"}; }

/// The colour of sub-pixels that are not active.
enum class SubpixelFilter : std::uint8_t { kNearest, kBilinear };
constexpr std::array<std::string_view, 2> names_of(SubpixelFilter) { return {"nearest", "bilinear"}; }

/// Rounds that a frame may have: each is a pass over all of it.
inline constexpr std::uint32_t kMostRounds = 14;

/// Selective and adaptive supersampling (Jin et al. 2009). A threshold applies where its attribute disagrees: 0 always
/// asks for more samples, 1 never does, -1 leaves the attribute out of the comparison. All of it changes the recorded
/// work.
struct SupersampleConfig : AdaptiveConfig {
  double colour = 0.6;
  double object = 0.05, normal = 0.06, shadow = 0.06, texture = 0.6;
  double secondary_object = 0.05, secondary_normal = 0.06, secondary_shadow = 0.06, secondary_texture = 0.6;
  double same_normal = 0.9;
  std::uint32_t propagate = 0;
  Packing packing = Packing::kBlock;
  SubpixelFilter filter = SubpixelFilter::kNearest;
  bool focus = false;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    const auto threshold = [&](auto& value, std::string_view name, std::string_view meaning) {
      field(value, name, "", meaning, sim::between(-1, 1), Affects::kFunction);
    };
    threshold(NAMED(c.colour), "contrast from which a sub-pixel is sampled where nothing else disagrees; -1: never");
    threshold(NAMED(c.object), "where objects differ; 0: always, 1: never, -1: they are not compared");
    threshold(NAMED(c.normal), "where normals differ; likewise");
    threshold(NAMED(c.shadow), "where the number of shadows differs; likewise");
    threshold(NAMED(c.texture), "where the pixel's surface has a texture; likewise");
    threshold(NAMED(c.secondary_object), "as object, of the hit behind the stronger branch");
    threshold(NAMED(c.secondary_normal), "as normal, of that hit");
    threshold(NAMED(c.secondary_shadow), "as shadow, of that hit");
    threshold(NAMED(c.secondary_texture), "as texture, of that hit");
    field(NAMED(c.same_normal), "", "normals differ if their dot product is below this", sim::between(-1, 2),
          Affects::kFunction);
    field(NAMED(c.propagate), "rounds",
          "in each, sub-pixels beside those that the one before made active, and unlike them, are sampled too",
          sim::between(0, kMostRounds), Affects::kFunction);
    field(NAMED(c.packing), "",
          "how sub-pixels are listed for sampling: pixels kept together, each by itself, or not listed at all",
          sim::any(), Affects::kFunction);
    field(NAMED(c.filter), "", "colour of sub-pixels that are not sampled: their pixel's, or between four pixels'",
          sim::any(), Affects::kFunction);
    field(NAMED(c.focus), "", "attributes disagree only where one of two objects is in focus (glTF: extras.focus)",
          sim::any(), Affects::kFunction);
    AdaptiveConfig::describe(c, field);
  }
  void check(auto&& complain) const {
    const auto each = [&](double value, std::string_view name) {
      if (value < 0 && value != -1) complain(name, "lies between -1 and 0; a threshold is 0 to 1, or -1: not compared");
    };
    each(colour, "colour");
    each(object, "object");
    each(normal, "normal");
    each(shadow, "shadow");
    each(texture, "texture");
    each(secondary_object, "secondary_object");
    each(secondary_normal, "secondary_normal");
    each(secondary_shadow, "secondary_shadow");
    each(secondary_texture, "secondary_texture");
  }
};

}  // namespace kernels
