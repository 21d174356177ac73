#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/sampling/frame_counts.h"
#include "tools/sampling/tile_sampling.h"

namespace tools {

/// Mode of a run in which some frames of a sequence are simulated, as a whole or by sampled tiles, and the totals of
/// the sequence are estimated (docs/sequences.md).
struct FrameSampling {
  std::uint32_t clusters = 0;         ///< number of clusters of frames; 0: chosen automatically
  std::uint64_t draw = 1;             ///< seed of clusters and of the choice of frames
  std::optional<TileSampling> tiles;  ///< how each frame is sampled; empty: frames are simulated as a whole
};

/// Parses --representative: "auto" or a number of clusters, either followed by ":" and a draw. Throws InputError.
FrameSampling parse_representative(const std::string& text);
/// Throws InputError for a program whose frames cannot represent others.
void check_representative(const kernels::ProgramSpec& program);

/// Clusters of frames with similar counts. Clusters are numbered in the order of their first frames.
struct FrameClusters {
  std::vector<std::uint32_t> of_frame;  ///< cluster of each frame
  std::vector<std::uint32_t> sizes;     ///< number of frames of each cluster
};

/// Clusters frames by k-means on their standardised counts. `wanted`: number of clusters; 0: the smallest number whose
/// Bayesian information criterion is within a tenth of the best. Frames with equal counts share a cluster, so there may
/// be fewer clusters than wanted. `seed`: seed of the initial centres.
FrameClusters cluster_frames(std::span<const FrameCounts> counts, std::uint32_t wanted, std::uint64_t seed);

/// A stratified random sample of the frames of a sequence, and estimates of totals of the sequence from it.
///
/// 1. The strata are clusters of frames. Two frames of each, half a cluster apart in time, are chosen, or the only one.
/// 2. Totals are generalised regression estimates: each frame represents an equal share of its cluster, and a ridge
///    regression on the counts corrects the difference between the counts of the sample and of the sequence.
/// 3. The interval assumes the same variance of residuals in all clusters: the mean of the clusters' variances.
/// 4. The estimate is linear in the observations. So one weight per frame serves every quantity, and sums of quantities
///    stay consistent.
/// 5. If all frames of each cluster are equal, totals are exact.
class FrameSample {
 public:
  /// `clusters`: as `wanted` of cluster_frames(). `draw`: seed of clusters and of the choice of frames.
  FrameSample(std::vector<FrameCounts> counts, std::uint32_t clusters, std::uint64_t draw);

  const FrameClusters& clusters() const { return clusters_; }
  /// Returns the indices of the chosen frames, ascending.
  const std::vector<std::uint32_t>& chosen() const { return chosen_; }
  bool has_all_frames() const { return chosen_.size() == counts_.size(); }
  /// Returns the weight of each chosen frame.
  const std::vector<double>& weights() const { return weights_; }
  /// Returns the estimated total of a quantity with its 95 % interval. `observed`: its value in each chosen frame.
  /// `errors`: intervals of these values; empty if they are exact.
  Interval total(std::span<const double> observed, std::span<const Interval> errors = {}) const;
  /// Adds `more` frames where they reduce the variance of a total most.
  void add_frames(std::size_t more, std::span<const double> observed);

 private:
  /// Returns the residuals of the regression in the chosen frames.
  std::vector<double> residuals(std::span<const double> observed) const;
  /// Returns the variance of the residuals within each cluster; 0 if one frame of it is chosen.
  std::vector<double> variances(std::span<const double> observed) const;
  /// Chooses `numbers_[c]` frames of each cluster `c`, and computes their weights.
  void choose_frames();
  void compute_weights();

  const std::vector<FrameCounts> counts_;
  const FrameClusters clusters_;
  std::vector<std::vector<std::uint32_t>> order_;  ///< frames of each cluster in the order in which they are chosen
  std::vector<std::uint32_t> numbers_;             ///< number of chosen frames of each cluster
  std::vector<std::uint32_t> chosen_;
  std::vector<double> weights_;
  std::vector<double> smoother_;  ///< matrix: fitted = smoother x observed, both less their mean
  double parameters_ = 0;         ///< effective number of parameters of the regression
};

}  // namespace tools
