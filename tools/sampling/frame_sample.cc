#include "tools/sampling/frame_sample.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "sim/io/printable.h"
#include "tools/noise/noise.h"

namespace tools {
namespace {

constexpr std::uint32_t kFramesPerCluster = 2;  // chosen: the fewest that show the variation within a cluster
/// Largest number of clusters that are chosen automatically, and frames of the sequence per such cluster. Chosen: two
/// frames of each cluster are at most a thirtieth of a long sequence.
constexpr std::uint32_t kMostClusters = 16, kFramesOfSequence = 60;
/// Share of the range of the criterion that the chosen number of clusters reaches, as in SimPoint (Sherwood et al.,
/// ASPLOS 2002).
constexpr double kCriterionShare = 0.9;
constexpr std::uint32_t kInitialCentres = 5;  // chosen: initial centres of k-means; the best are kept
constexpr std::uint32_t kMostSteps = 100;     // chosen: k-means converges in some twenty steps
constexpr double kLeastVariance = 1e-12;      // chosen: far below the variance of standardised counts, which is 1
constexpr double kRidgePerFrame = 0.2;        // chosen: penalty per frame on standardised counts, as for tiles

constexpr std::uint32_t kMostWanted = 1000;  // chosen: two thousand frames take as long as whole sequences

bool parse_whole_text(std::string_view text, auto& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

/// Points in a space of several dimensions.
using Points = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the counts of frames, one row per frame, standardised over all frames. Counts that are equal in all frames
/// are left out.
Points standardise_counts(std::span<const FrameCounts> counts) {
  const auto n = static_cast<Eigen::Index>(counts.size());
  std::vector<Eigen::VectorXd> columns;
  for (const auto member : FrameCounts::kAll) {
    Eigen::VectorXd column(n);
    for (Eigen::Index i = 0; i < n; ++i) column[i] = counts[static_cast<std::size_t>(i)].*member;
    const double mean = column.mean();
    column.array() -= mean;
    const double spread = std::sqrt(column.squaredNorm() / static_cast<double>(n));
    if (spread > 1e-9 * std::abs(mean)) columns.emplace_back(column / spread);
  }
  Points points(n, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) points.col(static_cast<Eigen::Index>(j)) = columns[j];
  return points;
}

/// Result of k-means: the cluster of each point, and the sum of squared distances to the centres.
struct Partition {
  std::vector<std::uint32_t> cluster_of;
  std::uint32_t clusters = 0;
  double error = std::numeric_limits<double>::infinity();
};

/// Chooses initial centres among the points by k-means++ (Arthur and Vassilvitskii, SODA 2007). Returns fewer than
/// `wanted` if there are fewer distinct points.
Points initial_centres(const Points& points, std::uint32_t wanted, std::uint64_t seed) {
  const auto n = static_cast<std::uint64_t>(points.rows());
  std::vector<Eigen::Index> chosen = {static_cast<Eigen::Index>(sim::hash(seed, 0) % n)};
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::infinity());
  while (chosen.size() < wanted) {
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      nearest[i] = std::min(nearest[i], (points.row(i) - points.row(chosen.back())).squaredNorm());
    }
    const double all = nearest.sum();
    if (!(all > kLeastVariance)) break;
    double left = all * static_cast<double>(sim::hash_to_unit_float(sim::hash(seed, chosen.size())));
    Eigen::Index next = 0;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      if (nearest[i] == 0) continue;
      next = i;
      left -= nearest[i];
      if (left < 0) break;
    }
    chosen.push_back(next);
  }
  Points centres(static_cast<Eigen::Index>(chosen.size()), points.cols());
  for (std::size_t c = 0; c < chosen.size(); ++c) centres.row(static_cast<Eigen::Index>(c)) = points.row(chosen[c]);
  return centres;
}

/// Moves centres to the means of their nearest points until no point changes its cluster.
Partition improve_centres(const Points& points, Points centres) {
  Partition out{std::vector<std::uint32_t>(static_cast<std::size_t>(points.rows())), 0, 0};
  for (std::uint32_t step = 0; step < kMostSteps; ++step) {
    out.error = 0;
    bool changed = step == 0;
    Points sums = Points::Zero(centres.rows(), centres.cols());
    std::vector<double> sizes(static_cast<std::size_t>(centres.rows()));
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      Eigen::Index best = 0;
      out.error += (centres.rowwise() - points.row(i)).rowwise().squaredNorm().minCoeff(&best);
      std::uint32_t& cluster = out.cluster_of[static_cast<std::size_t>(i)];
      changed = changed || cluster != static_cast<std::uint32_t>(best);
      cluster = static_cast<std::uint32_t>(best);
      sums.row(best) += points.row(i);
      sizes[static_cast<std::size_t>(best)] += 1;
    }
    if (!changed) break;
    for (Eigen::Index c = 0; c < centres.rows(); ++c) {
      if (const double size = sizes[static_cast<std::size_t>(c)]; size > 0) centres.row(c) = sums.row(c) / size;
    }
  }
  return out;
}

