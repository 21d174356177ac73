#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace tools {

/// Distinguishes the results of a verb from those of other verbs.
struct ResultsOf {
  std::string_view mark = "report.json";  ///< file that every run of the verb writes
  std::string_view name = {};             ///< the verb, if other verbs write a file of that name
  bool pictures = true;                   ///< results may include pictures
};
/// True for the name of a file that a verb writes into its folder.
bool is_result_name(std::string_view name);

inline constexpr ResultsOf kResultsOfRun{.name = "run"};
inline constexpr ResultsOf kResultsOfReplay{.name = "trace replay", .pictures = false};

/// A folder of results that is replaced as a whole.
/// 1. Results are written into a temporary folder next to the target, which is then renamed or exchanged.
/// 2. If the target also contains other files, these stay and the results are moved among them one by one.
class RunFolder {
 public:
  /// Checks that results may be written to `target`: it is new, empty, a former run of the same verb, or `force` is
  /// given. InputError otherwise. An empty path becomes a dated folder below raywatt-out/. Nothing is created yet.
  RunFolder(std::filesystem::path target, bool force, const ResultsOf& verb = kResultsOfRun);

  /// Creates the temporary folder at the first call and returns its path.
  using Open = std::function<const std::filesystem::path&()>;

  /// Calls `write` to fill the temporary folder, then replaces the former results. Interrupts are held from the moment
  /// the folder is created; the message then names what `write` returned as kept. IoError if that
  /// fails; then nothing is left. A second call replaces the results of the first.
  void fill(const std::function<std::string(const Open& folder)>& write);

  /// True if a former run would be replaced.
  bool holds_former_run() const;

  const std::filesystem::path& target() const { return target_; }

 private:
  const ResultsOf verb_;
  bool dated_;  ///< the name may be changed if it is taken
  std::filesystem::path target_;
};

}  // namespace tools
