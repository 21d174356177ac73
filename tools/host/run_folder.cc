#include "tools/host/run_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <system_error>
#include <tuple>
#include <vector>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "tools/host/process.h"

namespace tools {

namespace fs = std::filesystem;

namespace {

fs::path dated_folder() {
  const std::string date = fmt::format("{:%Y-%m-%d_%H-%M-%S}", fmt::localtime(std::time(nullptr)));
  std::error_code ignored;  // the error is reported when the folder is created
  const fs::path parent = fs::absolute("raywatt-out", ignored);
  fs::path folder = parent / date;
  for (int n = 2; fs::exists(folder, ignored); ++n) folder = parent / fmt::format("{}_{}", date, n);
  return folder;
}

constexpr std::streamsize kLongestStart = 1 << 20;  ///< size of a report's beginning that contains its command line

/// Returns the first bytes of a result file; empty if there is none or another program wrote it.
std::string read_first_bytes(const fs::path& folder, std::string_view name) {
  std::error_code failed;
  if (!fs::is_regular_file(folder / name, failed)) return {};
  std::string start(kLongestStart, '\0');
  std::ifstream file(folder / name, std::ios::binary);
  file.read(start.data(), kLongestStart);
  start.resize(static_cast<std::size_t>(file.gcount()));
  return std::string_view(start).substr(0, 128).find("\"schema\": \"raywatt-") != std::string_view::npos ? start : "";
}

/// Returns the verb in the command line of a report.json.
std::string_view verb_of(const std::string& report) {
  std::size_t at = report.find("\"argv\": [");
  if (at != std::string::npos) at = report.find('"', report.find('[', at));  // the command line's first word
  if (at == std::string::npos) return "run";
  for (++at; at < report.size() && report[at] != '"'; ++at) at += report[at] == '\\' ? 1 : 0;
  at = report.find_first_not_of("\", \n", std::min(at, report.size()));
  return at != std::string::npos && report.compare(at, 6, "trace\"") == 0 ? "trace replay" : "run";
}

enum class Former : std::uint8_t { kNone, kOfOtherVerb, kOwn };

Former former_results(const fs::path& folder, const VerbResults& verb) {
  const std::string start = read_first_bytes(folder, verb.mark);
  if (start.empty()) return Former::kNone;
  return verb.name.empty() || verb.name == verb_of(start) ? Former::kOwn : Former::kOfOtherVerb;
}

/// Names of the files that verbs write into their folders.
constexpr std::array<std::string_view, 18> kResults = {
    "report.json",    "report.txt",  "config.yaml", "tiles.json",     "intervals.bin.zst", "timeline.pftrace",
    "image.png",      "image.exr",   "pixels.exr",  "reference.exr",  "reference.png",     "reference.json",
    "difference.png", "verify.json", "embree.png",  "reproduce.json", "reproduce.md",      "reference-tiles.json"};

/// True for a picture's file name with this prefix, e.g. figure-1-village.png or debug-steps.exr.
bool is_picture_name(std::string_view prefix, std::string_view name) {
  return name.starts_with(prefix) && (name.ends_with(".png") || name.ends_with(".exr"));
}

/// True for the file name of a frame's picture, e.g. frame-0000.png or frame-0000-debug-similar.png.
bool is_frame_picture_name(std::string_view name) {
  constexpr std::string_view kHead = "frame-", kDigits = "0123456789";
  if (!name.starts_with(kHead)) return false;
  const std::size_t end = name.find_first_not_of(kDigits, kHead.size());
  if (end == std::string_view::npos || end == kHead.size()) return false;
  return name.substr(end) == ".png" || is_picture_name("-debug-", name.substr(end));
}

bool is_result(const fs::directory_entry& entry, const VerbResults& verb) {
  const std::string name = entry.path().filename().string();
  const bool is_picture = name.ends_with(".png") || name.ends_with(".exr");
  return entry.symlink_status().type() == fs::file_type::regular && (verb.pictures || !is_picture) &&
         is_result_name(name);
}

/// Returns the result files that an earlier run of the verb left in the folder; none in a folder of another verb.
std::vector<fs::path> earlier_result_files(const fs::path& folder, const VerbResults& verb) {
  std::vector<fs::path> files;
  if (former_results(folder, verb) != Former::kOwn) return files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_result(entry, verb)) files.push_back(entry.path());
  }
  return files;
}

/// Throws InputError if the folder cannot be read, or if it contains a folder, link or device with the name of a result
/// file.
void check_result_names(const fs::path& folder) {
  std::error_code failed, vanished;
  fs::directory_iterator entry(folder, failed);
  for (; !failed && entry != fs::directory_iterator(); entry.increment(failed)) {
    if (!is_result_name(entry->path().filename().string())) continue;
    if (entry->symlink_status(vanished).type() == fs::file_type::regular) continue;
    throw sim::InputError(
        fmt::format("{}: has the name of a result and is not a regular file; move it away", entry->path().string()));
  }
  if (failed) throw sim::InputError(fmt::format("{}: cannot be read ({})", folder.string(), failed.message()));
}

