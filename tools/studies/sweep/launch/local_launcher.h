#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include <sys/types.h>

#include "tools/studies/sweep/launch/launcher.h"

namespace tools::sweep {

/// Worker processes on this host, which live as long as the launcher and compute one point after the other. A worker
/// that crashes fails only its point. The process that creates a launcher should have one thread, because it forks.
class LocalLauncher final : public Launcher {
 public:
  struct Options {
    std::uint32_t jobs = 0;     ///< workers; 0: one for each core of the host
    std::uint32_t threads = 0;  ///< threads of each worker; 0: the cores of the host, shared out
    bool retry_failed = false;
    bool keep_streams = false;    ///< keep recorded streams for other launchers after the last point has used them
    std::filesystem::path log{};  ///< folder for the output of workers; empty: it is discarded
  };
  LocalLauncher(const Store& store, const Options& options);
  ~LocalLauncher() override;

 private:
  BatchEnd run_batch(std::span<const Point> points, const PointWatch& watch) override;

  struct Worker {
    pid_t process = -1;
    int socket = -1;
    std::filesystem::path log;
    std::uint64_t log_begin = 0;       ///< size of the log when the current point was begun
    std::optional<std::size_t> point;  ///< current point
    std::string id;                    ///< id of the current point
  };
  class Batch;

  void start_worker(Worker& worker);
  /// Waits until the process has ended; returns its status as waitpid() does.
  int reap_worker(Worker& worker);
  void stop_workers();
  /// Removes the unfinished folder of a worker, which a second interrupt may have ended.
  void clean_up_after(const Worker& worker);
  [[noreturn]] void run_worker(int socket, const std::filesystem::path& log);

  const Options options_;
  std::vector<Worker> workers_;
};

}  // namespace tools::sweep
