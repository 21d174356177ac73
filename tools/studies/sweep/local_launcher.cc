#include "tools/studies/sweep/local_launcher.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "tools/host/exit_code.h"
#include "tools/host/interrupt.h"
#include "tools/studies/sweep/durable.h"

namespace tools::sweep {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kGlance = 200;            // ms: how late an interrupt may be seen
constexpr double kPatience = 10;        // s: for workers that shall end
constexpr std::size_t kLogTail = 2000;  // bytes
constexpr int kAttempts = 2;            // for a point whose worker somebody has killed

[[noreturn]] void give_up(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

void send_message(int socket, const Json& message) {
  const std::string text = message.dump();
  if (::send(socket, text.data(), text.size(), MSG_NOSIGNAL) < 0 && errno != EPIPE && errno != ECONNRESET) {
    give_up("a worker cannot be told what to do");
  }
}

/// Nothing if the other side is gone.
std::optional<Json> receive_message(int socket) {
  for (;;) {
    char first = 0;
    const ssize_t size = ::recv(socket, &first, 1, MSG_PEEK | MSG_TRUNC);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return std::nullopt;
    std::string text(static_cast<std::size_t>(size), '\0');
    if (::recv(socket, text.data(), text.size(), 0) != size) return std::nullopt;
    return Json::parse(text);
  }
}

std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code missing;
  const std::uint64_t size = std::filesystem::file_size(file, missing);
  return missing ? 0 : size;
}

/// The last lines behind `begin`, fit for JSON.
std::string log_tail(const std::filesystem::path& file, std::uint64_t begin) {
  const std::uint64_t size = size_of(file);
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(std::max(begin, size - std::min<std::uint64_t>(size, kLogTail))));
  std::string tail;
  for (std::string line; std::getline(stream, line);) tail += sim::printable(line, kLogTail) + "\n";
  return tail;
}

}  // namespace

std::uint64_t BatchEnd::count(Fate fate) const { return static_cast<std::uint64_t>(std::ranges::count(fates, fate)); }

