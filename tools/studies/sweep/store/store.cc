#include "tools/studies/sweep/store/store.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <sstream>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"

namespace tools::sweep {

namespace fs = std::filesystem;

namespace {

using sim::Json;

constexpr std::uint64_t kMostPointBytes = std::uint64_t{1} << 30;
constexpr const char* kPointFile = "point.json";
const std::string kStreamLock = "stream-";

/// Returns the bytes of a result's file; nothing if they do not match the digest.
std::optional<std::string> read_file_of(const fs::path& folder, const std::string& name, const Json& digests) {
  std::string bytes = sim::read_file(folder / name, kMostPointBytes);
  if (sim::sha256_hex(bytes) != digests.at(name).get<std::string>()) return std::nullopt;
  return bytes;
}

/// Returns the result of `read`, or nothing if a file is missing or malformed.
template <class F>
auto if_sound(F&& read) -> decltype(read()) {
  try {
    return read();
  } catch (const sim::JsonError&) {
  } catch (const sim::InputError&) {
  }
  return {};
}

/// Returns the digests in point.json. Throws InputError if that file belongs to another point.
Json read_digests(const fs::path& folder, const std::string& id) {
  const Json point = sim::parse_json(sim::read_file(folder / kPointFile, kMostPointBytes));
  if (sim::sha256_hex(sim::json_line(point.at("made_of"))) != id ||
      !(point.at("files").contains("report.json") || point.at("files").contains(kSliceFile))) {
    throw sim::InputError("another point");
  }
  return point.at("files");
}

/// Returns the point id at the start of a file name, "ID..." or ".ID..."; empty if there is none.
std::string id_in(std::string name) {
  name = name.substr(name.starts_with('.') ? 1 : 0, 64);
  return name.size() == 64 && name.find_first_not_of("0123456789abcdef") == std::string::npos ? name : std::string();
}

std::vector<std::string> list_names(const fs::path& folder) {
  std::error_code failed;
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    names.push_back(entry.path().filename());
  }
  return names;
}

}  // namespace

fs::path Store::default_root() {
  const char* given = std::getenv("RAYWATT_STORE");
  return given != nullptr && *given != '\0' ? fs::path(given) : fs::path("raywatt-out") / "store";
}

fs::path Store::folder_of(const std::string& id) const { return root_ / "points" / id.substr(0, 2) / id; }

fs::path Store::failure_file(const std::string& id) const {
  return root_ / "failed" / id.substr(0, 2) / (id + ".json");
}

PointStatus Store::status_of(const std::string& id) const {
  std::error_code failed;
  const fs::path folder = folder_of(id);
  if (!fs::exists(folder, failed)) return read_failure(id) ? PointStatus::kFailed : PointStatus::kMissing;
  const bool is_sound = if_sound([&] {
    const Json digests = read_digests(folder, id);
    for (const auto& [name, digest] : digests.items()) {
      if (!read_file_of(folder, name, digests)) return false;
    }
    return true;
  });
  return is_sound ? PointStatus::kDone : PointStatus::kDamaged;
}

std::optional<std::string> Store::read_verified_file(const std::string& id, const char* file) const {
  return if_sound([&] { return read_file_of(folder_of(id), file, read_digests(folder_of(id), id)); });
}

std::optional<Failure> Store::read_failure(const std::string& id) const {
  return if_sound([&]() -> std::optional<Failure> {
    const Json json = sim::parse_json(sim::read_file(failure_file(id), kMostPointBytes));
    return Failure{id,
                   sim::whole_number<int>(json.at("exit"), "the number 'exit'"),
                   json.at("error").get<std::string>(),
                   json.at("log").get<std::string>(),
                   json.at("host").get<std::string>(),
                   sim::whole_number<int>(json.at("attempt"), "the number 'attempt'")};
  });
}

std::optional<sim::FileLock> Store::lock_point(const std::string& id) const {
  sim::make_folders(root_ / "locks");
  std::optional<sim::FileLock> lock = sim::FileLock::try_acquire(lock_file(id));
  if (lock) clean_up(id);
  return lock;
}

