#pragma once
#include "shader_kernels/kernels/checks.h"
#include "shader_kernels/kernels/sample_grid.h"
#include "sim/named.h"

namespace kernels {

/// The samples between the reference samples of parallel lines. Along a line every `block`-th sample is a reference,
/// from position 0 on; positions below `low` or above `high` are outside the picture. `gaps` is block - 1.
template <class V>
struct LineUniforms {
  F<V> inner, inverse_inner;  ///< along x: samples between references in a line; along y: lines
  F<V> gaps, inverse_gaps, block, inverse_block;
  F<V> first, step, line_step;  ///< position 0 of line 0; from position to position, from line to line
  F<V> low, high;
  static void describe(auto& l, auto&& port) {
    port(l.inner, "line.inner");
    port(l.inverse_inner, "line.inverse_inner");
    port(l.gaps, "line.gaps");
    port(l.inverse_gaps, "line.inverse_gaps");
    port(l.block, "line.block");
    port(l.inverse_block, "line.inverse_block");
    port(l.first, "line.first");
    port(l.step, "line.step");
    port(l.line_step, "line.line_step");
    port(l.low, "line.low");
    port(l.high, "line.high");
  }
};

/// A sample and the two references that it lies between.
template <class V>
struct SampleNeighbours {
  I<V> sample, before, after;
  I<V> gap;      ///< samples between `before` and it
  M<V> outside;  ///< one of the two is not there
};

/// Sample number `item`; lines are worked off one after the other along x, side by side along y.
template <bool kAlongY, class V>
SampleNeighbours<V> sample_neighbours(const I<V>& item, const LineUniforms<V>& line) {
  const DivMod<V> outer = divmod<V>(to_float(item), line.inner, line.inverse_inner);
  const F<V> number = kAlongY ? outer.quotient : outer.remainder;
  const F<V> of_line = kAlongY ? outer.remainder : outer.quotient;
  const DivMod<V> gap = divmod<V>(number, line.gaps, line.inverse_gaps);
  const F<V> position = gap.quotient * line.block;
  const F<V> before = line.first + of_line * line.line_step + position * line.step;
  return {to_int(before + (gap.remainder + 1.0F) * line.step), to_int(before), to_int(before + line.block * line.step),
          to_int(gap.remainder), logical_or(position < line.low, line.high < position + line.block)};
}

// An item of the stream of samples that have passed: the sample, and above it the gap.
inline constexpr std::uint32_t kGapShift = 24;
inline constexpr std::uint32_t kSampleMask = (1U << kGapShift) - 1;

template <class V>
struct Passed {
  I<V> sample, before, after;
  F<V> weight;  ///< weight of `after`; that of `before` is the rest
};
template <class V>
Passed<V> passed(const I<V>& word, const LineUniforms<V>& line) {
  const I<V> sample = word & kSampleMask;
  const F<V> steps = to_float(word >> kGapShift) + 1.0F;
  const F<V> at = to_float(sample);
  const F<V> before = at - steps * line.step;
  return {sample, to_int(before), to_int(before + line.block * line.step), steps * line.inverse_block};
}

/// Kernel K, which runs over the samples that have passed, behind their check: it makes all samples, and those that
/// have failed are traced afterwards.
template <bool kAlongY, class K>
struct AllPassed {
  using Of = K;
  template <class V>
  using Ports = typename K::template Ports<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const SampleNeighbours<V> b = sample_neighbours<kAlongY, V>(item, at.line);
    K::template interpolate<V>({b.sample, b.before, b.after, (to_float(b.gap) + 1.0F) * at.line.inverse_block}, at);
  }
};

/// Ports of check kernels, which leave the failed checks of a sample in the tile buffer, and it in one of two streams.
template <class V>
struct VerdictPorts {
  LineUniforms<V> line;
  Local<V, WordRecord> verdicts, passed, failed;
  Counter<V> passed_count, failed_count;
  static void describe(auto& p, auto&& port) {
    LineUniforms<V>::describe(p.line, port);
    port(NAMED(p.verdicts));
    port(NAMED(p.passed));
    port(NAMED(p.failed));
    port(NAMED(p.passed_count));
    port(NAMED(p.failed_count));
  }
};
template <class V>
void write_verdict(VerdictPorts<V>& at, const SampleNeighbours<V>& b, const I<V>& checks) {
  const I<V> failed = select(b.outside, I<V>(bit(Check::kBorder)), checks);
  at.verdicts.store(b.sample, {failed});
  at.passed.store(at.passed_count.next(failed == 0U), {b.sample | (b.gap << kGapShift)});
  at.failed.store(at.failed_count.next(I<V>(0U) < failed), {b.sample});
}

template <class V>
I<V> fails_if(const M<V>& mask, Check check) {
  return select(mask, I<V>(bit(check)), I<V>(0U));
}

template <class V>
F<V> lerp(const F<V>& a, const F<V>& b, const F<V>& weight) {
  return a + (b - a) * weight;
}
template <class V>
Vec3<V> lerp(const Vec3<V>& a, const Vec3<V>& b, const F<V>& weight) {
  return a + (b - a) * weight;
}

/// Colour of a sample between two: samples are what is averaged, so they are clamped first.
template <class V>
Vec3<V> lerp_colours(const Vec3<V>& a, const Vec3<V>& b, const F<V>& weight) {
  return lerp<V>({clamped<V>(a.x), clamped<V>(a.y), clamped<V>(a.z)},
                 {clamped<V>(b.x), clamped<V>(b.y), clamped<V>(b.z)}, weight);
}

}  // namespace kernels
