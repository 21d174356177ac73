#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "sim/report/energy.h"
#include "tools/host/view.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Live view of a run: picture so far, utilisation and power of the last interval.
///
///   simulation thread: note() at a tile end, on request ──► copies ──► display thread: lines(), picture()
class LiveRun final : public View, public RunWatcher {
 public:
  /// Sets the configuration of the frames to show.
  void set_config(const RunConfig& config);

  void begin_machine(std::vector<sim::UnitReport> units, const sim::Intervals* intervals) override;
  void publish_frame(std::span<const float> rgb) override;

  std::vector<std::string> lines() override;
  SmallPicture picture(std::size_t width, std::size_t height) override;

 private:
  double until_pj(const std::vector<std::uint64_t>& row, sim::Time end);

  std::mutex mutex_;
  sim::EnergyConfig energy_;
  std::map<std::string, sim::DeviceEvent> device_;
  sim::PowerScales scales_;
  std::uint32_t width_ = 0, height_ = 0;  ///< size of the frame's picture
  std::vector<sim::UnitReport> units_;
  std::unique_ptr<sim::EnergyFormula> formula_;
  const sim::Intervals* intervals_ = nullptr;
  std::size_t wanted_width_ = 0, wanted_height_ = 0;  ///< largest picture that can be shown
  SmallPicture picture_;
  std::vector<std::uint64_t> before_,
      row_;  ///< values at the start and end of the last complete interval; empty before the first
  sim::Time begin_ = 0, end_ = 0;
};

}  // namespace tools
