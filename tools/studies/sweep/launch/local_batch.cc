#include <algorithm>
#include <csignal>
#include <cstring>
#include <fstream>
#include <map>

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "tools/host/exit_code.h"
#include "tools/host/interrupt.h"
#include "tools/studies/sweep/launch/local_launcher.h"
#include "tools/studies/sweep/launch/worker_channel.h"
#include "tools/studies/sweep/store/durable.h"

namespace tools::sweep {
namespace {

using sim::Json;

constexpr int kGlance = 200;  // ms: how late an interrupt may be seen
constexpr int kAttempts = 2;  // for a point whose worker somebody has killed

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
      if (is_interrupted()) {
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
    } else if (!launcher_.retry_failed_ && store.failure(points_[p].id)) {
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
    if (is_interrupted()) return;
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const int exit = signal != 0 ? 128 + signal : WEXITSTATUS(status);
    const bool by_somebody = exit == 128 + SIGKILL || exit == 128 + SIGTERM;
    if (by_somebody && attempts_[p] < kAttempts) {
      waiting_.push_back({p, attempts_[p] + 1, false});
      return;
    }
    if (exit == kGood || exit == kIoFailed)
      throw sim::IoError(fmt::format("a worker ended before it had told the result of {}", points_[p].id));
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

BatchEnd LocalLauncher::play(std::span<const Point> points, const Watch& watch) {
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