std::optional<sim::FileLock> Store::lock_stream(const std::string& key) const {
  sim::make_folders(root_ / "locks");
  sim::make_folders(root_ / "streams");
  return sim::FileLock::try_acquire(root_ / "locks" / (kStreamLock + key));
}

bool Store::is_locked(const std::string& id) const { return sim::FileLock::read_holder(lock_file(id)).has_value(); }

void Store::put_result(const std::string& id, const Json& made_of,
                       const std::function<void(const fs::path&)>& write) const {
  const fs::path result = folder_of(id);
  const auto fail = [&](const std::error_code& error) {
    throw sim::IoError(fmt::format("{}: cannot be written: {}", sim::printable(result.string()), error.message()));
  };
  sim::make_folders(root_ / "tmp");
  sim::NewFolder temporary(result, root_ / "tmp");
  if (const std::error_code error = temporary.make()) fail(error);
  try {
    write(temporary.path());
    std::vector<std::string> names = list_names(temporary.path());
    std::ranges::sort(names);
    Json files = Json::object();
    for (const std::string& name : names) {
      files[name] = sim::sha256_hex(sim::read_file(temporary.path() / name, kMostPointBytes));
    }
    sim::write_file_atomically(temporary.path() / kPointFile,
                               sim::json_lines({{"id", id}, {"made_of", made_of}, {"files", files}}));
    sim::make_folders(result.parent_path());
    std::error_code error;
    fs::rename(temporary.path(), result, error);
    const bool was_there = error == std::errc::directory_not_empty || error == std::errc::file_exists;
    if (error && !was_there) fail(error);  // an existing result has the same content
    sim::sync_to_disk(result.parent_path());
    sim::sync_to_disk(root_ / "points");
  } catch (const std::system_error& error) {
    fail(error.code());
  }
}

void Store::put_failure(const Failure& f) const {
  sim::make_folders(failure_file(f.id).parent_path());
  sim::write_file_atomically(failure_file(f.id), sim::json_lines({{"id", f.id},
                                                                  {"exit", f.exit},
                                                                  {"error", sim::printable(f.error, 4096)},
                                                                  {"log", f.log},
                                                                  {"host", f.host},
                                                                  {"attempt", f.attempt}}));
}

void Store::remove_failure(const std::string& id) const {
  std::error_code ignored;
  fs::remove(failure_file(id), ignored);
}

void Store::remove_stream(const std::string& key) const {
  std::error_code ignored;
  fs::remove(stream_file(key), ignored);
}

/// Removes temporary folders of a point and moves a damaged result to damaged/. Requires the point's lock, because
/// other hosts may not see the locks of temporary folders.
void Store::clean_up(const std::string& id) const {
  std::error_code error, ignored;
  for (const std::string& name : list_names(root_ / "tmp")) {
    if (id_in(name) == id) fs::remove_all(root_ / "tmp" / name, ignored);
  }
  if (status_of(id) != PointStatus::kDamaged) return;
  sim::make_folders(root_ / "damaged");
  for (int k = 1; k < 100; ++k) {
    fs::rename(folder_of(id), root_ / "damaged" / fmt::format("{}.{}", id, k), error);
    if (!error) return;
  }
  throw sim::IoError(fmt::format("{}: is damaged and cannot be put aside: {}", sim::printable(folder_of(id).string()),
                                 error.message()));
}

void Store::remove_stale() const {
  std::set<std::string> ids;
  for (const char* folder : {"tmp", "locks"}) {
    for (const std::string& name : list_names(root_ / folder)) ids.insert(id_in(name));
  }
  ids.erase("");
  for (const std::string& id : ids) lock_point(id);  // cleans up, then releases the lock
  for (const std::string& name : list_names(root_ / "locks")) {
    if (name.starts_with(kStreamLock)) lock_stream(name.substr(kStreamLock.size()));
  }
  std::error_code ignored;
  for (const std::string& name : list_names(root_ / "streams")) {
    const std::string key = id_in(name);
    if (key.empty() || name == stream_file(key).filename()) continue;
    if (const std::optional<sim::FileLock> lock = lock_stream(key)) fs::remove(root_ / "streams" / name, ignored);
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root_ / "failed", ignored)) {
    const std::string name = entry.path().filename(), id = id_in(name);
    if (id.empty() || !sim::is_temporary_name(name, id + ".json")) continue;
    if (const std::optional<sim::FileLock> lock = lock_point(id)) fs::remove(entry.path(), ignored);
  }
}

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

