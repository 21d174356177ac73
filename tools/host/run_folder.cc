#include "tools/host/run_folder.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "sim/error.h"
#include "tools/host/interrupt.h"

namespace tools {

namespace fs = std::filesystem;

namespace {

fs::path dated_folder() {
  const std::string date = fmt::format("{:%Y-%m-%d_%H-%M-%S}", fmt::localtime(std::time(nullptr)));
  const fs::path parent = fs::absolute("raywatt-out");
  fs::path folder = parent / date;
  for (int n = 2; fs::exists(folder); ++n) folder = parent / fmt::format("{}_{}", date, n);
  return folder;
}

constexpr std::streamsize kLongestStart = 1 << 20;  ///< bytes of a report that hold what it was made by

/// The start of the file of this name if it is one of ours, else nothing. Others have a report.json too.
std::string start_of_results(const fs::path& folder, std::string_view name) {
  std::error_code failed;
  if (!fs::is_regular_file(folder / name, failed)) return {};
  std::string start(kLongestStart, '\0');
  std::ifstream file(folder / name, std::ios::binary);
  file.read(start.data(), kLongestStart);
  start.resize(static_cast<std::size_t>(file.gcount()));
  return std::string_view(start).substr(0, 128).find("\"schema\": \"raywatt-") != std::string_view::npos ? start : "";
}

/// The verb that has written this report.json.
std::string_view verb_of(const std::string& report) {
  constexpr std::string_view kWords = "\"argv\": ";
  const std::size_t words = report.find(kWords);
  if (words == std::string::npos) return "run";
  std::istringstream text(report.substr(words + kWords.size()));
  nlohmann::json argv;
  try {
    text >> argv;
  } catch (const nlohmann::json::exception&) {
    return "run";
  }
  return argv.is_array() && argv.size() > 1 && argv[1] == "trace" ? "trace replay" : "run";
}

enum class Former : std::uint8_t { kNone, kOfOtherVerb, kOwn };

Former former_results(const fs::path& folder, const ResultsOf& verb) {
  const std::string start = start_of_results(folder, verb.mark);
  if (start.empty()) return Former::kNone;
  return verb.name.empty() || verb.name == verb_of(start) ? Former::kOwn : Former::kOfOtherVerb;
}

/// Every file that a verb may leave in its folder.
constexpr std::array<std::string_view, 10> kResults = {"report.json",    "report.txt",    "config.yaml", "image.png",
                                                       "image.exr",      "reference.exr", "verify.json", "embree.png",
                                                       "reproduce.json", "reproduce.md"};

/// figure-1-village.png, debug-similar.png
bool is_picture_of(std::string_view prefix, std::string_view name) {
  return name.starts_with(prefix) && name.ends_with(".png");
}

/// frame-0000.png, frame-0000-debug-similar.png
bool is_frame(std::string_view name) {
  constexpr std::string_view kHead = "frame-", kDigits = "0123456789";
  if (!name.starts_with(kHead)) return false;
  const std::size_t end = name.find_first_not_of(kDigits, kHead.size());
  if (end == std::string_view::npos || end == kHead.size()) return false;
  return name.substr(end) == ".png" || is_picture_of("-debug-", name.substr(end));
}

bool is_result(const fs::directory_entry& entry, const ResultsOf& verb) {
  const std::string name = entry.path().filename().string();
  const bool is_picture = name.ends_with(".png") || name.ends_with(".exr");
  return entry.symlink_status().type() == fs::file_type::regular && (verb.pictures || !is_picture) &&
         (std::ranges::find(kResults, name) != kResults.end() || is_frame(name) || is_picture_of("figure-", name) ||
          is_picture_of("debug-", name));
}

/// Former results of the verb: none in a folder that is not its own.
std::vector<fs::path> former_files(const fs::path& folder, const ResultsOf& verb) {
  std::vector<fs::path> files;
  if (former_results(folder, verb) != Former::kOwn) return files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_result(entry, verb)) files.push_back(entry.path());
  }
  return files;
}

