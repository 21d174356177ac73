#include "tests/tools/program.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace test {
namespace {

constexpr auto kPatience = std::chrono::seconds(120);
constexpr auto kGlance = std::chrono::milliseconds(2);

void redirect(const std::string& path, int stream) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT, 0666);
  if (file < 0 || ::dup2(file, stream) < 0) ::_exit(126);
}

void become_unread_pipe(int stream) {
  int ends[2];
  if (::pipe(ends) != 0 || ::dup2(ends[1], stream) < 0) ::_exit(126);
  ::close(ends[0]);
  ::close(ends[1]);
}

/// Runs in the child process: sets signals and environment as in a terminal, then starts the program.
[[noreturn]] void exec_program(const Words& words, const ProcessEnvironment& around, const std::string& out,
                               const std::string& err) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ}) ::signal(signal, SIG_DFL);
  ::unsetenv("RAYWATT_PATH");
  ::setenv("LC_ALL", "C.UTF-8", 1);
  for (const auto& [name, value] : around.variables) ::setenv(name.c_str(), value.c_str(), 1);
  redirect(out, STDOUT_FILENO);
  redirect(err, STDERR_FILENO);
  if (!around.folder.empty() && ::chdir(around.folder.c_str()) != 0) ::_exit(126);
  if (around.longest_file != 0) {
    const rlimit limit{around.longest_file, around.longest_file};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  for (const int stream : around.closed) ::close(stream);
  for (const int stream : around.unread) become_unread_pipe(stream);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ::execv(arguments.front(), arguments.data());
  ::_exit(127);
}

}  // namespace

bool wait_until(const std::function<bool()>& is_so) {
  const auto begin = std::chrono::steady_clock::now();
  while (!is_so()) {
    if (std::chrono::steady_clock::now() - begin > kPatience) return false;
    std::this_thread::sleep_for(kGlance);
  }
  return true;
}

Program::Program(Words arguments, const ProcessEnvironment& around) {
  arguments.insert(arguments.begin(), around.program.empty() ? RAYWATT_PROGRAM : around.program.string());
  const std::string out = around.out.empty() ? streams_.write("out", "").string() : around.out;
  const std::string err = around.err.empty() ? streams_.write("err", "").string() : around.err;
  process_ = ::fork();
  if (process_ == 0) exec_program(arguments, around, out, err);
}

Program::~Program() {
  if (ended()) return;
  send(SIGKILL);
  ::waitpid(process_, &status_, 0);
}

void Program::send(int signal) const {
  if (process_ > 0) ::kill(process_, signal);
}

bool Program::ended() {
  if (process_ > 0 && ::waitpid(process_, &status_, WNOHANG) != 0) process_ = -1;
  return process_ < 0;
}

bool Program::wait_until(const std::function<bool(const std::string& err)>& is_as_wanted) {
  bool is_there = false;
  test::wait_until([&] {
    const bool was_last = ended();
    is_there = is_as_wanted(read_bytes(streams_.path() / "err"));
    return is_there || was_last;
  });
  return is_there;
}

bool Program::wait_for_file(const std::filesystem::path& folder, const std::string& name) {
  return wait_until([&](const std::string&) {
    std::error_code vanished;
    auto entry = std::filesystem::recursive_directory_iterator(folder, vanished);
    for (; !vanished && entry != end(entry); entry.increment(vanished)) {
      std::error_code gone;
      if (name.empty() ? entry->is_regular_file(gone) : entry->path().filename() == name) return true;
    }
    return false;
  });
}

ProcessResult Program::wait() {
  if (!test::wait_until([&] { return ended(); })) {
    ADD_FAILURE() << "the program does not end";
    send(SIGKILL);
    ::waitpid(process_, &status_, 0);
    process_ = -1;
  }
  return {WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_), read_bytes(streams_.path() / "out"),
          read_bytes(streams_.path() / "err")};
}

ProcessResult raywatt(const Words& arguments, const ProcessEnvironment& around) {
  return Program(arguments, around).wait();
}

ProcessResult ending_well(const Words& arguments, const ProcessEnvironment& around) {
  ProcessResult ending = raywatt(arguments, around);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return ending;
}

std::string output_of(const Words& arguments, const ProcessEnvironment& around) {
  return ending_well(arguments, around).out;
}

Words small_run(const std::filesystem::path& out, const Words& more) {
  Words words = {"run", "--resolution", "64x32", "--threads", "1", "-o", out.string()};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::string ray_list(std::size_t count) {
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i) {
    const float ray[8] = {0, 1, 0, 0, static_cast<float>(i % 7) - 3, -1, static_cast<float>(i % 5) - 2, 1e30F};
    bytes.append(reinterpret_cast<const char*>(ray), sizeof ray);
  }
  return bytes;
}

nlohmann::json read_json(const std::filesystem::path& path) { return nlohmann::json::parse(read_bytes(path)); }

nlohmann::json repeatable(nlohmann::json report) {
  report.erase("host");
  report["provenance"].erase("argv");
  return report;
}

Words names_in(const std::filesystem::path& folder) {
  Words names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  return names;
}

void expect_refusal(const ProcessResult& ending, const Words& parts) {
  EXPECT_EQ(ending.exit, 2) << ending.err;
  EXPECT_EQ(ending.out, "");
  EXPECT_TRUE(ending.err.starts_with("raywatt: ")) << ending.err;
  EXPECT_EQ(std::ranges::count(ending.err, '\n'), 1) << ending.err;
  EXPECT_TRUE(ending.err.ends_with("\n")) << ending.err;
  for (const std::string& part : parts) EXPECT_SAYS(ending.err, part);
}

void expect_refused_run(const Words& more, const Words& parts) {
  const TempFolder folder;
  expect_refusal(raywatt(small_run(folder.path() / "out", more)), parts);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

}  // namespace test