/// Numbers the clusters in the order of their first points, without gaps.
void number_clusters(Partition& partition) {
  std::vector<std::uint32_t> number(partition.cluster_of.size(), ~0U);
  for (std::uint32_t& cluster : partition.cluster_of) {
    if (number[cluster] == ~0U) number[cluster] = partition.clusters++;
    cluster = number[cluster];
  }
}

Partition run_k_means(const Points& points, std::uint32_t wanted, std::uint64_t seed) {
  Partition best;
  for (std::uint32_t start = 0; start < kInitialCentres; ++start) {
    Partition found = improve_centres(points, initial_centres(points, wanted, sim::hash(seed, wanted, start)));
    if (found.error < best.error) best = std::move(found);
  }
  number_clusters(best);
  return best;
}

/// Returns the Bayesian information criterion of clusters with equal spherical variance (Pelleg and Moore, ICML 2000).
double information_criterion(const Points& points, const Partition& partition) {
  const auto n = static_cast<double>(points.rows()), d = static_cast<double>(points.cols());
  const double clusters = partition.clusters;
  const double free = d * std::max(1.0, n - clusters);
  const double variance = std::max(partition.error / free, kLeastVariance);
  std::vector<double> sizes(partition.clusters);
  for (const std::uint32_t cluster : partition.cluster_of) sizes[cluster] += 1;
  double likelihood = -n * d / 2 * std::log(2 * std::numbers::pi * variance) - free / 2;
  for (const double size : sizes) likelihood += size * std::log(size / n);
  return likelihood - clusters * (d + 1) / 2 * std::log(n);
}

FrameClusters to_clusters(Partition partition) {
  FrameClusters out{std::move(partition.cluster_of), std::vector<std::uint32_t>(partition.clusters)};
  for (const std::uint32_t cluster : out.of_frame) out.sizes[cluster] += 1;
  return out;
}

/// Orders frames so that any number of first ones are spread over time: a van der Corput sequence with a random start.
/// Each frame is the first with the same probability.
std::vector<std::uint32_t> spread_frames(const std::vector<std::uint32_t>& frames, std::uint64_t seed) {
  const std::size_t n = frames.size();
  const std::uint64_t start = seed % n;
  std::vector<std::uint32_t> order;
  std::vector<bool> taken(n);
  for (std::uint64_t k = 0; order.size() < n; ++k) {
    double place = 0, share = 0.5;
    for (std::uint64_t bits = k; bits != 0; bits >>= 1, share /= 2) place += (bits & 1) != 0 ? share : 0;
    std::size_t i = (start + static_cast<std::size_t>(place * static_cast<double>(n))) % n;
    if (taken[i]) continue;
    taken[i] = true;
    order.push_back(frames[i]);
  }
  return order;
}

}  // namespace

FrameSampling parse_representative(const std::string& text) {
  FrameSampling s;
  const std::string_view all = text;
  const std::size_t colon = all.find(':');
  const std::string_view clusters = all.substr(0, colon);
  const bool is_good = (clusters == "auto" || (parse_whole_text(clusters, s.clusters) && s.clusters >= 1)) &&
                       s.clusters <= kMostWanted &&
                       (colon == std::string_view::npos || parse_whole_text(all.substr(colon + 1), s.draw));
  if (is_good) return s;
  throw sim::InputError(fmt::format(
      "--representative '{}': is no number of clusters; allowed: auto, or a number from 1 to {}, e.g. 12; then a "
      "draw, e.g. auto:2",
      sim::printable(text), kMostWanted));
}

void check_representative(const kernels::ProgramSpec& program) {
  if (program.has_independent_tiles()) return;
  throw sim::InputError(
      fmt::format("--representative: frames of {} are not counted; allowed: full:N, path:N", program.name()));
}

FrameClusters cluster_frames(std::span<const FrameCounts> counts, std::uint32_t wanted, std::uint64_t seed) {
  const Points points = standardise_counts(counts);
  const auto n = static_cast<std::uint32_t>(counts.size());
  if (points.cols() == 0) return {std::vector<std::uint32_t>(n), {n}};
  if (wanted != 0) return to_clusters(run_k_means(points, std::min(wanted, n), seed));
  const std::uint32_t most = std::min(n, std::clamp(n / kFramesOfSequence, 2U, kMostClusters));
  std::vector<Partition> found;
  std::vector<double> criteria;
  for (std::uint32_t k = 1; k <= most; ++k) {
    Partition partition = run_k_means(points, k, seed);
    if (partition.clusters < k) break;  // there are no more distinct points
    criteria.push_back(information_criterion(points, partition));
    found.push_back(std::move(partition));
  }
  const auto [least, greatest] = std::ranges::minmax(criteria);
  const double enough = least + kCriterionShare * (greatest - least);
  const auto best = std::ranges::find_if(criteria, [&](double value) { return value >= enough; });
  return to_clusters(std::move(found[static_cast<std::size_t>(best - criteria.begin())]));
}

