#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tools/run/frame/front_end.h"
#include "tools/run/frame/run_job.h"
#include "tools/sampling/pilot.h"
#include "tools/sampling/timed_tiles.h"

namespace traces {
class TraceWriter;
}

namespace tools {

/// Parameters of tile sampling (--tile-sampling, --image).
struct TileSampling {
  double share = 0.05;  ///< share of the frame's work to measure
  /// Relative half-width of the intervals of time and energy, below which --tile-sampling auto simulates no more
  /// blocks. 0: a fixed share of the frame is simulated.
  double target = 0;
  bool full_image = true;  ///< render all tiles, including those that are not simulated
};

/// Parses --tile-sampling ("5%" or "auto") and --image ("full" or "none"); throws InputError for other texts.
TileSampling parse_tile_sampling(const std::string& sampling, const std::string& image);

/// Estimates the share of a frame's tiles that tile sampling simulates on the machine of `config`; 1 for all tiles.
double simulated_share(const RunConfig& config, const kernels::ProgramSpec& program, const TileSampling& sampling);

/// Throws InputError for a program whose tiles cannot be sampled.
void check_tile_sampling(const kernels::ProgramSpec& program);

/// The work of a frame whose tiles are sampled: rendered, or read from a record.
struct SampledWork {
  /// Makes the frame's program, once per round of sampling.
  std::function<std::unique_ptr<kernels::FrameProgram>()> make_frame;
  kernels::FrameProgram& pilot;  ///< a picture with few samples and the same tiles
  double thinning = 1;           ///< samples of the frame per sample of the pilot
  const traces::Tracer& tracer;
};

/// Simulates some tiles of a frame and estimates the result of simulate_frame() from them (docs/sampling.md).
FrameResult simulate_sampled(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                             const TileSampling& sampling, Progress* progress = nullptr);
/// Does the same for work from another source. A record has no picture.
FrameResult simulate_sampled(const Inputs& inputs, const kernels::ProgramSpec& program, const SampledWork& work,
                             std::uint32_t threads, const TileSampling& sampling, Progress* progress = nullptr);

/// Renders the current frame and its pilot, and writes the work of both to a trace, for sampling on many machines.
void record_sampled_work(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                         traces::TraceWriter& trace);

/// Returns each counter summed over all units of the same kind, by path: "core.tni.trv.counters.l1_hits". Counters that
/// cannot be added are left out.
std::map<std::string, double> summed_counters(std::vector<sim::UnitReport> units);

/// A measured block of tiles: its size, and traits that are also known for the whole frame.
struct SamplePart {
  double size = 0;
  std::vector<double> traits;
};

/// Estimates totals of a whole (a frame) from some of its parts (blocks of tiles), which were drawn with probability
/// proportional to size.
///
/// 1. The rate (quantity per size) is modelled as linear in the traits per size, fitted by ridge regression and
/// evaluated at the whole's traits: a calibration estimator (Deville and Särndal, JASA 1992).
/// 2. The estimate is linear in the observations. So one weight per part serves every quantity, and sums of quantities
///    stay consistent.
class SampleWeights {
 public:
  /// `ridge`: penalty of the ridge regression. 0 is ordinary least squares; a large penalty moves the fitted rate
  /// towards the mean rate of all parts.
  SampleWeights(std::span<const SamplePart> parts, const SamplePart& whole, double ridge);

  const std::vector<double>& part_weights() const { return weights_; }
  /// Returns the estimated total of a quantity over the whole, from its value in each part.
  double total(std::span<const double> observed) const;
  /// Returns the half-width of the 95 % interval of total(), from the residuals of the fit.
  double half_width(std::span<const double> observed) const;
  double degrees_of_freedom() const { return degrees_; }

 private:
  std::vector<double> sizes_;
  std::vector<double> smoother_;  ///< matrix: fitted rates = smoother x observed rates
  std::vector<double> shares_;    ///< weight of each part's rate (quantity per size) in the estimated rate
  std::vector<double> weights_;
  double degrees_ = 0;
};

}  // namespace tools
