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

/// Waits until `is_so`; false if that takes more than two minutes.
bool wait_until(const std::function<bool()>& is_so);

/// Output and exit code of a process.
struct Ending {
  int exit = -1;    ///< exit code; 128 + signal if one killed it
  std::string out;  ///< on stdout
  std::string err;  ///< on stderr
};

/// Where and how the program is started.
struct Surroundings {
  std::filesystem::path folder{};                                ///< working directory; empty: the test's own
  std::vector<std::pair<std::string, std::string>> variables{};  ///< added to the environment
  std::uint64_t longest_file = 0;   ///< bytes after which writing a file fails; 0: no limit
  std::string out{};                ///< file that stdout goes to; empty: into Ending::out
  std::string err{};                ///< text on stderr
  std::vector<int> closed{};        ///< standard streams that are closed, by descriptor
  std::vector<int> unread{};        ///< descriptors that are pipes whose reading end is closed
  std::filesystem::path program{};  ///< empty: the one that was built
};

/// The real raywatt program, running.
class Program {
 public:
  explicit Program(Words arguments, const Surroundings& around = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void send(int signal) const;
  pid_t process() const { return process_; }
  /// Waits until there is something on stderr; false if it ended before.
  bool wait_for_complaint() {
    return wait_until([](const std::string& err) { return !err.empty(); });
  }
  /// Waits until what is on stderr is as wanted; false if it ended before.
  bool wait_until(const std::function<bool(const std::string& err)>& is_as_wanted);
  /// Waits until a file of this name (empty: any) is in the folder, or in one inside; false if the program ended
  /// before.
  bool wait_for_file(const std::filesystem::path& folder, const std::string& name);
  bool ended();
  Ending wait();

 private:
  TempFolder streams_;
  pid_t process_ = -1;
  int status_ = 0;
};

/// Runs the program to its end.
Ending raywatt(const Words& arguments, const Surroundings& around = {});
/// Runs the program and returns its stdout. Expects exit code 0.
std::string output_of(const Words& arguments, const Surroundings& around = {});

/// A run that is over in a moment: 64 x 32 pixels on one thread, results to `out`.
Words small_run(const std::filesystem::path& out, const Words& more = {});

/// A file of `count` rays, down into the box of the scene cornell; a shorter file is the begin of a longer one.
std::string ray_list(std::size_t count);

nlohmann::json read_json(const std::filesystem::path& path);

/// Names in a folder, hidden ones too, sorted.
Words names_in(const std::filesystem::path& folder);

/// Ended with 2, said why in one line on stderr that holds every one of `parts`, said nothing on stdout.
void expect_refusal(const Ending& ending, const Words& parts);

/// A small run with `more` is refused so, and no folder is made for it.
void expect_refused_run(const Words& more, const Words& parts);

}  // namespace test
