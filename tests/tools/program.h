#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/types.h>

#include "tests/temp_folder.h"

namespace test {

using Words = std::vector<std::string>;

/// Waits until `is_so` returns true. Returns false after two minutes.
bool wait_until(const std::function<bool()>& is_so);

/// Output and exit code of a process.
struct ProcessResult {
  int exit = -1;    ///< exit code; 128 + signal if one killed it
  std::string out;  ///< text on stdout
  std::string err;  ///< text on stderr
};

/// Environment in which the program is started.
struct ProcessEnvironment {
  std::filesystem::path folder{};                                ///< working directory; empty: the test's own
  std::vector<std::pair<std::string, std::string>> variables{};  ///< added to the environment
  std::uint64_t longest_file = 0;   ///< maximum size of a file in bytes (RLIMIT_FSIZE); 0: no limit
  std::string out{};                ///< file that receives stdout; empty: stdout is returned in ProcessResult::out
  std::string err{};                ///< text on stderr
  std::vector<int> closed{};        ///< descriptors of standard streams that are closed
  std::vector<int> unread{};        ///< descriptors that are pipes whose reading end is closed
  std::filesystem::path program{};  ///< path of the program; empty: the one that was built
};

/// A running process of the raywatt program.
class Program {
 public:
  explicit Program(Words arguments, const ProcessEnvironment& around = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void send(int signal) const;
  pid_t process() const { return process_; }
  /// Waits until the program has written to stderr. Returns false if the program ends before.
  bool wait_for_complaint() {
    return wait_until([](const std::string& err) { return !err.empty(); });
  }
  /// Waits until the text on stderr satisfies a condition. Returns false if the program ends before.
  bool wait_until(const std::function<bool(const std::string& err)>& is_as_wanted);
  /// Waits until a file called `name` (empty: any file) exists in the folder or a subfolder. Returns false if the
  /// program ends before.
  bool wait_for_file(const std::filesystem::path& folder, const std::string& name);
  bool ended();
  ProcessResult wait();

 private:
  TempFolder streams_;
  pid_t process_ = -1;
  int status_ = 0;
};

/// Runs the raywatt program until it ends.
ProcessResult raywatt(const Words& arguments, const ProcessEnvironment& around = {});
/// Runs the program until it ends. Expects exit code 0.
ProcessResult ending_well(const Words& arguments, const ProcessEnvironment& around = {});
/// Runs the program and returns its stdout. Expects exit code 0.
std::string output_of(const Words& arguments, const ProcessEnvironment& around = {});

/// Returns the arguments of a short run: 64 x 32 pixels on one thread, with results in `out`.
Words small_run(const std::filesystem::path& out, const Words& more = {});

/// Returns a file of `count` rays that go down into the Cornell box. A file with fewer rays is a prefix of one with
/// more.
std::string ray_list(std::size_t count);

nlohmann::json read_json(const std::filesystem::path& path);

/// Returns the parts of a report that are equal for equal inputs.
nlohmann::json repeatable(nlohmann::json report);

/// Returns the names of all files in a folder, sorted, including hidden ones.
Words names_in(const std::filesystem::path& folder);

/// Expects that the program ended with code 2, one line on stderr that contains all `parts`, and no output on stdout.
void expect_refusal(const ProcessResult& ending, const Words& parts);

/// Expects that a short run with the arguments `more` is refused (expect_refusal()) and creates no folder.
void expect_refused_run(const Words& more, const Words& parts);

}  // namespace test
