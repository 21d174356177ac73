#include "tools/sweep/results/point_state.h"

#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "tools/sweep/store.h"

namespace tools::results {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::uint64_t kMostReportBytes = 256 << 20, kMostRecordBytes = 4 << 20;

Value plain(const Json& record, const char* key) {
  const auto found = record.find(key);
  if (found == record.end() || found->is_null()) return {};
  if (found->is_number_integer()) return found->get<std::int64_t>();
  return found->is_string() ? found->get<std::string>() : found->dump();
}

PointState failed(const fs::path& file) {
  PointState state{Status::kFailed, {}, {}};
  const Json record = Json::parse(sim::read_file(file, kMostRecordBytes), nullptr, false);
  if (!record.is_object()) {
    state.error.text = "the record of its failure is damaged";
    return state;
  }
  state.error = {exact_text(plain(record, "error")), exact_text(plain(record, "log")), plain(record, "exit"),
                 plain(record, "host"), plain(record, "attempt")};
  return state;
}

PointState damaged(std::string why) {
  PointState state{Status::kDamaged, {}, {}};
  state.error.text = std::move(why);
  return state;
}

PointState look_up(const fs::path& store, const std::string& id, MetricNames& names) {
  const fs::path folder = point_folder(store, id), report = folder / "report.json";
  if (!fs::exists(folder)) {
    const fs::path record = failure_record(store, id);
    return fs::exists(record) ? failed(record) : PointState();
  }
  if (!fs::exists(report)) return damaged("its folder holds no report.json");
  PointState state{Status::kDone, {}, {}};
  std::optional<std::string> text;
  if (fs::exists(folder / "point.json")) {
    text = sweep::Store(store).report(id);
    if (!text) return damaged("report.json is not as it was written");
  } else {
    text = sim::read_file(report, kMostReportBytes);
  }
  const auto problem = scan_report(*text, names, state.report);
  return problem ? damaged("report.json: " + *problem) : state;
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

fs::path point_folder(const fs::path& store, const std::string& id) { return store / "points" / id.substr(0, 2) / id; }
fs::path failure_record(const fs::path& store, const std::string& id) {
  return store / "failed" / id.substr(0, 2) / (id + ".json");
}

PointState read_point_state(const fs::path& store, const std::string& id, MetricNames& names) {
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

std::string state_mark(const fs::path& store, const std::string& id) {
  const fs::path folder = point_folder(store, id);
  return fmt::format("{}, {}, {}, {}", file_mark(folder), file_mark(folder / "report.json"),
                     file_mark(folder / "point.json"), file_mark(failure_record(store, id)));
}

}  // namespace tools::results
