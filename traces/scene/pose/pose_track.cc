#include "traces/scene/pose/pose_track.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace traces {
namespace {

using Interpolation = Track::Interpolation;

/// The keys before and after a time; equal before the first and after the last key.
struct Span {
  std::size_t from = 0, to = 0;
  double share = 0;    ///< position between the two keys, 0..1
  double seconds = 0;  ///< time between the two keys
};

Span find_span(const Track& track, double seconds) {
  const auto& times = track.times;
  const auto later = std::upper_bound(times.begin(), times.end(), seconds,
                                      [](double t, float key) { return t < static_cast<double>(key); });
  const auto to = static_cast<std::size_t>(later - times.begin());
  if (to == 0) return {0, 0, 0, 0};
  if (to == times.size()) return {to - 1, to - 1, 0, 0};
  const double begin = static_cast<double>(times[to - 1]), length = static_cast<double>(times[to]) - begin;
  return {to - 1, to, (seconds - begin) / length, length};
}

/// Parts of a key; a cubic spline has all three, other tracks only the value.
enum class Part : std::uint8_t { kInTangent, kValue, kOutTangent };

double number(const Track& track, std::size_t key, Part part, std::size_t i, std::size_t count) {
  const bool spline = track.interpolation == Interpolation::kCubicSpline;
  const std::size_t row = spline ? 3 * key + static_cast<std::size_t>(part) : key;
  return static_cast<double>(track.values[row * count + i]);
}

double on_spline(const Track& track, const Span& span, std::size_t i, std::size_t count) {
  const double s = span.share, s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * number(track, span.from, Part::kValue, i, count) +
         (s3 - 2 * s2 + s) * span.seconds * number(track, span.from, Part::kOutTangent, i, count) +
         (3 * s2 - 2 * s3) * number(track, span.to, Part::kValue, i, count) +
         (s3 - s2) * span.seconds * number(track, span.to, Part::kInTangent, i, count);
}

/// Returns sin(share x angle) / sin(angle) by its series in 1 - cosine. For a cosine of 0 to 1 each term is at most
/// half the previous one.
double arc_weight(double share, double cosine) {
  constexpr double kSmallest = 1e-18;
  double term = share, sum = share;
  for (double i = 1; term > kSmallest; ++i) {
    term *= (i * i - share * share) / (i * (2 * i + 1)) * (1 - cosine);
    sum += term;
  }
  return sum;
}

double dot(std::span<const double> a, std::span<const double> b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

void to_unit(std::span<double> q) {
  const double length = std::sqrt(dot(q, q));
  if (!(length > 0)) {
    std::ranges::fill(q, 0.0);
    q[3] = 1;
    return;
  }
  for (double& x : q) x /= length;
}

void on_arc(const Track& track, const Span& span, std::span<double> out) {
  double from[4], to[4];
  for (std::size_t i = 0; i < 4; ++i) {
    from[i] = number(track, span.from, Part::kValue, i, 4);
    to[i] = number(track, span.to, Part::kValue, i, 4);
  }
  to_unit(from);
  to_unit(to);
  const double cosine = dot(from, to);
  const double angle_cosine = std::min(std::abs(cosine), 1.0);
  const double a = arc_weight(1 - span.share, angle_cosine);
  const double b = arc_weight(span.share, angle_cosine) * (cosine < 0 ? -1 : 1);
  for (std::size_t i = 0; i < 4; ++i) out[i] = a * from[i] + b * to[i];
}

}  // namespace

void sample(const Track& track, double seconds, std::span<double> out) {
  const std::size_t count = out.size();
  assert(!track.times.empty() && "a track has at least one key");
  assert(track.values.size() ==
         track.times.size() * count * (track.interpolation == Interpolation::kCubicSpline ? 3 : 1));
  const bool rotation = track.path == Track::Path::kRotation;
  const Span span = find_span(track, seconds);
  if (span.from == span.to || track.interpolation == Interpolation::kStep) {
    for (std::size_t i = 0; i < count; ++i) out[i] = number(track, span.from, Part::kValue, i, count);
  } else if (track.interpolation == Interpolation::kCubicSpline) {
    for (std::size_t i = 0; i < count; ++i) out[i] = on_spline(track, span, i, count);
  } else if (rotation) {
    on_arc(track, span, out);
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      const double from = number(track, span.from, Part::kValue, i, count);
      out[i] = from + span.share * (number(track, span.to, Part::kValue, i, count) - from);
    }
  }
  if (rotation) to_unit(out);
}

void sample_slope(const Track& track, double seconds, std::span<double> out) {
  assert(track.interpolation == Interpolation::kCubicSpline);
  const std::size_t count = out.size();
  const Span span = find_span(track, seconds);
  std::ranges::fill(out, 0.0);
  if (span.from == span.to) return;
  const double s = span.share, s2 = s * s;
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = (6 * s2 - 6 * s) / span.seconds *
                 (number(track, span.from, Part::kValue, i, count) - number(track, span.to, Part::kValue, i, count)) +
             (3 * s2 - 4 * s + 1) * number(track, span.from, Part::kOutTangent, i, count) +
             (3 * s2 - 2 * s) * number(track, span.to, Part::kInTangent, i, count);
  }
}

}  // namespace traces