LocalLauncher::LocalLauncher(const Store& store, const Options& options)
    : store_(store), options_([&] {
        Options o = options;
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

LocalLauncher::~LocalLauncher() { stop(); }

void LocalLauncher::start(Worker& worker) {
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0) give_up("no worker can be started");
  const pid_t parent = ::getpid();
  worker.process = ::fork();
  if (worker.process < 0) {
    worker.process = -1;
    ::close(sockets[0]);
    ::close(sockets[1]);
    give_up("no worker can be started");
  }
  if (worker.process == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(128 + SIGTERM);
    work(sockets[1], worker.log);
  }
  ::close(sockets[1]);
  worker.socket = sockets[0];
}

int LocalLauncher::reap(Worker& worker) {
  int status = 0;
  ::close(worker.socket);
  while (::waitpid(worker.process, &status, 0) < 0 && errno == EINTR) {
  }
  worker.process = worker.socket = -1;
  return status;
}

void LocalLauncher::stop() {
  for (const Worker& worker : workers_) {
    if (worker.process > 0) ::kill(worker.process, SIGTERM);
  }
  const sim::HostClock::time_point begin = sim::HostClock::now();
  for (Worker& worker : workers_) {
    if (worker.process <= 0) continue;
    ::shutdown(worker.socket, SHUT_WR);
    pollfd end{worker.socket, POLLIN, 0};
    const double left = std::max(0.0, kPatience - sim::seconds_since(begin));
    while (::poll(&end, 1, static_cast<int>(left * 1000)) > 0 && receive_message(worker.socket)) {
    }
    if ((end.revents & POLLHUP) == 0) ::kill(worker.process, SIGKILL);
    reap(worker);
    if (worker.point) tidy_up_after(worker);
    worker.point.reset();
  }
  for (const Worker& worker : workers_) {
    std::error_code ignored;
    if (!worker.log.empty() && size_of(worker.log) == 0) std::filesystem::remove(worker.log, ignored);
  }
}

void LocalLauncher::tidy_up_after(const Worker& worker) {
  try {
    store_.lock(worker.id);  // and let go again: what is half done is removed
  } catch (const sim::IoError&) {
  } catch (const std::system_error&) {
  }
}

void LocalLauncher::work(int socket, const std::filesystem::path& log) {
  if (socket > 3) ::close_range(3, static_cast<unsigned>(socket - 1), 0);  // other workers' sockets, the parent's locks
  ::close_range(static_cast<unsigned>(socket) + 1, ~0U, 0);
  const int out = ::open(log.empty() ? "/dev/null" : log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (out >= 0) {
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
  }
  const HoldInterrupts hold;  // who has a folder half made removes it first
  int exit = kGood;
  try {
    PointComputer computer(store_, options_.threads);
    while (const std::optional<Json> order = receive_message(socket)) {
      const Point point = read_line(order->at("point").get<std::string>(), "worker");
      Json answer;
      try {
        const Fate fate = computer.compute(point, {order->at("record").get<bool>(), order->at("wait").get<bool>(),
                                                   options_.retry_failed, order->at("attempt").get<int>()});
        answer = {{"fate", static_cast<int>(fate)}};
      } catch (const sim::IoError& error) {
        answer = {{"io_error", sim::printable(error.what(), kLogTail)}};
      } catch (const std::system_error& error) {
        answer = {{"io_error", sim::printable(error.what(), kLogTail)}};
      }
      send_message(socket, answer);
    }
  } catch (const Interrupted&) {
    exit = 128 + SIGTERM;
  } catch (const std::exception& error) {
    fmt::print(stderr, "raywatt: internal error: {}\n", error.what());
    std::fflush(stderr);
    exit = kOurBug;
  }
  ::_exit(exit);
}

/// One call of run().
class LocalLauncher::Batch {
 public:
  Batch(LocalLauncher& launcher, std::span<const Point> points, const Watch& watch)
      : launcher_(launcher), points_(points), watch_(watch) {
    end_.fates.assign(points.size(), Fate::kMissing);
    std::map<std::string_view, std::size_t> first;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const auto [same, is_new] = first.emplace(points[p].id, p);
      if (is_new) {
        look_up(p);
      } else {
        twins_.emplace(same->second, p);
      }
    }
    for (const auto& [p, twin] : twins_) {
      if (end_.fates[p] != Fate::kMissing) finish(twin, end_.fates[p]);
    }
    remove_unused_streams();
  }

  BatchEnd run() {
    if (waiting_.empty()) return std::move(end_);
    const sim::HostClock::time_point begin = sim::HostClock::now();
    end_.workers = static_cast<std::uint32_t>(std::min(launcher_.workers_.size(), waiting_.size()));
    begun_.resize(end_.workers);
    while (left_ != 0) {
      if (interrupted()) {
        launcher_.stop();
        end_.interrupted = true;
        break;
      }
      for (std::size_t w = 0; w < end_.workers; ++w) employ(w);
      listen();
    }
    end_.seconds = sim::seconds_since(begin);
    end_.busy = busy_ / (end_.seconds * end_.workers);
    return std::move(end_);
  }

 private:
  struct Waiting {
    std::size_t point;
    int attempt = 1;
    bool locked = false;  ///< by another process, when last looked at
  };
  /// Points that share a recorded stream.
  struct Group {
    enum class State : std::uint8_t { kUnrecorded, kUnderWay, kReady, kImpossible } state = State::kUnrecorded;
    std::size_t left = 0;                 ///< points that have not ended
    std::optional<std::size_t> recorder;  ///< the point that records it
  };

  void look_up(std::size_t p) {
    const Store& store = launcher_.store_;
    if (store.state(points_[p].id) == Store::State::kGood) {
      finish(p, Fate::kFound);
    } else if (!launcher_.options_.retry_failed && store.failure(points_[p].id)) {
      finish(p, Fate::kFailed);
    } else {
      waiting_.push_back({p});
      left_ += 1;
      if (!points_[p].stream.empty()) groups_[points_[p].stream].left += 1;
    }
  }

  Group* group_of(std::size_t p) { return points_[p].stream.empty() ? nullptr : &groups_.at(points_[p].stream); }

  /// Nobody else is recording what it could play.
  bool is_ready(const Waiting& waiting) {
    const Group* group = group_of(waiting.point);
    return !waiting.locked && (group == nullptr || group->state != Group::State::kUnderWay);
  }

  /// Shall the point record its stream for others? From now on it does.
  bool begin_recording(std::size_t p) {
    Group* group = group_of(p);
    if (group == nullptr || group->state != Group::State::kUnrecorded) return false;
    std::error_code failed;
    const bool is_there = std::filesystem::exists(launcher_.store_.stream(points_[p].stream), failed);
    if (is_there) group->state = Group::State::kReady;
    if (is_there || group->left < 2) return false;
    group->state = Group::State::kUnderWay;
    group->recorder = p;
    return true;
  }

  void end_recording(std::size_t p) {
    Group* group = group_of(p);
    if (group == nullptr || group->recorder != p) return;
    std::error_code failed;
    const bool is_there = std::filesystem::exists(launcher_.store_.stream(points_[p].stream), failed);
    group->state = is_there ? Group::State::kReady : Group::State::kImpossible;
    group->recorder.reset();
  }

  void leave_group(std::size_t p) {
    Group* group = group_of(p);
    if (group == nullptr || --group->left != 0 || launcher_.options_.keep_streams) return;
    launcher_.store_.remove_stream(points_[p].stream);
  }

  /// Streams that a killed run has left and no point needs any more.
  void remove_unused_streams() {
    if (launcher_.options_.keep_streams) return;
    for (const Point& point : points_) {
      if (!point.stream.empty() && !groups_.contains(point.stream)) launcher_.store_.remove_stream(point.stream);
    }
  }

  void finish(std::size_t p, Fate fate) {
    end_.fates[p] = fate;
    watch_(p, fate);
  }

  void finish_all(std::size_t p, Fate fate) {
    finish(p, fate);
    const auto [begin, end] = twins_.equal_range(p);
    for (auto twin = begin; twin != end; ++twin) finish(twin->second, fate == Fate::kComputed ? Fate::kFound : fate);
    left_ -= 1;
    leave_group(p);
  }

  /// Gives a worker the next point, if it has none.
  void employ(std::size_t w) {
    Worker& worker = launcher_.workers_[w];
    if (worker.point || waiting_.empty()) return;
    auto next = std::ranges::find_if(waiting_, [&](const Waiting& waiting) { return is_ready(waiting); });
    if (next == waiting_.end()) next = std::ranges::find(waiting_, false, &Waiting::locked);
    if (next == waiting_.end()) next = waiting_.begin();
    const Waiting order = *next;
    waiting_.erase(next);
    if (worker.process < 0) launcher_.start(worker);
    worker.point = order.point;
    worker.id = points_[order.point].id;
    worker.log_begin = size_of(worker.log);
    attempts_[order.point] = order.attempt;
    begun_[w] = sim::HostClock::now();
    send_message(worker.socket, {{"point", to_line(points_[order.point])},
                                 {"record", begin_recording(order.point)},
                                 {"wait", order.locked},
                                 {"attempt", order.attempt}});
  }

  /// Waits until some worker has news.
  void listen() {
    std::vector<pollfd> sockets;
    std::vector<std::size_t> owners;
    for (std::size_t w = 0; w < end_.workers; ++w) {
      if (!launcher_.workers_[w].point) continue;
      sockets.push_back({launcher_.workers_[w].socket, POLLIN, 0});
      owners.push_back(w);
    }
    if (::poll(sockets.data(), sockets.size(), kGlance) <= 0) return;
    for (std::size_t s = 0; s < sockets.size(); ++s) {
      if (sockets[s].revents == 0) continue;
      Worker& worker = launcher_.workers_[owners[s]];
      const std::size_t p = *worker.point;
      busy_ += sim::seconds_since(begun_[owners[s]]);
      const std::optional<Json> answer = receive_message(worker.socket);
      worker.point.reset();
      end_recording(p);
      if (!answer) {
        crashed(worker, p);
      } else if (answer->contains("io_error")) {
        throw sim::IoError(answer->at("io_error").get<std::string>());
      } else if (const auto fate = static_cast<Fate>(answer->at("fate").get<int>()); fate == Fate::kLocked) {
        waiting_.push_back({p, attempts_[p], true});
      } else {
        finish_all(p, fate);
      }
    }
  }

  void crashed(Worker& worker, std::size_t p) {
    const int status = launcher_.reap(worker);
    if (interrupted()) return;
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const int exit = signal != 0 ? 128 + signal : WEXITSTATUS(status);
    const bool by_somebody = exit == 128 + SIGKILL || exit == 128 + SIGTERM;
    if (by_somebody && attempts_[p] < kAttempts) {
      waiting_.push_back({p, attempts_[p] + 1, false});
      return;
    }
    const std::string error = signal != 0 ? fmt::format("the worker crashed: {}", ::strsignal(signal))
                                          : fmt::format("the worker ended with {}", exit);
    if (const std::optional<Lock> lock = launcher_.store_.lock(points_[p].id)) {
      launcher_.store_.put_failure(
          {points_[p].id, exit, error, log_tail(worker.log, worker.log_begin), host_name(), attempts_[p]});
    }
    finish_all(p, Fate::kFailed);
  }

  LocalLauncher& launcher_;
  const std::span<const Point> points_;
  const Watch& watch_;
  std::vector<Waiting> waiting_;
  std::multimap<std::size_t, std::size_t> twins_;  ///< points with the id of an earlier one
  std::map<std::size_t, int> attempts_;
  std::map<std::string, Group> groups_;            ///< by stream
  std::vector<sim::HostClock::time_point> begun_;  ///< by worker
  std::size_t left_ = 0;
  double busy_ = 0;  ///< s
  BatchEnd end_;
};

BatchEnd LocalLauncher::run(std::span<const Point> points, const Watch& watch) {
  if (!options_.log.empty()) make_folders(options_.log);
  Batch batch(*this, points, watch);
  try {
    return batch.run();
  } catch (...) {
    stop();
    throw;
  }
}

}  // namespace tools::sweep
