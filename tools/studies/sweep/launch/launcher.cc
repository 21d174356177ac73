#include "tools/studies/sweep/launch/launcher.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <map>
#include <new>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/studies/sweep/launch/slurm.h"

namespace tools::sweep {
namespace {

/// Adds the duration and the worker utilisation of a later batch to those of `end`.
void add_times(const BatchResult& later, BatchResult& end) {
  const double seconds = end.seconds + later.seconds;
  if (seconds > 0) end.busy = (end.busy * end.seconds + later.busy * later.seconds) / seconds;
  end.seconds = seconds;
  end.workers = std::max(end.workers, later.workers);
  end.interrupted = end.interrupted || later.interrupted;
}

/// Time of a pilot as a share of that of its frame. Chosen: a pilot traces one of 16 samples of a tile. Chess at
/// 512x384 with full:4, tiles of 8 and 2 % of them takes 1.0 s per point, and with a record 5.8 s for four points.
constexpr double kPilotShare = 1.0 / 16;

}  // namespace

bool is_record_quicker(std::size_t points, double share) {
  return static_cast<double>(points) * (share + kPilotShare) > 1 + kPilotShare;
}

std::uint64_t BatchResult::count_of(PointStatus status) const {
  return static_cast<std::uint64_t>(std::ranges::count(statuses, status));
}

void Launcher::remove_failure(const Point& point) const {
  if (const std::optional<sim::FileLock> lock = store_.lock_point(point.id)) store_.remove_failure(point.id);
}

/// A batch with points that are cut: first their slices and all other points are simulated, then slices are joined.
class Launcher::CutBatch {
 public:
  CutBatch(Launcher& launcher, std::span<const Point> points) : launcher_(launcher), points_(points) {
    cut_.resize(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      const std::vector<Point> slices = launcher.needs_computing(launcher.store_.status_of(points[p].id))
                                            ? slices_of(points[p])
                                            : std::vector<Point>();
      if (slices.empty()) add_job(points[p], p);
      for (const Point& slice : slices) add_job(slice, p);
      if (!slices.empty() && launcher.retry_failed_) launcher.remove_failure(points[p]);
      cut_[p].is_cut = !slices.empty();
    }
  }

  BatchResult run(const PointWatch& watch, const SliceWatch& slice_watch) {
    BatchResult end = launcher_.run_batch(jobs_, [&](std::size_t j, PointStatus status) {
      jobs_[j].slice != 0 ? slice_watch(point_of_[j]) : watch(point_of_[j], status);
    });
    std::vector<PointStatus> statuses(points_.size(), PointStatus::kMissing);
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      Cut& cut = cut_[point_of_[j]];
      if (!cut.is_cut) statuses[point_of_[j]] = end.statuses[j];
      cut.is_new = cut.is_new || end.statuses[j] == PointStatus::kComputed;
      cut.lacks_some = cut.lacks_some || end.statuses[j] == PointStatus::kMissing;
    }
    end.statuses = std::move(statuses);
    join_slices(end, watch);
    return end;
  }

 private:
  struct Cut {
    bool is_cut = false;
    bool is_new = false;      ///< a slice was computed
    bool lacks_some = false;  ///< a slice was not computed
  };

  void add_job(const Point& job, std::size_t point) {
    jobs_.push_back(job);
    point_of_.push_back(point);
  }

  /// Joins slices that are still unjoined because the worker of the last slice ended too early.
  void join_slices(BatchResult& end, const PointWatch& watch) {
    std::vector<Point> wholes;
    std::vector<std::size_t> indices;
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (!cut_[p].is_cut || cut_[p].lacks_some ||
          (end.interrupted && launcher_.needs_computing(launcher_.store_.status_of(points_[p].id))))
        continue;
      wholes.push_back(points_[p]);
      indices.push_back(p);
    }
    const BatchResult joined = launcher_.run_batch(wholes, [&](std::size_t w, PointStatus status) {
      const bool is_new = status == PointStatus::kDone && cut_[indices[w]].is_new;
      end.statuses[indices[w]] = is_new ? PointStatus::kComputed : status;
      watch(indices[w], end.statuses[indices[w]]);
    });
    add_times(joined, end);
  }

  Launcher& launcher_;
  const std::span<const Point> points_;
  std::vector<Cut> cut_;  ///< by point
  std::vector<Point> jobs_;
  std::vector<std::size_t> point_of_;  ///< index of the point of each job
};

BatchResult Launcher::run(std::span<const Point> points, const PointWatch& watch, const SliceWatch& slice_watch) {
  if (std::ranges::none_of(points, &Point::is_cut)) return run_batch(points, watch);
  return CutBatch(*this, points).run(watch, slice_watch);
}