namespace {

constexpr std::string_view kFolderSchema = "raywatt-sweep-folder/1";
constexpr std::uint64_t kMostFolderBytes = std::uint64_t{1} << 32;
constexpr std::array<std::string_view, 3> kFiles = {"sweep.json", "sweep.yaml", "points.jsonl"};
/// Files of a sweep's or search's folder that are computed from the results of its points.
constexpr std::array<std::string_view, 5> kResults = {"results.csv", "machines.csv", "index.sqlite", "history.jsonl",
                                                      "front.csv"};

/// True for a temporary file that a killed run has left.
bool is_stale(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename();
  return std::ranges::any_of(kFiles, [&](std::string_view file) { return sim::is_temporary_name(name, file); });
}

/// True for a file or folder that a run may leave in a new folder if it is killed while it starts.
bool is_left_by_killed_start(const fs::directory_entry& entry) {
  const fs::path name = entry.path().filename();
  return name == "lock" || name == "log" || is_stale(entry);
}

bool is_sweep(const fs::path& path) {
  std::error_code failed;
  return fs::is_regular_file(path / "sweep.json", failed);
}

/// Calls f with the contents of sweep.json. Throws InputError if it is malformed.
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

/// Throws InputError for a name that JSON cannot hold.
void check_name(const fs::path& path) {
  if (sim::with_escaped_bytes(path.string()) == path.string()) return;
  throw sim::InputError(fmt::format("{}: the name is no UTF-8, which the files of a sweep are; allowed: another",
                                    sim::printable(path.string())));
}

/// Throws InputError if one of the folder's files is a link, a folder or a device. Removes stale temporary files.
void check_files(const fs::path& path) {
  const sim::ReplaceableOutput own{.kind = "file of the sweep", .any = true};
  for (const std::string_view file : kFiles) sim::check_output(path / file, own);
  for (const std::string_view file : kResults) sim::check_output(path / file, own);
}

constexpr std::array<std::string_view, 2> kOf = {"sweep", "search"};

/// Makes a folder that the user named. Throws InputError if that fails.
void make_named_folder(const fs::path& path) {
  try {
    sim::make_folders(path);
  } catch (const sim::IoError& error) {
    throw sim::InputError(error.what());
  }
}

/// Throws InputError for a folder that is neither empty nor of a sweep (or search). `of`: "sweep" or "search".
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
    if (!is_left_by_killed_start(entry)) {
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
    folder.sets_ = json.value("sets", folder.sets_);
  });
  return folder;
}

std::optional<sim::FileLock> SweepFolder::try_claim(const fs::path& path, FolderKind kind) {
  check_contents(path, kOf[static_cast<std::size_t>(kind)]);
  check_name(fs::absolute(path));
  make_named_folder(path);
  return sim::FileLock::try_acquire(path / "lock", fmt::format("{} {}\n", host_name(), ::getpid()));
}

SweepFolder SweepFolder::create(const fs::path& path, FolderKind kind, const std::string& spec,
                                const std::vector<Point>& points, const fs::path& store,
                                const std::vector<std::string>& slurm, const std::vector<std::string>& sets) {
  const std::string_view what = kOf[static_cast<std::size_t>(kind)];
  SweepFolder folder(fs::absolute(path).lexically_normal());
  folder.store_ = fs::absolute(store).lexically_normal();
  folder.slurm_ = slurm;
  folder.sets_ = sets;
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
  replace("sweep.json", sim::json_lines({{"schema", kFolderSchema},
                                         {"of", what},
                                         {"store", folder.store_.string()},
                                         {"points", points.size()},
                                         {"slurm", slurm},
                                         {"sets", sets}}));
  replace("sweep.yaml", spec);
  std::string lines;
  for (const Point& point : points) lines += format_point_line(point) + "\n";
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
    points.push_back(parse_point_line(line, fmt::format("{}:{}", sim::printable(file.string()), points.size() + 1)));
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
