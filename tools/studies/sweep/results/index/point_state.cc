#include "tools/studies/sweep/results/index/point_state.h"

#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "sim/error.h"

namespace tools::results {

namespace fs = std::filesystem;

namespace {

PointState failed(const std::optional<sweep::Failure>& failure) {
  PointState state{Status::kFailed, {}, {}};
  if (failure) {
    state.error = {failure->error, failure->log, std::int64_t{failure->exit}, failure->host,
                   std::int64_t{failure->attempt}};
  } else {
    state.error.text = "the record of its failure is damaged";
  }
  return state;
}

PointState damaged(std::string why) {
  PointState state{Status::kDamaged, {}, {}};
  state.error.text = std::move(why);
  return state;
}

PointState look_up(const sweep::Store& store, const std::string& id, MetricNames& names) {
  if (const std::optional<std::string> report = store.report(id)) {
    PointState state{Status::kDone, {}, {}};
    const std::optional<std::string> problem = scan_report(*report, names, state.report);
    return problem ? damaged("report.json: " + *problem) : state;
  }
  switch (status_without_report(store, id)) {
    case Status::kDamaged:
      return damaged("its files are not as they were written");
    case Status::kFailed:
      return failed(store.failure(id));
    default:
      return {};
  }
}

}  // namespace

std::string_view name_of(Status status) {
  switch (status) {
    case Status::kDone:
      return "done";
    case Status::kFailed:
      return "failed";
    case Status::kMissing:
      return "missing";
    case Status::kDamaged:
      return "damaged";
  }
  return {};
}

std::string missing_text(const StatusCounts& counts) {
  std::size_t all = 0, without = 0;
  for (const auto& [status, count] : counts) all += count;
  std::string kinds;
  for (const Status status : {Status::kFailed, Status::kDamaged, Status::kMissing}) {
    const auto found = counts.find(name_of(status));
    if (found == counts.end()) continue;
    without += found->second;
    kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", found->second, found->first);
  }
  return without == 0 ? "" : fmt::format("{} of {} points have no result: {}", without, all, kinds);
}

Status status_without_report(const sweep::Store& store, const std::string& id) {
  if (fs::exists(store.folder(id))) return Status::kDamaged;
  return fs::exists(store.failure_file(id)) ? Status::kFailed : Status::kMissing;
}

PointState read_point_state(const sweep::Store& store, const std::string& id, MetricNames& names) {
  try {
    return look_up(store, id, names);
  } catch (const sim::InputError& error) {
    return damaged(error.what());
  } catch (const sim::IoError& error) {
    return damaged(error.what());
  } catch (const fs::filesystem_error& error) {
    return damaged(error.what());
  }
}

std::string file_mark(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return "-";
  return fmt::format("{} {} {}.{:09}", status.st_size, status.st_ino, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

std::string state_mark(const sweep::Store& store, const std::string& id) {
  const fs::path folder = store.folder(id);
  return fmt::format("{}, {}, {}, {}", file_mark(folder), file_mark(folder / "report.json"),
                     file_mark(folder / "point.json"), file_mark(store.failure_file(id)));
}

}  // namespace tools::results
