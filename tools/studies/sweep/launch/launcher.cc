#include "tools/studies/sweep/launch/launcher.h"

#include <algorithm>

namespace tools::sweep {
namespace {

/// Adds what came of a later batch.
void add_times(const BatchEnd& later, BatchEnd& end) {
  const double seconds = end.seconds + later.seconds;
  if (seconds > 0) end.busy = (end.busy * end.seconds + later.busy * later.seconds) / seconds;
  end.seconds = seconds;
  end.workers = std::max(end.workers, later.workers);
  end.interrupted = end.interrupted || later.interrupted;
}

}  // namespace

std::uint64_t BatchEnd::count(Fate fate) const { return static_cast<std::uint64_t>(std::ranges::count(fates, fate)); }

bool Launcher::is_wanted(const Point& point) const {
  return store_.state(point.id) != Store::State::kGood && (retry_failed_ || !store_.failure(point.id));
}

void Launcher::forget_failure(const Point& point) const {
  if (const std::optional<Lock> lock = store_.lock(point.id)) store_.forget_failure(point.id);
}

/// A batch some of whose points are cut: first slices, then points that are to be joined.
class Launcher::CutBatch {
 public:
  CutBatch(Launcher& launcher, std::span<const Point> points) : launcher_(launcher), points_(points) {
    cut_.resize(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      const std::vector<Point> slices = launcher.is_wanted(points[p]) ? slices_of(points[p]) : std::vector<Point>();
      if (slices.empty()) add(points[p], p);
      for (const Point& slice : slices) add(slice, p);
      if (!slices.empty() && launcher.retry_failed_) launcher.forget_failure(points[p]);
      cut_[p].is_cut = !slices.empty();
    }
  }

  BatchEnd run(const Watch& watch, const SliceWatch& slice_watch) {
    BatchEnd end = launcher_.play(jobs_, [&](std::size_t j, Fate fate) {
      jobs_[j].slice != 0 ? slice_watch(owners_[j]) : watch(owners_[j], fate);
    });
    std::vector<Fate> fates(points_.size(), Fate::kMissing);
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      Cut& cut = cut_[owners_[j]];
      if (!cut.is_cut) fates[owners_[j]] = end.fates[j];
      cut.is_new = cut.is_new || end.fates[j] == Fate::kComputed;
      cut.lacks_some = cut.lacks_some || end.fates[j] == Fate::kMissing;
    }
    end.fates = std::move(fates);
    join(end, watch);
    return end;
  }

 private:
  struct Cut {
    bool is_cut = false;
    bool is_new = false;      ///< a slice was computed
    bool lacks_some = false;  ///< a slice was not
  };

  void add(const Point& job, std::size_t owner) {
    jobs_.push_back(job);
    owners_.push_back(owner);
  }

  /// Joins slices that whoever computed the last one has not.
  void join(BatchEnd& end, const Watch& watch) {
    std::vector<Point> wholes;
    std::vector<std::size_t> owners;
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (!cut_[p].is_cut || cut_[p].lacks_some || (end.interrupted && launcher_.is_wanted(points_[p]))) continue;
      wholes.push_back(points_[p]);
      owners.push_back(p);
    }
    const BatchEnd joined = launcher_.play(wholes, [&](std::size_t w, Fate fate) {
      const bool is_new = fate == Fate::kFound && cut_[owners[w]].is_new;
      end.fates[owners[w]] = is_new ? Fate::kComputed : fate;
      watch(owners[w], end.fates[owners[w]]);
    });
    add_times(joined, end);
  }

  Launcher& launcher_;
  const std::span<const Point> points_;
  std::vector<Cut> cut_;  ///< points by number
  std::vector<Point> jobs_;
  std::vector<std::size_t> owners_;  ///< points of the jobs
};

BatchEnd Launcher::run(std::span<const Point> points, const Watch& watch, const SliceWatch& slice_watch) {
  if (std::ranges::none_of(points, &Point::is_cut)) return play(points, watch);
  return CutBatch(*this, points).run(watch, slice_watch);
}

}  // namespace tools::sweep
