#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace tools {

/// How a verb's results are known from those of others.
struct ResultsOf {
  std::string_view mark = "report.json";  ///< a file that is always among them
  std::string_view name = {};             ///< the verb, if others write a file of that name
  bool pictures = true;                   ///< there may be some among them
};
/// Is this the name of a file that some verb leaves in its folder?
bool is_result_name(std::string_view name);

inline constexpr ResultsOf kResultsOfRun{.name = "run"};
inline constexpr ResultsOf kResultsOfReplay{.name = "trace replay", .pictures = false};

/// A folder of results, written beside its place and moved there as a whole: nobody sees half of one. Files that are
/// not results are never touched: where there are any, the results are put among them one by one.
class RunFolder {
 public:
  /// Checks that results may go to `target`: a new or empty folder, a former run of the same verb, or any folder with
  /// `force`; and that it can be written. InputError if not. An empty path becomes a dated folder below
  /// raywatt-out/. Nothing is made yet.
  RunFolder(std::filesystem::path target, bool force, const ResultsOf& verb = kResultsOfRun);

  /// Makes the folder beside the target when first asked for it.
  using Open = std::function<const std::filesystem::path&()>;

  /// Has `write` fill a folder beside the target, then puts it into place of the former results; interrupts wait from
  /// the moment the folder is made, and then say what `write` says has been kept. IoError, and nothing left behind, if
  /// that fails. To fill it again replaces all that it was filled with.
  void fill(const std::function<std::string(const Open& folder)>& write);

  /// There is a report of a former run, which this one would replace.
  bool holds_former_run() const;

  const std::filesystem::path& target() const { return target_; }

 private:
  const ResultsOf verb_;
  bool dated_;  ///< the target may take another name
  std::filesystem::path target_;
};

}  // namespace tools
