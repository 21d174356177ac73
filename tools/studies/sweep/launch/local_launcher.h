#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include <sys/types.h>

#include "tools/studies/sweep/launch/launcher.h"

namespace tools::sweep {

/// Worker processes on this host, which live as long as the launcher and take one point after the other. The process
/// that makes one should have one thread. A worker that crashes takes only its point with it.
class LocalLauncher final : public Launcher {
 public:
  struct Options {
    std::uint32_t jobs = 0;     ///< workers; 0: one for each core of the host
    std::uint32_t threads = 0;  ///< threads of each; 0: the host's cores, shared out
    bool retry_failed = false;
    bool keep_streams = false;    ///< recorded streams stay for other launchers when the last point here has used them
    std::filesystem::path log{};  ///< folder for what workers say; empty: nowhere
  };
  LocalLauncher(const Store& store, const Options& options);
  ~LocalLauncher() override;

 private:
  BatchEnd play(std::span<const Point> points, const Watch& watch) override;

  struct Worker {
    pid_t process = -1;
    int socket = -1;
    std::filesystem::path log;
    std::uint64_t log_begin = 0;       ///< where in it the point under way begins
    std::optional<std::size_t> point;  ///< under way
    std::string id;                    ///< its id
  };
  class Batch;

  void start(Worker& worker);
  /// Waits for its end; the status as of waitpid().
  int reap(Worker& worker);
  void stop();
  /// It may have been ended by a second interrupt: Ctrl-C and Slurm send theirs to every process.
  void tidy_up_after(const Worker& worker);
  [[noreturn]] void work(int socket, const std::filesystem::path& log);

  const Options options_;
  std::vector<Worker> workers_;
};

}  // namespace tools::sweep