/// Moves the results from the folder `from` to the folder `to`, and removes former results there. Other files in `to`
/// stay.
std::error_code move_results(const fs::path& from, const fs::path& to, const std::vector<fs::path>& former) {
  std::vector<fs::path> results;
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) results.push_back(entry.path().filename());
  std::error_code error;
  for (const fs::path& file : former) {
    if (std::ranges::find(results, file.filename()) == results.end()) fs::remove(file, error);
    if (error) return error;
  }
  for (const fs::path& name : results) {
    fs::rename(from / name, to / name, error);
    if (error) return error;
  }
  return {};
}

std::string cannot_be_written(const fs::path& folder, const std::error_code& error) {
  return fmt::format("{}: cannot be written ({})", folder.string(), error.message());
}

/// Exchanges two folders, atomically where the file system supports it.
std::error_code exchange_folders(const fs::path& a, const fs::path& b) {
  if (::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return {};
  const fs::path aside = a.string() + ".old";
  std::error_code error, ignored;
  fs::rename(b, aside, error);
  if (error) return error;
  fs::rename(a, b, error);
  fs::rename(aside, error ? b : a, ignored);
  return error;
}

/// Copies permissions and group of the folder `former` to `folder`, which will replace it.
void copy_permissions(const fs::path& folder, const fs::path& former) {
  struct stat about {};
  if (::stat(former.c_str(), &about) != 0) return;
  // before permissions are set, because chown() clears setgid
  std::ignore = ::chown(folder.c_str(), static_cast<uid_t>(-1), about.st_gid);
  ::chmod(folder.c_str(), about.st_mode & 07777U);
}

/// True if the folder is the working directory. Such a folder is not replaced, because the user's shell would be left
/// in a deleted folder.
bool is_working_directory(const fs::path& folder) {
  std::error_code ignored;
  return fs::equivalent(folder, fs::current_path(ignored), ignored);
}

bool is_occupied(const std::error_code& error) {
  return error == std::errc::directory_not_empty || error == std::errc::file_exists;
}

}  // namespace

bool is_result_name(std::string_view name) {
  return std::ranges::find(kResults, name) != kResults.end() || is_frame_picture_name(name) ||
         is_picture_name("figure-", name) || is_picture_name("debug-", name);
}

RunFolder::RunFolder(fs::path target, bool force, const VerbResults& verb)
    : verb_(verb), dated_(target.empty()), target_(dated_ ? dated_folder() : std::move(target)) {
  std::error_code error;
  fs::path canonical = fs::absolute(target_, error);
  if (!error) canonical = fs::weakly_canonical(canonical, error);
  if (error) throw sim::InputError(cannot_be_written(target_, error));
  target_ = canonical;
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (fs::exists(fs::symlink_status(target_, error))) {
    if (!fs::is_directory(target_, error)) {
      throw sim::InputError(fmt::format("{}: is a file, not a folder", target_.string()));
    }
    if (::access(target_.c_str(), W_OK | X_OK) != 0) {
      throw sim::InputError(cannot_be_written(target_, {errno, std::generic_category()}));
    }
    const Former former = former_results(target_, verb_);
    check_result_names(target_);
    if (!force && former == Former::kOfOtherVerb) {
      throw sim::InputError(
          fmt::format("{}: holds the results of raywatt {}; choose another folder or give --force to put these among "
                      "them, in place of files of the same name",
                      target_.string(), verb_of(read_first_bytes(target_, verb_.mark))));
    }
    if (!force && former == Former::kNone && !fs::is_empty(target_, error)) {
      throw sim::InputError(
          fmt::format("{}: holds files but no {} of a former run; choose another folder or give --force to put the "
                      "results among them",
                      target_.string(), verb_.mark));
    }
  }
  sim::NewFolder probe(target_);
  probe.remove_stale();
  error = probe.make();
  if (error) throw sim::InputError(cannot_be_written(target_, error));
}

bool RunFolder::has_earlier_run() const { return former_results(target_, verb_) != Former::kNone; }

void RunFolder::fill(const std::function<std::string(const Open& folder)>& write) {
  std::optional<HoldInterrupts> hold;
  sim::NewFolder staging(target_);
  staging.remove_stale();
  std::error_code error;
  const std::string kept = write([&]() -> const fs::path& {
    if (!hold) hold.emplace();
    if (staging.path().empty()) error = staging.make();
    if (error) throw sim::IoError(cannot_be_written(target_, error));
    return staging.path();
  });
  copy_permissions(staging.path(), target_);
  if (is_working_directory(target_)) {
    error = std::make_error_code(std::errc::file_exists);
  } else {
    fs::rename(staging.path(), target_, error);  // fails if the target is not empty
  }
  while (dated_ && is_occupied(error)) {  // another run began in the same second
    target_ = dated_folder();
    fs::rename(staging.path(), target_, error);
  }
  if (is_occupied(error)) {
    const std::vector<fs::path> former = earlier_result_files(target_, verb_);
    const auto files = static_cast<std::size_t>(std::distance(fs::directory_iterator(target_), {}));
    error = former.size() == files && !is_working_directory(target_) ? exchange_folders(staging.path(), target_)
                                                                     : move_results(staging.path(), target_, former);
  }
  if (error) throw sim::IoError(cannot_be_written(target_, error));
  dated_ = false;
  set_interrupt_note(fmt::format("kept {} in {}", kept, target_.string()));
}

}  // namespace tools
