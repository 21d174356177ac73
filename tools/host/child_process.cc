#include "tools/host/child_process.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tools {
namespace {

[[noreturn]] void throw_errno(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

void write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0) throw_errno("pipe");
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

ChildProcess::ChildProcess(const std::function<std::string()>& make_text) {
  int ends[2];
  if (::pipe(ends) != 0) throw_errno("pipe");
  process_ = ::fork();
  if (process_ < 0) throw_errno("fork");
  if (process_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
    ::close(ends[0]);
    write_all(ends[1], make_text());
    std::_Exit(0);
  }
  ::close(ends[1]);
  pipe_end_ = ends[0];
}

ChildProcess::~ChildProcess() {
  ::close(pipe_end_);
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  wait_for_exit();
}

bool ChildProcess::receive_data() {
  char part[1 << 16];
  const ssize_t n = ::read(pipe_end_, part, sizeof part);
  if (n > 0) text_.append(part, static_cast<std::size_t>(n));
  if (n < 0 && errno != EINTR) throw_errno("pipe");
  return n != 0;
}

int ChildProcess::wait_for_exit() {
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

}  // namespace tools
