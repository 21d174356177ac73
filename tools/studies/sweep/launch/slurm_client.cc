#include "tools/studies/sweep/launch/slurm_client.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/standard_streams.h"

extern char** environ;

namespace tools::sweep::slurm {
namespace {

using Words = std::vector<std::string>;

constexpr std::size_t kMostComplaint = 2000;  // bytes

struct Said {
  int exit = 0;
  std::string out, err;
};

/// A nameless file for what a command says.
class Sink {
 public:
  Sink() : file_(::memfd_create("said", MFD_CLOEXEC)) {
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), "no room for what a command says");
  }
  ~Sink() { ::close(file_); }
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;

  int file() const { return file_; }
  std::string text() const {
    std::string text;
    std::array<char, 65536> part{};
    for (ssize_t size = 0; (size = ::pread(file_, part.data(), part.size(), static_cast<off_t>(text.size()))) > 0;) {
      text.append(part.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

 private:
  int file_;
};

/// The environment without the variables that would make squeue and scancel leave things out, or ask.
std::vector<char*> environment() {
  std::vector<char*> variables;
  for (char** v = environ; *v != nullptr; ++v) {
    const std::string_view variable = *v;
    if (!variable.starts_with("SQUEUE_") && !variable.starts_with("SCANCEL_")) variables.push_back(*v);
  }
  variables.push_back(nullptr);
  return variables;
}

/// In a process group of its own: Ctrl-C is for this process alone; and with signals as programs expect them.
Said call(const Words& words) {
  const Sink out, err;
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, out.file(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, err.file(), STDERR_FILENO);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t as_usual;
  ::sigemptyset(&as_usual);
  for (const int signal : kSignalsOfWrites) ::sigaddset(&as_usual, signal);
  ::posix_spawnattr_setsigdefault(&attributes, &as_usual);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  const int error = ::posix_spawnp(&process, arguments[0], &files, &attributes, arguments.data(), environment().data());
  ::posix_spawn_file_actions_destroy(&files);
  ::posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    throw sim::InputError(fmt::format(
        "{} cannot be started: {}; --launcher slurm is for hosts from which jobs are handed in, others have local",
        words[0], std::generic_category().message(error)));
  }
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), out.text(), err.text()};
}

/// "sbatch: error: ...", on one line, as Slurm has it.
std::string complaint(const Words& words, const Said& said) {
  std::string text;
  std::istringstream lines(said.err);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) text += (text.empty() ? "" : "; ") + line;
  }
  if (text.empty()) text = fmt::format("{} ended with {} and said nothing", words[0], said.exit);
  return sim::printable(text, kMostComplaint);
}

template <class Error>
std::string output_of(const Words& words) {
  const Said said = call(words);
  if (said.exit != 0) throw Error(complaint(words, said));
  return said.out;
}

}  // namespace

std::vector<SlurmTask> tasks_of(const std::filesystem::path& folder) {
  // The script's name may hold anything and is the last.
  std::istringstream lines(
      output_of<sim::IoError>({"squeue", "--me", "--noheader", "--array", "--format=%F|%K|%T|%r|%N|%o"}));
  std::vector<SlurmTask> tasks;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    SlurmTask task;
    std::string index, script;
    for (std::string* field : {&task.job, &index, &task.state, &task.reason, &task.node}) {
      std::getline(fields, *field, '|');
    }
    std::getline(fields, script);
    task.script = script;
    const auto [end, error] = std::from_chars(index.data(), index.data() + index.size(), task.index);
    if (error == std::errc() && task.script.parent_path() == folder) tasks.push_back(std::move(task));
  }
  return tasks;
}

std::uint64_t most_tasks() {
  constexpr std::string_view kKey = "MaxArraySize";
  std::istringstream lines(output_of<sim::IoError>({"scontrol", "show", "config"}));
  for (std::string line; std::getline(lines, line);) {
    std::uint64_t most = 0;
    const std::size_t equals = line.find('=');
    if (!line.starts_with(kKey) || equals == std::string::npos) continue;
    std::istringstream(line.substr(equals + 1)) >> most;
    if (most != 0) return most;  // indices go from 0 to one less
    throw sim::InputError("this Slurm has no job arrays: its MaxArraySize is 0");
  }
  throw sim::IoError("scontrol show config says nothing of MaxArraySize");
}

std::string submit(const Words& arguments) {
  Words words = {"sbatch", "--parsable"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const std::string out = output_of<sim::InputError>(words);
  return out.substr(0, out.find_first_of(";\n"));  // "12" or "12;cluster"
}

void cancel(const std::set<std::string>& jobs) {
  if (jobs.empty()) return;
  Words words = {"scancel"};
  words.insert(words.end(), jobs.begin(), jobs.end());
  output_of<sim::IoError>(words);
}

}  // namespace tools::sweep::slurm
