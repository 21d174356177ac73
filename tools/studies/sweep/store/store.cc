#include "tools/studies/sweep/store/store.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/sha256.h"
#include "tools/studies/sweep/store/durable.h"

namespace tools::sweep {

namespace fs = std::filesystem;

namespace {

using sim::Json;

constexpr std::uint64_t kMostPointBytes = std::uint64_t{1} << 30;
constexpr const char* kPointFile = "point.json";
constexpr const char* kReportFile = "report.json";
const std::string kStreamLock = "stream-";

/// The file as it was written; nothing if it is not.
std::optional<std::string> sound_file(const fs::path& folder, const std::string& name, const Json& digests) {
  std::string bytes = sim::read_file(folder / name, kMostPointBytes);
  if (sim::sha256_hex(bytes) != digests.at(name).get<std::string>()) return std::nullopt;
  return bytes;
}

/// Runs `read`; nothing where a file is missing or malformed.
template <class F>
auto if_sound(F&& read) -> decltype(read()) {
  try {
    return read();
  } catch (const sim::JsonError&) {
  } catch (const sim::InputError&) {
  }
  return {};
}

/// Digests of a point's files, if point.json is sound.
Json digests_of(const fs::path& folder, const std::string& id) {
  const Json point = sim::parse_json(sim::read_file(folder / kPointFile, kMostPointBytes));
  if (sim::sha256_hex(sim::json_line(point.at("made_of"))) != id ||
      !(point.at("files").contains(kReportFile) || point.at("files").contains(kSliceFile))) {
    throw sim::InputError("another point");
  }
  return point.at("files");
}

bool is_id(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

fs::path Store::default_root() {
  const char* given = std::getenv("RAYWATT_STORE");
  return given != nullptr && *given != '\0' ? fs::path(given) : fs::path("raywatt-out") / "store";
}

fs::path Store::folder(const std::string& id) const { return root_ / "points" / id.substr(0, 2) / id; }

fs::path Store::failure_file(const std::string& id) const {
  return root_ / "failed" / id.substr(0, 2) / (id + ".json");
}

Store::State Store::state(const std::string& id) const {
  std::error_code failed;
  const fs::path result = folder(id);
  if (!fs::exists(result, failed)) return State::kMissing;
  const bool good = if_sound([&] {
    const Json digests = digests_of(result, id);
    for (const auto& [name, digest] : digests.items()) {
      if (!sound_file(result, name, digests)) return false;
    }
    return true;
  });
  return good ? State::kGood : State::kDamaged;
}

std::optional<std::string> Store::report(const std::string& id) const {
  return if_sound([&] { return sound_file(folder(id), kReportFile, digests_of(folder(id), id)); });
}

std::optional<std::string> Store::slice(const std::string& id) const {
  return if_sound([&] { return sound_file(folder(id), kSliceFile, digests_of(folder(id), id)); });
}

std::optional<Failure> Store::failure(const std::string& id) const {
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

std::optional<Lock> Store::lock(const std::string& id) const {
  make_folders(root_ / "locks");
  std::optional<Lock> lock = Lock::attempt(lock_file(id));
  if (lock) clean(id);
  return lock;
}

std::optional<Lock> Store::lock_stream(const std::string& key) const {
  make_folders(root_ / "locks");
  make_folders(root_ / "streams");
  return Lock::attempt(root_ / "locks" / (kStreamLock + key));
}

bool Store::is_locked(const std::string& id) const { return Lock::holder(lock_file(id)).has_value(); }

void Store::put(const std::string& id, const Json& made_of, const std::function<void(const fs::path&)>& write) const {
  const fs::path staging = root_ / "tmp" / fmt::format("{}.{}.{}", id, host_name(), getpid());
  try {
    make_folders(staging);
    write(staging);
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(staging)) names.push_back(entry.path().filename());
    std::ranges::sort(names);
    Json files = Json::object();
    for (const std::string& name : names) {
      files[name] = sim::sha256_hex(sim::read_file(staging / name, kMostPointBytes));
    }
    write_durably(staging / kPointFile, sim::json_text({{"id", id}, {"made_of", made_of}, {"files", files}}));
    make_durable(staging);
    const fs::path result = folder(id);
    make_folders(result.parent_path());
    fs::rename(staging, result);  // loses against a result that is there: all are equal
    make_durable(result.parent_path());
    make_durable(root_ / "points");
  } catch (const std::system_error& error) {
    std::error_code ignored;
    fs::remove_all(staging, ignored);
    if (error.code() == std::errc::directory_not_empty || error.code() == std::errc::file_exists) return;
    throw sim::IoError(
        fmt::format("{}: cannot be written: {}", sim::printable(folder(id).string()), error.code().message()));
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(staging, ignored);
    throw;
  }
}

void Store::put_failure(const Failure& f) const {
  make_folders(failure_file(f.id).parent_path());
  sim::write_file_atomically(failure_file(f.id), sim::json_text({{"id", f.id},
                                                                 {"exit", f.exit},
                                                                 {"error", sim::printable(f.error, 4096)},
                                                                 {"log", f.log},
                                                                 {"host", f.host},
                                                                 {"attempt", f.attempt}}));
}

void Store::forget_failure(const std::string& id) const {
  std::error_code ignored;
  fs::remove(failure_file(id), ignored);
}

void Store::remove_stream(const std::string& key) const {
  std::error_code ignored;
  fs::remove(stream(key), ignored);
}

void Store::clean(const std::string& id) const {
  std::error_code error, ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(root_ / "tmp", error)) {
    if (entry.path().filename().string().starts_with(id)) fs::remove_all(entry.path(), ignored);
  }
  if (state(id) != State::kDamaged) return;
  make_folders(root_ / "damaged");
  for (int k = 1; k < 100; ++k) {
    fs::rename(folder(id), root_ / "damaged" / fmt::format("{}.{}", id, k), error);
    if (!error) return;
  }
  throw sim::IoError(
      fmt::format("{}: is damaged and cannot be put aside: {}", sim::printable(folder(id).string()), error.message()));
}

void Store::clean() const {
  std::error_code error;
  std::set<std::string> left;
  for (const fs::directory_entry& entry : fs::directory_iterator(root_ / "tmp", error)) {
    const std::string id = entry.path().filename().string().substr(0, 64);
    if (is_id(id)) left.insert(id);
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(root_ / "locks", error)) {
    const std::string id = entry.path().filename();
    if (is_id(id)) left.insert(id);
  }
  for (const std::string& id : left) lock(id);  // and let go again
  for (const fs::directory_entry& entry : fs::directory_iterator(root_ / "locks", error)) {
    const std::string name = entry.path().filename();
    if (name.starts_with(kStreamLock)) lock_stream(name.substr(kStreamLock.size()));  // likewise
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(root_ / "streams", error)) {
    const std::string name = entry.path().filename();
    const bool is_whole = name.size() == stream(name.substr(0, 64)).filename().string().size();
    if (!is_id(name.substr(0, 64)) || is_whole) continue;
    if (const std::optional<Lock> lock = lock_stream(name.substr(0, 64))) fs::remove(entry.path(), error);
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root_ / "failed", error)) {
    const std::string name = entry.path().filename(), id = name.substr(0, 64);
    if (!is_id(id) || !sim::is_left_of(name, id + ".json")) continue;
    if (const std::optional<Lock> held = lock(id)) fs::remove(entry.path(), error);
  }
}

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace tools::sweep
