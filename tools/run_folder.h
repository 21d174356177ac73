#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace tools {

/// A folder of results, written beside its place and moved there as a whole: nobody sees half of one. Files that are
/// not results are never touched: where there are any, the results are put among them one by one.
class RunFolder {
 public:
  /// Checks that results may go to `target`: a new or empty folder, a former run (it holds our `mark`), or any folder
  /// with `force`; and that it can be written. InputError if not. An empty path becomes a dated folder below
  /// raywatt-out/. Nothing is made yet.
  RunFolder(std::filesystem::path target, bool force, std::string_view mark = "report.json");

  /// Makes the folder beside the target when first asked for it.
  using Open = std::function<const std::filesystem::path&()>;

  /// Has `write` fill a folder beside the target, then puts it into place of the former results; interrupts wait from
  /// the moment the folder is made, and then say what `write` says has been kept. IoError, and nothing left behind, if
  /// that fails.
  void fill(const std::function<std::string(const Open& folder)>& write);

  /// There are results of a former run, which these would replace.
  bool holds_former_run() const;

  const std::filesystem::path& target() const { return target_; }

 private:
  const std::string mark_;
  const bool dated_;
  std::filesystem::path target_;
};

}  // namespace tools