FrameSample::FrameSample(std::vector<FrameCounts> counts, std::uint32_t clusters, std::uint64_t draw)
    : counts_(std::move(counts)), clusters_(cluster_frames(counts_, clusters, draw)), order_(clusters_.sizes.size()) {
  for (std::uint32_t frame = 0; frame < counts_.size(); ++frame) order_[clusters_.of_frame[frame]].push_back(frame);
  for (std::size_t c = 0; c < order_.size(); ++c) {
    order_[c] = spread_frames(order_[c], sim::hash(draw, c));
    numbers_.push_back(std::min(kFramesPerCluster, static_cast<std::uint32_t>(order_[c].size())));
  }
  choose_frames();
}

void FrameSample::choose_frames() {
  chosen_.clear();
  for (std::size_t c = 0; c < order_.size(); ++c) {
    chosen_.insert(chosen_.end(), order_[c].begin(), order_[c].begin() + numbers_[c]);
  }
  std::ranges::sort(chosen_);
  compute_weights();
}

void FrameSample::compute_weights() {
  const Points points = standardise_counts(counts_);
  const auto n = static_cast<Eigen::Index>(chosen_.size());
  Eigen::VectorXd shares(n);
  Points sample(n, points.cols());
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::uint32_t frame = chosen_[static_cast<std::size_t>(i)];
    const std::uint32_t cluster = clusters_.of_frame[frame];
    shares[i] = static_cast<double>(clusters_.sizes[cluster]) / numbers_[cluster];
    sample.row(i) = points.row(frame);
  }
  const Eigen::VectorXd gap = points.colwise().sum().transpose() - sample.transpose() * shares;
  sample.rowwise() -= sample.colwise().mean().eval();
  Eigen::MatrixXd normal = sample.transpose() * sample;
  normal.diagonal().array() += kRidgePerFrame * static_cast<double>(n);
  const Eigen::MatrixXd solved = normal.llt().solve(sample.transpose());
  const Eigen::MatrixXd smoother = sample * solved;
  const Eigen::VectorXd weights = shares + solved.transpose() * gap;
  weights_.assign(weights.begin(), weights.end());
  smoother_.assign(smoother.data(), smoother.data() + smoother.size());
  parameters_ = smoother.trace();
}

std::vector<double> FrameSample::residuals(std::span<const double> observed) const {
  const auto n = static_cast<Eigen::Index>(chosen_.size());
  const Eigen::Map<const Eigen::VectorXd> values(observed.data(), n);
  const Eigen::Map<const Eigen::MatrixXd> smoother(smoother_.data(), n, n);
  const Eigen::VectorXd left = values - smoother * values;
  return {left.begin(), left.end()};
}

std::vector<double> FrameSample::variances(std::span<const double> observed) const {
  const std::vector<double> left = residuals(observed);
  std::vector<double> means(numbers_.size()), variances(numbers_.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::uint32_t cluster = clusters_.of_frame[chosen_[i]];
    means[cluster] += left[i] / numbers_[cluster];
  }
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::uint32_t cluster = clusters_.of_frame[chosen_[i]];
    if (numbers_[cluster] == 1) continue;
    const double off = left[i] - means[cluster];
    variances[cluster] += off * off / (numbers_[cluster] - 1);
  }
  return variances;
}

Interval FrameSample::total(std::span<const double> observed, std::span<const Interval> errors) const {
  Interval out;
  double of_frames = 0;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    out.estimate += weights_[i] * observed[i];
    if (errors.empty()) continue;
    const double error = weights_[i] * errors[i].random;
    of_frames += error * error;
    out.systematic += std::abs(weights_[i]) * errors[i].systematic;
  }
  const std::vector<double> spread = variances(observed);
  const auto n = static_cast<double>(chosen_.size());
  const double fitted = n / std::max(1.0, n - parameters_);  // the regression makes residuals too small
  double pooled = 0, factor = 0, degrees = 0;
  for (std::size_t c = 0; c < numbers_.size(); ++c) {
    const double size = clusters_.sizes[c], chosen = numbers_[c];
    pooled += size * spread[c] / static_cast<double>(counts_.size());
    factor += size * (size - chosen) / chosen;
    degrees += chosen - 1;
  }
  if (factor > 0) out.random = student_t_quantile(degrees) * std::sqrt(fitted * factor * pooled);
  out.random = std::hypot(out.random, std::sqrt(of_frames));
  return out;
}

void FrameSample::add_frames(std::size_t more, std::span<const double> observed) {
  std::vector<double> spread = variances(observed);
  // Two frames show the variance of their cluster poorly, so it is averaged with the mean of all clusters.
  double mean = 0;
  for (std::size_t c = 0; c < spread.size(); ++c) mean += spread[c] * clusters_.sizes[c];
  mean /= static_cast<double>(counts_.size());
  for (double& variance : spread) variance = (variance + mean) / 2;
  for (; more > 0; --more) {
    double best_gain = -1;
    std::size_t best = 0;
    for (std::size_t c = 0; c < numbers_.size(); ++c) {
      const double size = clusters_.sizes[c], chosen = numbers_[c];
      const double gain = size * size * spread[c] / (chosen * (chosen + 1));
      if (chosen < size && gain > best_gain) best_gain = gain, best = c;
    }
    if (best_gain < 0) break;
    numbers_[best] += 1;
  }
  choose_frames();
}

}  // namespace tools
