#include <algorithm>
#include <optional>

#include "sim/error.h"
#include "tools/host/interrupt.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/launch/compute.h"
#include "tools/studies/sweep/store/folder.h"
#include "tools/studies/sweep/sweep.h"

namespace tools {
namespace {

/// Has nobody joined slices that all are there, or noted that one has failed?
bool is_left(const sweep::Store& store, const sweep::Point& point) {
  const auto is_good = [&](const sweep::Point& one) { return store.state(one.id) == sweep::Store::State::kGood; };
  const auto has_failed = [&](const sweep::Point& one) { return store.failure(one.id).has_value(); };
  if (!point.is_cut() || is_good(point) || has_failed(point)) return false;
  const std::vector<sweep::Point> slices = slices_of(point);
  return std::ranges::all_of(slices, is_good) ||
         std::ranges::any_of(slices, [&](const auto& one) { return has_failed(one) && !is_good(one); });
}

}  // namespace

void join_sweep(const sweep::SweepFolder& folder) {
  const sweep::Store store = folder.store();
  const HoldInterrupts hold;
  sweep::PointComputer computer(store, 0);
  for (const sweep::Point& point : folder.points()) {
    try {
      if (is_left(store, point)) computer.compute(point, {});
    } catch (const sim::IoError& error) {
      print_message("warning: slices of point {} are not joined: {}", point.n, error.what());
    }
  }
}

}  // namespace tools
