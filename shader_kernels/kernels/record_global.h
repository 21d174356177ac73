#pragma once
#include <algorithm>
#include <string_view>

#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// A sample's global colour is all but what ambient light and lights do at its first hit: those are shaded anew where
/// it is interpolated. It is found by difference, so that the sum of a traced sample's colour stays as it is.
template <bool kAfter>
struct RecordLocal {
  static constexpr std::string_view kName = kAfter ? "record_local_after" : "record_local_before";
  static constexpr std::string_view kMeaning = kAfter
                                                   ? "first hit -> its sample's colour behind local shading, taken off"
                                                   : "first hit -> its sample's colour before local shading";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, PathRecord> paths;
    Local<V, ColourRecord> colours, globals;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(NAMED(p.paths));
      port(NAMED(p.colours));
      port(NAMED(p.globals));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = at.paths.load(at.diffuse.load(item).word).sample;
    const Vec3<V> colour = at.colours.load(sample).rgb;
    if constexpr (kAfter) {
      at.globals.store(sample, {at.globals.load(sample).rgb - colour});
    } else {
      at.globals.store(sample, {colour});
    }
  }
};

struct RecordGlobal {
  static constexpr std::string_view kName = "record_global";
  static constexpr std::string_view kMeaning = "traced sample -> its global colour";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, ColourRecord> colours, globals;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.colours));
      port(NAMED(p.globals));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = at.samples.load(item).word;
    at.globals.store(sample, {at.globals.load(sample).rgb + at.colours.load(sample).rgb});
  }
};

/// Largest channel of a faint colour. Channels up to 0.0031 are encoded as 12.92 times themselves, so two faint colours
/// lie at most 3^(1/2) x 12.92 x 0.04 = 0.9 of `threshold` apart.
inline float faint_channel(float threshold) { return std::min(0.003F, 0.04F * threshold); }

/// Counts samples whose global colour is not faint. Two faint ones pass the check of colours whatever they are.
struct CountColoured {
  static constexpr std::string_view kName = "count_coloured";
  static constexpr std::string_view kMeaning = "sample -> number of those whose global colour is not faint";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, ColourRecord> globals;
    Counter<V> coloured_count;
    F<V> faint;  ///< largest channel of a faint colour
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.globals));
      port(NAMED(p.coloured_count));
      port(NAMED(p.faint));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const Vec3<V> global = at.globals.load(at.samples.load(item).word).rgb;
    at.coloured_count.next(at.faint < max(max(global.x, global.y), global.z));
  }
};

}  // namespace kernels
