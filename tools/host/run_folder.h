#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace tools {

/// Properties by which the results of one verb are distinguished from those of other verbs.
struct VerbResults {
  std::string_view mark = "report.json";  ///< file that every run of the verb writes
  std::string_view name = {};             ///< name of the verb, if other verbs also write a file called `mark`
  bool pictures = true;                   ///< true if the verb's results may include pictures
};
/// True for the name of a file that a verb writes into its folder.
bool is_result_name(std::string_view name);

inline constexpr VerbResults kRunVerbResults{.name = "run"};
inline constexpr VerbResults kResultsOfReplay{.name = "trace replay", .pictures = false};

/// A folder of results that is replaced as a whole.
/// 1. Results are written into a temporary folder next to the target, which is then renamed or exchanged.
/// 2. If the target also contains other files, these stay and the results are moved among them one by one.
class RunFolder {
 public:
  /// Checks that results may be written to `target`: it is new, empty, a former run of the same verb, or `force` is
  /// given. Throws InputError otherwise. An empty path becomes a dated folder below raywatt-out/. Nothing is created
  /// yet.
  RunFolder(std::filesystem::path target, bool force, const VerbResults& verb = kRunVerbResults);

  /// Function that returns the path of the temporary folder and creates the folder at the first call.
  using Open = std::function<const std::filesystem::path&()>;

  /// Calls `write` to fill the temporary folder, then replaces the former results. Interrupts are delayed once the
  /// folder is created; their message then contains the text that `write` returned. Throws IoError if the results
  /// cannot be written; then none are left. A second call replaces the results of the first.
  void fill(const std::function<std::string(const Open& folder)>& write);

  /// True if the target folder contains a former run, which fill() would replace.
  bool has_earlier_run() const;

  const std::filesystem::path& target() const { return target_; }

 private:
  const VerbResults verb_;
  bool dated_;  ///< the folder's name is made from the date and may be changed if it already exists
  std::filesystem::path target_;
};

}  // namespace tools
