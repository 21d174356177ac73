#include "tools/studies/sweep/store/folder.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"

namespace tools::sweep {

namespace fs = std::filesystem;

namespace {

using sim::Json;

constexpr std::string_view kFolderSchema = "raywatt-sweep-folder/1";
constexpr std::uint64_t kMostFolderBytes = std::uint64_t{1} << 32;
constexpr std::array<std::string_view, 3> kFiles = {"sweep.json", "sweep.yaml", "points.jsonl"};
/// Files that are made from the results of the points.
constexpr std::array<std::string_view, 4> kResults = {"results.csv", "index.sqlite", "history.jsonl", "front.csv"};

/// True for a temporary file that a killed run has left.
bool is_stale(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename();
  return std::ranges::any_of(kFiles, [&](std::string_view file) { return sim::is_temporary_name(name, file); });
}

/// True for an entry that a run may have left in a new folder when it was killed at its start.
bool is_of_begun_run(const fs::directory_entry& entry) {
  const fs::path name = entry.path().filename();
  return name == "lock" || name == "log" || is_stale(entry);
}

bool is_sweep(const fs::path& path) {
  std::error_code failed;
  return fs::is_regular_file(path / "sweep.json", failed);
}

/// Calls f with the contents of sweep.json. InputError if it is malformed.
void read_description(const fs::path& path, auto&& f) {
  const std::string bytes = sim::read_file(path / "sweep.json", kMostFolderBytes);
  const auto damaged = [&](const std::exception& error) {
    return sim::InputError(
        fmt::format("{}/sweep.json: is damaged: {}", sim::printable(path.string()), sim::printable(error.what())));
  };
  try {
    f(sim::parse_json(bytes));
  } catch (const sim::JsonError& error) {
    throw damaged(error);
  } catch (const sim::InputError& error) {
    throw damaged(error);
  }
}

/// InputError for a name that JSON cannot hold.
void check_name(const fs::path& path) {
  if (sim::with_escaped_bytes(path.string()) == path.string()) return;
  throw sim::InputError(fmt::format("{}: the name is no UTF-8, which the files of a sweep are; allowed: another",
                                    sim::printable(path.string())));
}

/// InputError if one of the folder's files is a link, a folder or a device. Removes stale temporary files.
void check_files(const fs::path& path) {
  const sim::Replaceable own{.kind = "file of the sweep", .any = true};
  for (const std::string_view file : kFiles) sim::check_output(path / file, own);
  for (const std::string_view file : kResults) sim::check_output(path / file, own);
}

constexpr std::array<std::string_view, 2> kOf = {"sweep", "search"};

/// Makes a folder that the user named. InputError if that fails.
void make_named_folder(const fs::path& path) {
  try {
    sim::make_folders(path);
  } catch (const sim::IoError& error) {
    throw sim::InputError(error.what());
  }
}

/// InputError for a folder with other contents than a sweep or a search of this kind.
void check_contents(const fs::path& path, std::string_view of) {
  const std::string shown = sim::printable(path.string());
  std::error_code failed;
  if (!fs::exists(path, failed)) return;
  if (is_sweep(path)) {
    Json is;
    read_description(path, [&](const Json& json) { is = json.value("of", Json()); });
    if (is.is_null() || is == of) return;
    throw sim::InputError(
        fmt::format("{}: holds a {}, not a {}; choose another folder", shown, sim::printable(sim::json_line(is)), of));
  }
  if (!fs::is_directory(path, failed)) throw sim::InputError(shown + ": is a file, not a folder");
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (!is_of_begun_run(entry)) {
      throw sim::InputError(shown + ": holds files but no sweep; choose another folder");
    }
  }
}

}  // namespace

SweepFolder SweepFolder::open(const fs::path& path) {
  const std::string shown = sim::printable(path.string());
  if (!is_sweep(path)) throw sim::InputError(shown + ": holds no sweep; begin one with raywatt sweep run FILE -o DIR");
  SweepFolder folder(fs::absolute(path).lexically_normal());
  read_description(path, [&](const Json& json) {
    if (json.at("schema") != kFolderSchema) throw sim::InputError("it is a sweep of another version");
    folder.store_ = json.at("store").get<std::string>();
    folder.slurm_ = json.at("slurm").get<std::vector<std::string>>();
  });
  return folder;
}

std::optional<sim::FileLock> SweepFolder::try_claim(const fs::path& path, Of of) {
  check_contents(path, kOf[static_cast<std::size_t>(of)]);
  check_name(fs::absolute(path));
  make_named_folder(path);
  return sim::FileLock::try_acquire(path / "lock", fmt::format("{} {}\n", host_name(), ::getpid()));
}

SweepFolder SweepFolder::create(const fs::path& path, Of of, const std::string& spec, const std::vector<Point>& points,
                                const fs::path& store, const std::vector<std::string>& slurm) {
  const std::string_view what = kOf[static_cast<std::size_t>(of)];
  SweepFolder folder(fs::absolute(path).lexically_normal());
  folder.store_ = fs::absolute(store).lexically_normal();
  folder.slurm_ = slurm;
  check_name(folder.store_);
  make_named_folder(folder.store_);
  sim::make_folders(folder.log_folder());
  check_files(folder.path_);
  const auto replace = [&](const char* name, const std::string& text) {
    const fs::path file = folder.path_ / name;
    std::error_code failed;
    if (fs::exists(file, failed) && sim::read_file(file, kMostFolderBytes) == text) return;
    sim::write_file_atomically(file, text);
  };
  replace("sweep.json", sim::json_text({{"schema", kFolderSchema},
                                        {"of", what},
                                        {"store", folder.store_.string()},
                                        {"points", points.size()},
                                        {"slurm", slurm}}));
  replace("sweep.yaml", spec);
  std::string lines;
  for (const Point& point : points) lines += to_line(point) + "\n";
  replace("points.jsonl", lines);
  return folder;
}

std::vector<Point> SweepFolder::read_points() const {
  const fs::path file = path_ / "points.jsonl";
  std::error_code failed;
  if (!fs::exists(file, failed)) return {};  // killed before it was written
  std::istringstream lines(sim::read_file(file, kMostFolderBytes));
  std::vector<Point> points;
  for (std::string line; std::getline(lines, line);) {
    points.push_back(read_line(line, fmt::format("{}:{}", sim::printable(file.string()), points.size() + 1)));
    if (points.back().n != points.size() - 1) {
      throw sim::InputError(fmt::format("{}:{}: is point {}, not {}", sim::printable(file.string()), points.size(),
                                        points.back().n, points.size() - 1));
    }
  }
  return points;
}

std::optional<SweepFolder::Runner> SweepFolder::find_runner() const {
  const std::optional<std::string> note = sim::FileLock::read_holder(path_ / "lock");
  if (!note) return std::nullopt;
  Runner runner;
  std::istringstream(*note) >> runner.host >> runner.process;
  return runner;
}

void SweepFolder::check_exists() const {
  std::error_code failed;
  if (fs::exists(path_ / "sweep.json", failed)) return;
  throw sim::IoError(
      fmt::format("{}: was moved or removed during the run; computed points are in {}; move it back and type the same "
                  "command again",
                  sim::printable(path_.string()), sim::printable(store_.string())));
}

void SweepFolder::log_run(const Json& run) const {
  sim::append_to_file(log_folder() / "runs.jsonl", sim::json_line(run) + "\n");
}

}  // namespace tools::sweep