namespace {

using sim::Json;

constexpr double kEndTimeout = 10;      // seconds to wait for workers to end
constexpr int kPollPeriod = 200;        // ms between two checks for an interrupt
constexpr int kAttempts = 2;            // attempts to compute a point whose worker was killed
constexpr std::size_t kLogTail = 2000;  // bytes of the output of a worker that are kept

[[noreturn]] void throw_errno(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

void send_message(int socket, const Json& message) {
  const std::string text = sim::json_line(message);
  if (::send(socket, text.data(), text.size(), MSG_NOSIGNAL) < 0 && errno != EPIPE && errno != ECONNRESET) {
    throw_errno("a message to a worker cannot be sent");
  }
}

/// Receives the next message from a socket; returns nothing if the other process has closed it.
std::optional<Json> receive_message(int socket) {
  for (;;) {
    char first = 0;
    const ssize_t size = ::recv(socket, &first, 1, MSG_PEEK | MSG_TRUNC);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return std::nullopt;
    std::string text(static_cast<std::size_t>(size), '\0');
    if (::recv(socket, text.data(), text.size(), 0) != size) return std::nullopt;
    return sim::parse_json(text);
  }
}

/// Size of a file; 0 if there is none.
std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code missing;
  const std::uint64_t size = std::filesystem::file_size(file, missing);
  return missing ? 0 : size;
}

/// Returns the last lines of a worker's log after offset `begin`, with unsafe characters replaced.
std::string read_log_tail(const std::filesystem::path& file, std::uint64_t begin) {
  const std::uint64_t size = size_of(file);
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(std::max(begin, size - std::min<std::uint64_t>(size, kLogTail))));
  std::string tail;
  for (std::string line; std::getline(stream, line);) tail += sim::printable(line, kLogTail) + "\n";
  return tail;
}

/// Launcher that computes points in worker processes on this host, which are connected by sockets.
class LocalLauncher final : public Launcher {
 public:
  LocalLauncher(const Store& store, const LocalOptions& options)
      : Launcher(store, options.retry_failed), options_([&] {
          LocalOptions o = options;
          const std::uint32_t cores = host_threads(0);
          if (o.jobs == 0) o.jobs = cores;
          if (o.threads == 0) o.threads = std::max(1U, cores / o.jobs);
          return o;
        }()) {
    workers_.resize(options_.jobs);
    for (std::size_t w = 0; w < workers_.size(); ++w) {
      if (!options_.log.empty()) workers_[w].log = options_.log / fmt::format("worker-{}-{}.log", ::getpid(), w);
    }
  }
  ~LocalLauncher() override { stop_workers(); }

 private:
  BatchResult run_batch(std::span<const Point> points, const PointWatch& watch) override {
    if (!options_.log.empty()) sim::make_folders(options_.log);
    Batch batch(*this, points, watch);
    try {
      return batch.run();
    } catch (...) {
      stop_workers();
      throw;
    }
  }

  struct Worker {
    pid_t process = -1;
    int socket = -1;
    std::filesystem::path log;
    std::uint64_t log_begin = 0;       ///< size of the log when the current point was begun
    std::optional<std::size_t> point;  ///< current point
    std::string id;                    ///< id of the current point
  };
  /// The state of one call of run_batch().
  class Batch {
   public:
    Batch(LocalLauncher& launcher, std::span<const Point> points, const PointWatch& watch)
        : launcher_(launcher), points_(points), watch_(watch) {
      end_.statuses.assign(points.size(), PointStatus::kMissing);
      std::map<std::string_view, std::size_t> first;
      for (std::size_t p = 0; p < points.size(); ++p) {
        const auto [same, is_new] = first.emplace(points[p].id, p);
        if (is_new) {
          find_in_store(p);
        } else {
          twins_.emplace(same->second, p);
        }
      }
      for (const auto& [p, twin] : twins_) {
        if (end_.statuses[p] != PointStatus::kMissing) finish_point(twin, end_.statuses[p]);
      }
      remove_unused_streams();
    }

    BatchResult run() {
      if (waiting_.empty()) return std::move(end_);
      const sim::HostClock::time_point begin = sim::HostClock::now();
      end_.workers = static_cast<std::uint32_t>(std::min(launcher_.workers_.size(), waiting_.size()));
      begun_.resize(end_.workers);
      while (left_ != 0) {
        if (is_interrupted()) {
          launcher_.stop_workers();
          end_.interrupted = true;
          break;
        }
        for (std::size_t w = 0; w < end_.workers; ++w) assign_next_point(w);
        poll_workers();
      }
      end_.seconds = sim::seconds_since(begin);
      end_.busy = busy_ / (end_.seconds * end_.workers);
      return std::move(end_);
    }

