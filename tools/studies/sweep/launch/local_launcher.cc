#include "tools/studies/sweep/launch/local_launcher.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <new>
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
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/launch/worker_channel.h"

namespace tools::sweep {
namespace {

using sim::Json;

constexpr double kPatience = 10;  // s: for workers that shall end

}  // namespace

LocalLauncher::LocalLauncher(const Store& store, const Options& options)
    : Launcher(store, options.retry_failed), options_([&] {
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
                                                   retry_failed_, order->at("attempt").get<int>()});
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
  } catch (const std::bad_alloc&) {
    exit = kIoFailed;
  } catch (const std::exception& error) {
    print_message("internal error: {}", error.what());
    std::fflush(stderr);
    exit = kOurBug;
  }
  ::_exit(exit);
}

}  // namespace tools::sweep
