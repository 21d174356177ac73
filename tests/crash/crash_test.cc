#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/hash.h"
#include "tests/tools/program.h"

namespace test {
namespace {

namespace fs = std::filesystem;

constexpr int kNothingFails = 0;

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* value = std::getenv(name);
  return value == nullptr ? otherwise : std::strtoull(value, nullptr, 10);
}

using Results = std::map<std::string, std::string>;

/// A verb to test, with a folder work() in which it writes its results.
struct Verb {
  std::string word;
  TempFolder folder{};

  fs::path work() const { return folder.path() / "work"; }
  /// Returns the command line of the verb. A run with another resolution writes the same files; a sweep or a search
  /// continues its own folder.
  Words words(const char* resolution = "16x8") const {
    const std::string out = (work() / "out").string();
    if (word == "run") return {"run", "--resolution", resolution, "--threads", "1", "--quiet", "-o", out};
    if (word == "record") {
      return {"trace", "record", "--resolution", resolution, "--threads", "1", out + ".trace"};
    }
    if (word == "baseline") {
      folder.write("work/suite.yaml", std::string("keep: {cycles: exact}\ndefaults: {resolution: ") + resolution +
                                          "}\nruns:\n  one: {}\n  two: {set: {cores: 2}}\n");
      return {"baseline", "record", (work() / "suite.yaml").string(), "--force", "-j", "1"};
    }
    if (word == "optimise") {
      const fs::path spec = folder.write("search.yaml",
                                         "schema: raywatt-optimise/1\nresolution: 16x8\naxes: {cores: [1, 2, 3, 4]}\n"
                                         "objectives: [{max: perf.fps}]\nbudget: 4\n");
      return {"optimise", spec.string(), "-o", out, "--store", (work() / "store").string(), "-j", "1"};
    }
    const fs::path spec =
        folder.write("sweep.yaml", "schema: raywatt-sweep/1\nresolution: 16x8\naxes: {cores: [1, 2]}\n");
    return {"sweep", "run", spec.string(), "-o", out, "--store", (work() / "store").string(), "-j", "1"};
  }
  void begin_anew() const {
    fs::remove_all(work());
    fs::create_directory(work());
  }
  bool goes_on() const { return word == "sweep" || word == "optimise"; }
  /// Creates work(). With `has_former` it has results: of another resolution, or of the same command for verbs that
  /// continue.
  Results begin(bool has_former) const {
    begin_anew();
    if (!has_former) return {};
    EXPECT_EQ(raywatt(words(goes_on() ? "16x8" : "8x8")).exit, 0);
    return results();
  }
  ProcessResult run(std::uint64_t failing, const char* which = "CRASH_AT") const {
    const fs::path counter = folder.write("calls", std::string(8, '\0'));
    return raywatt(words(), {.variables = {{"LD_PRELOAD", FAILING_CALLS},
                                           {"CRASH_BELOW", work().string()},
                                           {"CRASH_COUNTER", counter.string()},
                                           {which, std::to_string(failing)}}});
  }
  std::uint64_t calls() const {
    const std::string bytes = read_bytes(folder.path() / "calls");
    std::uint64_t calls = 0;
    std::memcpy(&calls, bytes.data(), sizeof calls);
    return calls;
  }
  bool is_result(const fs::path& file) const {
    const fs::path name = file.filename();
    return name == "report.json" || name == "config.yaml" || name == "image.png" || name == "points.jsonl" ||
           name.extension() == ".trace" || name == "suite.baseline.yaml" || name == "front.csv";
  }
  /// True for temporary files, and for result folders that do not have their final name yet.
  static bool is_temporary(const fs::path& name) {
    return name.string().find("raywatt-tmp") != std::string::npos || name.string().starts_with("store/tmp");
  }
  /// Returns the result files by name, without values that differ between equal runs.
  std::map<std::string, std::string> results() const {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(work())) {
      const fs::path name = entry.path().lexically_relative(work());
      if (!entry.is_regular_file() || !is_result(name) || is_temporary(name)) continue;
      std::string bytes = read_bytes(entry.path());
      if (name.filename() == "report.json") {
        nlohmann::json report = nlohmann::json::parse(bytes);
        report.erase("host");
        report["provenance"].erase("argv");
        bytes = report.dump();
      }
      found[name.string()] = std::move(bytes);
    }
    return found;
  }
  Words temporaries() const {
    Words found;
    for (const auto& entry : fs::recursive_directory_iterator(work())) {
      const fs::path name = entry.path().filename();
      if (name.string().find("raywatt-tmp") != std::string::npos || entry.path().parent_path().filename() == "tmp") {
        found.push_back(entry.path().string());
      }
    }
    return found;
  }
};

/// Expects that the folder has either all new results or all previous ones. A sweep may have some of its points and a
/// search some of its lines.
void expect_whole(const Verb& verb, const Results& results, const Results& whole, const Results& former) {
  if (!verb.goes_on()) {
    EXPECT_TRUE(results == whole || results == former);
    return;
  }
  for (const auto& [name, bytes] : results) {
    if (name.starts_with("store/streams")) continue;  // the next run uses or removes it
    ASSERT_TRUE(whole.contains(name)) << name;
    const bool may_grow = verb.word == "optimise" && name == "out/points.jsonl";
    const bool has_some = may_grow && whole.at(name).starts_with(bytes) && (bytes.empty() || bytes.ends_with('\n'));
    EXPECT_TRUE(bytes == whole.at(name) || has_some) << name;
  }
  for (const auto& [name, bytes] : former) EXPECT_TRUE(results.contains(name)) << name;
}

