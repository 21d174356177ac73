#include "tools/run_folder.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <ctime>

#include "sim/error.h"

namespace tools {

namespace fs = std::filesystem;

namespace {

fs::path dated_folder() {
  const std::string date = fmt::format("{:%Y-%m-%d_%H-%M-%S}", fmt::localtime(std::time(nullptr)));
  fs::path folder = fs::path("raywatt-out") / date;
  for (int n = 2; fs::exists(folder); ++n) folder = fs::path("raywatt-out") / fmt::format("{}_{}", date, n);
  return folder;
}

}  // namespace

RunFolder::RunFolder(fs::path target, bool force, std::string_view mark)
    : target_(target.empty() ? dated_folder() : std::move(target)) {
  target_ = fs::absolute(target_).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();
  std::error_code error;
  if (fs::exists(target_, error)) {
    if (!fs::is_directory(target_)) throw sim::InputError(fmt::format("{}: is a file, not a folder", target_.string()));
    const bool ours = fs::is_empty(target_, error) || fs::exists(target_ / mark, error);
    if (!force && !ours) {
      throw sim::InputError(fmt::format("{}: holds files but no former run; choose another folder or give --force",
                                        target_.string()));
    }
  }
  const fs::path parent = target_.parent_path();
  fs::create_directories(parent, error);
  staging_ = parent / fmt::format(".{}.{}.tmp", target_.filename().string(), getpid());
  if (error || !fs::create_directory(staging_, error)) {
    throw sim::InputError(fmt::format("{}: cannot be written ({})", target_.string(), error.message()));
  }
}

RunFolder::~RunFolder() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
}

void RunFolder::commit() {
  std::error_code error;
  const fs::path former = staging_.string() + ".old";
  const bool replaces = fs::exists(target_, error);
  if (replaces) fs::rename(target_, former, error);
  if (!error) fs::rename(staging_, target_, error);
  if (error) throw sim::IoError(fmt::format("{}: cannot be written ({})", target_.string(), error.message()));
  if (replaces) fs::remove_all(former, error);
}

}  // namespace tools