/// Puts the results of `from` into `to` among the files of others, in place of former results.
std::error_code place_among(const fs::path& from, const fs::path& to, const std::vector<fs::path>& former) {
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

/// A folder beside `target` to write into, with what parents are missing. Whatever it holds in the end is removed.
class Staging {
 public:
  explicit Staging(fs::path target) : target_(std::move(target)) {}
  ~Staging() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
    for (const fs::path& parent : made_) fs::remove(parent, ignored);  // unless something is in it by now
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  std::error_code make() {
    const fs::path parent = target_.parent_path();
    std::error_code error;
    for (fs::path p = parent; !fs::exists(p, error) && p.has_relative_path(); p = p.parent_path()) made_.push_back(p);
    // Again if the name is taken by what a killed run has left, or if another run has removed the parent it had made.
    for (int n = 0; n < 100; ++n) {
      const fs::path folder = parent / fmt::format(".{}.{}.{}.tmp", target_.filename().string(), getpid(), n);
      fs::create_directories(parent, error);
      if (!error && fs::create_directory(folder, error)) {
        folder_ = folder;
        return {};
      }
    }
    return error ? error : std::make_error_code(std::errc::file_exists);
  }
  const fs::path& folder() const { return folder_; }

 private:
  const fs::path target_;
  fs::path folder_;
  std::vector<fs::path> made_;  ///< innermost first
};

/// Two folders take each other's place, in one step where the file system can do that.
std::error_code exchange(const fs::path& a, const fs::path& b) {
  if (::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return {};
  const fs::path aside = a.string() + ".old";
  std::error_code error, ignored;
  fs::rename(b, aside, error);
  if (error) return error;
  fs::rename(a, b, error);
  fs::rename(aside, error ? b : a, ignored);
  return error;
}

bool is_occupied(const std::error_code& error) {
  return error == std::errc::directory_not_empty || error == std::errc::file_exists;
}

}  // namespace

RunFolder::RunFolder(fs::path target, bool force, const ResultsOf& verb)
    : verb_(verb), dated_(target.empty()), target_(dated_ ? dated_folder() : std::move(target)) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(target_), error);
  if (error) throw sim::InputError(cannot_be_written(target_, error));
  target_ = canonical;
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (fs::exists(fs::symlink_status(target_, error))) {
    if (!fs::is_directory(target_, error)) {
      throw sim::InputError(fmt::format("{}: is a file, not a folder", target_.string()));
    }
    const Former former = former_results(target_, verb_);
    if (!force && former == Former::kOfOtherVerb) {
      throw sim::InputError(
          fmt::format("{}: holds the results of raywatt {}; choose another folder or give --force to put these among "
                      "them, in place of files of the same name",
                      target_.string(), verb_of(start_of_results(target_, verb_.mark))));
    }
    if (!force && former == Former::kNone && !fs::is_empty(target_, error)) {
      throw sim::InputError(fmt::format(
          "{}: holds files but no former run; choose another folder or give --force to put the results among them",
          target_.string()));
    }
  }
  Staging probe(target_);
  error = probe.make();
  if (error) throw sim::InputError(cannot_be_written(target_, error));
}

bool RunFolder::holds_former_run() const { return former_results(target_, verb_) != Former::kNone; }

void RunFolder::fill(const std::function<std::string(const Open& folder)>& write) {
  std::optional<HoldInterrupts> hold;
  Staging staging(target_);
  std::error_code error;
  const std::string kept = write([&]() -> const fs::path& {
    if (!hold) hold.emplace();
    if (staging.folder().empty()) error = staging.make();
    if (error) throw sim::IoError(cannot_be_written(target_, error));
    return staging.folder();
  });
  fs::rename(staging.folder(), target_, error);  // a full folder is never replaced by this
  while (dated_ && is_occupied(error)) {         // by a run of the same second
    target_ = dated_folder();
    fs::rename(staging.folder(), target_, error);
  }
  if (is_occupied(error)) {
    const std::vector<fs::path> former = former_files(target_, verb_);
    const auto files = static_cast<std::size_t>(std::distance(fs::directory_iterator(target_), {}));
    error =
        former.size() == files ? exchange(staging.folder(), target_) : place_among(staging.folder(), target_, former);
  }
  if (error) throw sim::IoError(cannot_be_written(target_, error));
  tell_if_interrupted(fmt::format("kept {} in {}", kept, target_.string()));
}

}  // namespace tools