   private:
    struct Waiting {
      std::size_t point;
      int attempt = 1;
      bool locked = false;  ///< another process was computing it at the last attempt
    };
    /// Points of a batch that replay the same recorded rays (stream).
    struct Group {
      enum class State : std::uint8_t { kUnrecorded, kRecording, kReady, kImpossible } state = State::kUnrecorded;
      std::size_t left = 0;                 ///< points that have not ended
      std::optional<std::size_t> recorder;  ///< index of the point that records the stream
    };

    /// Finishes point `p` if the store has its result; otherwise queues it for a worker.
    void find_in_store(std::size_t p) {
      const PointStatus status = launcher_.store_.status_of(points_[p].id);
      if (!launcher_.needs_computing(status)) return finish_point(p, status);
      waiting_.push_back({p});
      left_ += 1;
      if (!points_[p].stream.empty()) groups_[points_[p].stream].left += 1;
    }

    Group* group_of(std::size_t p) { return points_[p].stream.empty() ? nullptr : &groups_.at(points_[p].stream); }

    /// True if a queued point can start: no other process computes it, and no other point is recording its stream.
    bool is_ready(const Waiting& waiting) {
      const Group* group = group_of(waiting.point);
      return !waiting.locked && (group == nullptr || group->state != Group::State::kRecording);
    }

    /// True if `count` points that replay the same rays take less time with a record of these.
    bool is_worth_recording(const Point& point, std::size_t count) {
      if (point.tile_sampling.empty()) return count >= 2;
      try {
        const TileSampling sampling = parse_tile_sampling(point.tile_sampling, "none");
        const kernels::ProgramSpec program = kernels::parse_program(point.program);
        return is_record_quicker(count, simulated_share(keys_.config_of(point), program, sampling));
      } catch (const sim::InputError&) {  // its worker reports what is wrong with the point
        return false;
      }
    }

    /// If the point must record its rays (its stream) for others, marks the stream as being recorded and returns true.
    bool begin_recording(std::size_t p) {
      Group* group = group_of(p);
      if (group == nullptr || group->state != Group::State::kUnrecorded) return false;
      std::error_code failed;
      const bool is_there = std::filesystem::exists(launcher_.store_.stream_file(points_[p].stream), failed);
      if (is_there) group->state = Group::State::kReady;
      if (is_there || !is_worth_recording(points_[p], group->left)) return false;
      group->state = Group::State::kRecording;
      group->recorder = p;
      return true;
    }

    void end_recording(std::size_t p) {
      Group* group = group_of(p);
      if (group == nullptr || group->recorder != p) return;
      std::error_code failed;
      const bool is_there = std::filesystem::exists(launcher_.store_.stream_file(points_[p].stream), failed);
      group->state = is_there ? Group::State::kReady : Group::State::kImpossible;
      group->recorder.reset();
    }

    void leave_group(std::size_t p) {
      Group* group = group_of(p);
      if (group == nullptr || --group->left != 0 || launcher_.options_.keep_streams) return;
      launcher_.store_.remove_stream(points_[p].stream);
    }

    /// Removes streams (recorded rays) that a killed run has left and that no point needs.
    void remove_unused_streams() {
      if (launcher_.options_.keep_streams) return;
      for (const Point& point : points_) {
        if (!point.stream.empty() && !groups_.contains(point.stream)) launcher_.store_.remove_stream(point.stream);
      }
    }

    void finish_point(std::size_t p, PointStatus status) {
      end_.statuses[p] = status;
      watch_(p, status);
    }

    /// Finishes point `p` and all points with the same id.
    void finish_twins(std::size_t p, PointStatus status) {
      finish_point(p, status);
      const auto [begin, end] = twins_.equal_range(p);
      for (auto twin = begin; twin != end; ++twin)
        finish_point(twin->second, status == PointStatus::kComputed ? PointStatus::kDone : status);
      left_ -= 1;
      leave_group(p);
    }

