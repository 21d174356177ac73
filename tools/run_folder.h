#pragma once
#include <filesystem>
#include <string_view>

namespace tools {

/// A folder of results, written beside its place and moved there as a whole: nobody sees half of one.
class RunFolder {
 public:
  /// Checks that results may go to `target`: a new or empty folder, or a former run (it holds `mark`), or anything
  /// with `force`; and that it can be written. InputError if not. An empty path becomes a dated folder below raywatt-out/.
  RunFolder(std::filesystem::path target, bool force, std::string_view mark = "report.json");
  /// Removes what was not committed.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Where to write meanwhile.
  const std::filesystem::path& staging() const { return staging_; }
  const std::filesystem::path& target() const { return target_; }
  /// Swaps the results into place.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path staging_;
};

}  // namespace tools
