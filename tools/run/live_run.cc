#include "tools/run/live_run.h"

#include <algorithm>

#include <fmt/format.h>

#include "hw_models/dram/dram_energy.h"
#include "hw_models/machines/gpu_config.h"
#include "sim/report/table.h"
#include "sim/unit_report.h"
#include "tools/analysis/limiter.h"
#include "tools/analysis/picture.h"
#include "tools/run/frame/power.h"

namespace tools {
namespace {

/// Scales a picture down by averaging pixels; never up.
SmallPicture scale_down(std::span<const float> rgb, std::size_t width, std::size_t height, std::size_t most_width,
                        std::size_t most_height) {
  const std::size_t factor =
      std::max({std::size_t{1}, (width + most_width - 1) / most_width, (height + most_height - 1) / most_height});
  SmallPicture small{width / factor, height / factor, {}};
  if (small.width == 0 || small.height == 0) return {};
  std::vector<float> means(3 * small.width * small.height);
  for (std::size_t y = 0; y < small.height * factor; ++y) {
    for (std::size_t x = 0; x < small.width * factor; ++x) {
      float* mean = &means[3 * (y / factor * small.width + x / factor)];
      for (std::size_t c = 0; c < 3; ++c) mean[c] += rgb[3 * (y * width + x) + c];
    }
  }
  for (float& mean : means) mean /= static_cast<float>(factor * factor);
  small.rgb = to_rgb8(means);
  return small;
}

}  // namespace

void LiveRun::set_config(const RunConfig& config) {
  const std::lock_guard lock(mutex_);
  energy_ = config.energy;
  device_ = hw::dram_energy_events(config.gpu->dram);
  scales_ = power_scales(config);
  width_ = config.render.width;
  height_ = config.render.height;
}

void LiveRun::begin_machine(std::vector<sim::UnitReport> units, const sim::Intervals* intervals) {
  const std::lock_guard lock(mutex_);
  units_ = std::move(units);
  formula_ = std::make_unique<sim::EnergyFormula>(units_, energy_, device_, 0, scales_);
  intervals_ = intervals;
  before_.clear();
  row_.clear();
}

void LiveRun::publish_frame(std::span<const float> rgb) {
  const std::lock_guard lock(mutex_);
  requested_ = false;
  if (wanted_width_ != 0 && wanted_height_ != 0 && rgb.size() == std::size_t{3} * width_ * height_) {
    picture_ = scale_down(rgb, width_, height_, wanted_width_, wanted_height_);
  }
  if (intervals_ == nullptr || intervals_->size() == 0) return;
  const std::size_t last = intervals_->size() - 1;
  row_.assign(intervals_->row(last).begin(), intervals_->row(last).end());
  before_.assign(row_.size(), 0);
  begin_ = 0;
  end_ = intervals_->interval_end(last);
  if (last == 0) return;
  std::ranges::copy(intervals_->row(last - 1), before_.begin());
  begin_ = intervals_->interval_end(last - 1);
}

double LiveRun::until_pj(const std::vector<std::uint64_t>& row, sim::Time end) {
  sim::each_value(units_, [&](std::uint64_t& value, std::size_t i, sim::CounterKind) { value = row[i]; });
  formula_->set_counts(units_, end);
  return formula_->total_pj(&sim::Band::nominal);
}

std::vector<std::string> LiveRun::lines() {
  const std::lock_guard lock(mutex_);
  requested_ = true;
  if (row_.empty()) return {};
  const double watts = (until_pj(row_, end_) - until_pj(before_, begin_)) / static_cast<double>(end_ - begin_) *
                       sim::kWattsPerPicojouleOverFemtosecond;
  sim::each_value(units_, [&](std::uint64_t& value, std::size_t i, sim::CounterKind) { value = row_[i] - before_[i]; });
  const Utilisation used = utilisation_of(units_);
  return {fmt::format("T&I {:.0f} %  SRP {:.0f} %  DRAM {:.0f} %  {:.2f} W  at {:.0f} us of simulated time",
                      100 * used.tni, 100 * used.srp, 100 * used.dram, watts,
                      static_cast<double>(end_) / sim::kFemtosecondsPerMicrosecond)};
}

SmallPicture LiveRun::picture(std::size_t width, std::size_t height) {
  const std::lock_guard lock(mutex_);
  wanted_width_ = width;
  wanted_height_ = height;
  return picture_;
}

}  // namespace tools