    /// Gives an idle worker the next point.
    void assign_next_point(std::size_t w) {
      Worker& worker = launcher_.workers_[w];
      if (worker.point || waiting_.empty()) return;
      auto next = std::ranges::find_if(waiting_, [&](const Waiting& waiting) { return is_ready(waiting); });
      if (next == waiting_.end()) next = std::ranges::find(waiting_, false, &Waiting::locked);
      if (next == waiting_.end()) next = waiting_.begin();
      const Waiting order = *next;
      waiting_.erase(next);
      if (worker.process < 0) launcher_.start_worker(worker);
      worker.point = order.point;
      worker.id = points_[order.point].id;
      worker.log_begin = size_of(worker.log);
      attempts_[order.point] = order.attempt;
      begun_[w] = sim::HostClock::now();
      send_message(worker.socket, {{"point", format_point_line(points_[order.point])},
                                   {"record", begin_recording(order.point)},
                                   {"wait", order.locked},
                                   {"attempt", order.attempt}});
    }

    /// Waits up to kPollPeriod for messages from workers and handles them.
    void poll_workers() {
      std::vector<pollfd> sockets;
      std::vector<std::size_t> polled;
      for (std::size_t w = 0; w < end_.workers; ++w) {
        if (!launcher_.workers_[w].point) continue;
        sockets.push_back({launcher_.workers_[w].socket, POLLIN, 0});
        polled.push_back(w);
      }
      if (::poll(sockets.data(), sockets.size(), kPollPeriod) <= 0) return;
      for (std::size_t s = 0; s < sockets.size(); ++s) {
        if (sockets[s].revents == 0) continue;
        Worker& worker = launcher_.workers_[polled[s]];
        const std::size_t p = *worker.point;
        busy_ += sim::seconds_since(begun_[polled[s]]);
        const std::optional<Json> answer = receive_message(worker.socket);
        worker.point.reset();
        end_recording(p);
        if (!answer) {
          handle_crash(worker, p);
        } else if (answer->contains("io_error")) {
          throw sim::IoError(answer->at("io_error").get<std::string>());
        } else if (const auto status = static_cast<PointStatus>(answer->at("status").get<int>());
                   status == PointStatus::kLocked) {
          waiting_.push_back({p, attempts_[p], true});
        } else {
          finish_twins(p, status);
        }
      }
    }

    void handle_crash(Worker& worker, std::size_t p) {
      const int wait_status = launcher_.reap_worker(worker);
      if (is_interrupted()) return;
      const int signal = WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0;
      const int exit = signal != 0 ? 128 + signal : WEXITSTATUS(wait_status);
      const bool was_killed = exit == 128 + SIGKILL || exit == 128 + SIGTERM;
      if (was_killed && attempts_[p] < kAttempts) {
        waiting_.push_back({p, attempts_[p] + 1, false});
        return;
      }
      if (exit == kGood || exit == kIoFailed)
        throw sim::IoError(fmt::format("a worker ended before it sent the result of {}", points_[p].id));
      const std::string error = signal != 0 ? fmt::format("the worker crashed: {}", ::strsignal(signal))
                                            : fmt::format("the worker ended with {}", exit);
      if (const std::optional<sim::FileLock> lock = launcher_.store_.lock_point(points_[p].id)) {
        launcher_.store_.put_failure(
            {points_[p].id, exit, error, read_log_tail(worker.log, worker.log_begin), host_name(), attempts_[p]});
      }
      finish_twins(p, PointStatus::kFailed);
    }

    LocalLauncher& launcher_;
    const std::span<const Point> points_;
    const PointWatch& watch_;
    std::vector<Waiting> waiting_;
    /// For the first point with an id: all later points with the same id.
    std::multimap<std::size_t, std::size_t> twins_;
    std::map<std::size_t, int> attempts_;
    PointKeys keys_;
    std::map<std::string, Group> groups_;            ///< groups of points by key of their stream
    std::vector<sim::HostClock::time_point> begun_;  ///< time at which each worker began its point
    std::size_t left_ = 0;
    double busy_ = 0;  ///< s
    BatchResult end_;
  };