void expect_clean_failure(const Verb& verb, std::uint64_t index, bool has_former, const Results& whole,
                          const char* which = "CRASH_AT") {
  SCOPED_TRACE(verb.word + (has_former ? " again" : "") + ", " + which + " " + std::to_string(index));
  const Results former = verb.begin(has_former);
  const ProcessResult ending = verb.run(index, which);
  const bool cannot_begin = ending.exit == 2 && ending.err.find("cannot be written") != std::string::npos;
  EXPECT_TRUE(ending.exit == 0 || ending.exit == 74 || cannot_begin) << ending.exit << ": " << ending.err;
  if (ending.exit == 0) {
    EXPECT_TRUE(verb.results() == whole);
  } else {
    EXPECT_TRUE(ending.err.starts_with("raywatt: ")) << ending.err;
    expect_whole(verb, verb.results(), whole, former);
  }
  EXPECT_EQ(verb.temporaries(), Words{});
  const ProcessResult again = verb.run(kNothingFails);
  EXPECT_EQ(again.exit, 0) << again.err;
  EXPECT_TRUE(verb.results() == whole);
}

class Crash : public testing::TestWithParam<const char*> {};

/// Returns about how many different calls to let fail: all if $RAYWATT_CRASHES is "all", else a few.
std::uint64_t sample_size() {
  const char* wanted = std::getenv("RAYWATT_CRASHES");
  return wanted != nullptr && std::string(wanted) == "all" ? UINT64_MAX : 3;
}

TEST_P(Crash, OfAnyCallLeavesNothingHalfMadeAndLosesNothing) {
  const Verb verb{GetParam()};
  const std::uint64_t sample = sample_size();
  verb.begin_anew();
  ASSERT_EQ(verb.run(kNothingFails).exit, 0);
  const Results whole = verb.results();
  ASSERT_FALSE(whole.empty());
  std::uint64_t tried = 0;
  for (const bool has_former : {false, true}) {
    verb.begin(has_former);
    ASSERT_EQ(verb.run(kNothingFails).exit, 0);
    const std::uint64_t calls = verb.calls();
    for (std::uint64_t n = 1; n <= calls; ++n) {
      if (sample < calls && sim::hash(n) % calls >= sample) continue;
      expect_clean_failure(verb, n, has_former, whole);
      ++tried;
    }
  }
  std::printf("%s: %d calls failed\n", verb.word.c_str(), static_cast<int>(tried));
}

TEST_P(Crash, OfAnyLargeAllocationLeavesNothingHalfMadeAndLosesNothing) {
#ifdef RAYWATT_SANITIZED
  GTEST_SKIP() << "the sanitizer has the heap";
#endif
  const Verb verb{GetParam()};
  const char* const which = "CRASH_ALLOCATION";
  verb.begin_anew();
  ASSERT_EQ(verb.run(kNothingFails, which).exit, 0);
  const Results whole = verb.results();
  const std::uint64_t allocations = verb.calls(), sample = sample_size();
  ASSERT_GT(allocations, 10U);
  std::uint64_t tried = 0;
  for (std::uint64_t n = 1; n <= allocations; ++n) {
    if (sample < allocations && sim::hash(n, allocations) % allocations >= sample) continue;
    expect_clean_failure(verb, n, sim::hash(n) % 2 != 0, whole, which);
    ++tried;
  }
  std::printf("%s: %d of %d allocations failed\n", verb.word.c_str(), static_cast<int>(tried),
              static_cast<int>(allocations));
}

TEST_P(Crash, OfTheWholeProgramIsMendedByTheSameCommand) {
  const Verb verb{GetParam()};
  verb.begin_anew();
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(raywatt(verb.words()).exit, 0);
  const auto took = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - begin);
  const Results whole = verb.results();
  const std::uint64_t kills = from_environment("RAYWATT_KILLS", 2);
  for (std::uint64_t k = 0; k < kills; ++k) {
    const Results former = verb.begin(k % 2 != 0);
    const auto moment = sim::hash(k) % static_cast<std::uint64_t>(took.count());
    SCOPED_TRACE(verb.word + " killed after " + std::to_string(moment) + " us");
    {
      Program program(verb.words());
      std::this_thread::sleep_for(std::chrono::microseconds(moment));
      program.send(SIGKILL);
      program.wait();
    }
    expect_whole(verb, verb.results(), whole, former);
    const ProcessResult again = raywatt(verb.words());
    EXPECT_EQ(again.exit, 0) << again.err;
    EXPECT_TRUE(verb.results() == whole);
    EXPECT_EQ(verb.temporaries(), Words{});
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Crash, testing::Values("run", "record", "sweep", "baseline", "optimise"),
                         [](const auto& verb) { return std::string(verb.param); });

}  // namespace
}  // namespace test
