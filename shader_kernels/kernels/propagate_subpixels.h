#pragma once
#include <array>
#include <string_view>

#include "shader_kernels/kernels/average_colour.h"
#include "shader_kernels/kernels/settle_subpixels.h"
#include "sim/named.h"

namespace kernels {

/// The inspector of a round of propagation: compares a sub-pixel that is not active with those of its four neighbours
/// that the round before has made active. Their smallest threshold applies to the contrast of all of them.
struct PropagateSubpixels {
  static constexpr std::string_view kName = "propagate_subpixels";
  static constexpr std::string_view kMeaning =
      "sub-pixel, neighbours made active last -> stream active if it differs from these, its pixel a master";
  template <class V>
  struct Ports {
    StateUniforms<V> grid;
    Local<V, SubpixelRecord> states;
    Local<V, WordRecord> verdicts, active, masters;
    Counter<V> active_count, masters_count;
    Carried<V> last_master;                    ///< pixel listed last
    std::array<F<V>, kAttributes> thresholds;  ///< above 1: no contrast is enough
    I<V> round;                                ///< the one before, in its place
    static void describe(auto& p, auto&& port) {
      StateUniforms<V>::describe(p.grid, port);
      port(NAMED(p.states));
      port(NAMED(p.verdicts));
      port(NAMED(p.active));
      port(NAMED(p.masters));
      port(NAMED(p.active_count));
      port(NAMED(p.masters_count));
      port(NAMED(p.last_master));
      for (std::size_t i = 0; i < kAttributes; ++i) port(p.thresholds[i], names_of(Attribute{})[i]);
      port(NAMED(p.round));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const F<V> centre = state_of<V>(item, at.grid);
    const SubpixelRecord<V> own = at.states.load(to_int(centre));
    const Vec3<V> colour = channels_of<V>(own);
    Range<V> range{colour, colour, 0U};
    widen<V>(range, at.states.load(to_int(centre - 1.0F)), at.round);
    widen<V>(range, at.states.load(to_int(centre + 1.0F)), at.round);
    widen<V>(range, at.states.load(to_int(centre - at.grid.pitch)), at.round);
    widen<V>(range, at.states.load(to_int(centre + at.grid.pitch)), at.round);

    F<V> threshold = kNever;
    for (std::uint32_t i = 0; i < kAttributes; ++i) {
      threshold = min(threshold, select((range.reasons & (1U << i)) == 0U, F<V>(kNever), at.thresholds[i]));
    }
    const auto differs = [&](float factor, const F<V>& least, const F<V>& most) {
      return threshold * factor * max(most + least, F<V>(1.0F)) < most - least;
    };
    const M<V> contrasts = logical_or(logical_or(differs(kChannelFactors[0], range.least.x, range.most.x),
                                                 differs(kChannelFactors[1], range.least.y, range.most.y)),
                                      differs(kChannelFactors[2], range.least.z, range.most.z));
    const M<V> found = both(contrasts, own.blue_why >> kRoundShift == 0U);

    at.verdicts.store(item, {range.reasons});
    at.active.store(at.active_count.next(found), {item});
    const I<V> pixel = item >> 2U;
    const F<V> number = to_float(pixel);
    const F<V> last = at.last_master.get();
    const M<V> is_first = both(found, last < number);
    at.last_master.set(select(is_first, number, last));
    at.masters.store(at.masters_count.next(is_first), {pixel});
  }

 private:
  /// Least and most of each channel, and reasons of the neighbours that count.
  template <class V>
  struct Range {
    Vec3<V> least, most;
    I<V> reasons;
  };
  template <class V>
  static Vec3<V> channels_of(const SubpixelRecord<V>& state) {
    return {to_float(state.red_green & kChannelMask), to_float(state.red_green >> 16U),
            to_float(state.blue_why & kChannelMask)};
  }
  template <class V>
  static void widen(Range<V>& range, const SubpixelRecord<V>& neighbour, const I<V>& round) {
    const M<V> is_fresh = (neighbour.blue_why >> kRoundShift) << kRoundShift == round;
    const Vec3<V> colour = channels_of<V>(neighbour);
    const Vec3<V> low = select(is_fresh, colour, range.least);
    const Vec3<V> high = select(is_fresh, colour, range.most);
    range.least = {min(range.least.x, low.x), min(range.least.y, low.y), min(range.least.z, low.z)};
    range.most = {max(range.most.x, high.x), max(range.most.y, high.y), max(range.most.z, high.z)};
    range.reasons = range.reasons | select(is_fresh, (neighbour.blue_why >> kReasonsShift) & kReasonsMask, I<V>(0U));
  }
};

/// Four items per listed pixel: the mean of its sub-pixels, as average_colour has it of samples.
struct AverageSubpixels {
  static constexpr std::string_view kName = "average_subpixels";
  static constexpr std::string_view kMeaning = "sub-pixel of a listed pixel -> mean of the pixel's sub-pixels";
  template <class V>
  struct Ports : AverageColour::Ports<V> {
    Local<V, WordRecord> masters;
    Local<V, ColourRecord> shown;
    static void describe(auto& p, auto&& port) {
      AverageColour::Ports<V>::describe(p, port);
      port(NAMED(p.masters));
      port(NAMED(p.shown));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = divmod<V>(to_float(item), at.samples, at.inverse_samples);
    const I<V> listed = at.masters.load(to_int(pixel.quotient)).word;
    AverageColour::add<V>(at, pixel, at.shown.load((listed << 2U) | (item & 3U)).rgb);
  }
};

}  // namespace kernels