  void start_worker(Worker& worker) {
    std::array<int, 2> sockets{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0)
      throw_errno("no worker can be started");
    const pid_t parent = ::getpid();
    worker.process = ::fork();
    if (worker.process < 0) {
      worker.process = -1;
      ::close(sockets[0]);
      ::close(sockets[1]);
      throw_errno("no worker can be started");
    }
    if (worker.process == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGTERM);
      if (::getppid() != parent) ::_exit(128 + SIGTERM);
      run_worker(sockets[1], worker.log);
    }
    ::close(sockets[1]);
    worker.socket = sockets[0];
  }
  /// Waits until the worker process has ended; returns its status as waitpid() does.
  int reap_worker(Worker& worker) {
    int status = 0;
    ::close(worker.socket);
    while (::waitpid(worker.process, &status, 0) < 0 && errno == EINTR) {
    }
    worker.process = worker.socket = -1;
    return status;
  }
  void stop_workers() {
    for (const Worker& worker : workers_) {
      if (worker.process > 0) ::kill(worker.process, SIGTERM);
    }
    const sim::HostClock::time_point begin = sim::HostClock::now();
    for (Worker& worker : workers_) {
      if (worker.process <= 0) continue;
      ::shutdown(worker.socket, SHUT_WR);
      pollfd end{worker.socket, POLLIN, 0};
      const double left = std::max(0.0, kEndTimeout - sim::seconds_since(begin));
      while (::poll(&end, 1, static_cast<int>(left * 1000)) > 0 && receive_message(worker.socket)) {
      }
      if ((end.revents & POLLHUP) == 0) ::kill(worker.process, SIGKILL);
      reap_worker(worker);
      if (worker.point) clean_up_after(worker);
      worker.point.reset();
    }
    for (const Worker& worker : workers_) {
      std::error_code ignored;
      if (!worker.log.empty() && size_of(worker.log) == 0) std::filesystem::remove(worker.log, ignored);
    }
  }
  /// Removes the unfinished result folder of a worker that a second interrupt may have killed.
  void clean_up_after(const Worker& worker) {
    try {
      store_.lock_point(worker.id);  // cleans up, then releases the lock
    } catch (const sim::IoError&) {
    } catch (const std::system_error&) {
    }
  }
  [[noreturn]] void run_worker(int socket, const std::filesystem::path& log) {
    if (socket > 3)
      ::close_range(3, static_cast<unsigned>(socket - 1), 0);  // sockets of other workers, locks of the parent
    ::close_range(static_cast<unsigned>(socket) + 1, ~0U, 0);
    const int out = ::open(log.empty() ? "/dev/null" : log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (out >= 0) {
      ::dup2(out, STDOUT_FILENO);
      ::dup2(out, STDERR_FILENO);
    }
    const HoldInterrupts hold;  // an unfinished folder is removed before the process ends
    int exit = kGood;
    try {
      PointComputer computer(store_, options_.threads);
      while (const std::optional<Json> order = receive_message(socket)) {
        const Point point = parse_point_line(order->at("point").get<std::string>(), "worker");
        Json answer;
        try {
          const PointStatus status =
              computer.compute_point(point, {order->at("record").get<bool>(), order->at("wait").get<bool>(),
                                             retry_failed_, order->at("attempt").get<int>()});
          answer = {{"status", static_cast<int>(status)}};
        } catch (const sim::IoError& error) {
          answer = {{"io_error", sim::printable(error.what(), kLogTail)}};
        } catch (const std::system_error& error) {
          answer = {{"io_error", sim::printable(error.what(), kLogTail)}};
        }
        send_message(socket, answer);
      }
    } catch (const Interrupted&) {
      exit = 128 + SIGTERM;
    } catch (const std::bad_alloc&) {
      exit = kIoFailed;
    } catch (const std::exception& error) {
      print_message("internal error: {}", error.what());
      std::fflush(stderr);
      exit = kOurBug;
    }
    ::_exit(exit);
  }

  const LocalOptions options_;
  std::vector<Worker> workers_;
};

}  // namespace

std::unique_ptr<Launcher> make_local_launcher(const Store& store, const LocalOptions& options) {
  return std::make_unique<LocalLauncher>(store, options);
}

}  // namespace tools::sweep

namespace tools {

void check_options(const LauncherOptions& options) {
  const bool has_slurm_options = !options.slurm_arguments.empty() || options.chunk != 0;
  if (options.launcher != "slurm" && has_slurm_options) {
    throw sim::InputError("--slurm-args and --chunk are for --launcher slurm");
  }
}

std::unique_ptr<sweep::Launcher> make_launcher(const LauncherOptions& options, const sweep::SweepFolder& folder) {
  if (options.launcher == "slurm") {
    // options in the sweep's file precede those of the command line
    std::vector<std::string> arguments = folder.slurm_arguments();
    for (const std::string& several : options.slurm_arguments) {
      std::istringstream words(several);
      for (std::string word; words >> word;) arguments.push_back(word);
    }
    return std::make_unique<sweep::SlurmLauncher>(folder,
                                                  sweep::SlurmLauncher::Options{.chunk = options.chunk,
                                                                                .tasks = options.jobs,
                                                                                .retry_failed = options.retry_failed,
                                                                                .arguments = std::move(arguments)});
  }
  return sweep::make_local_launcher(folder.store(), {.jobs = options.jobs,
                                                     .retry_failed = options.retry_failed,
                                                     .keep_streams = options.keep_streams,
                                                     .log = folder.log_folder()});
}

}  // namespace tools
