#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of sweeps on a real Slurm of three nodes, which this program runs on the loopback interface.

namespace test {
namespace {

namespace fs = std::filesystem;

// A sweep of 25 points; one cannot be computed.
constexpr const char* kSweep =
    "schema: raywatt-sweep/1\n"
    "resolution: 64x32\n"
    "axes: {program: [full:1, full:4], cores: [1, 2, 4], tni.trvs: [1, 2, 4, 8], scene.camera: ['0', absent]}\n"
    "exclude: [{scene.camera: absent, cores: '> 1'}, {scene.camera: absent, tni.trvs: '> 1'},\n"
    "          {scene.camera: absent, program: 'full:4'}]\n";
constexpr std::size_t kPoints = 25, kGoodPoints = 24;
constexpr std::size_t kLargestArray = 11;

/// True if a process belongs to a job on a node.
bool is_on(const std::string& node, const std::string& process) {
  std::ifstream file("/proc/" + process + "/environ");
  const std::string variables((std::istreambuf_iterator<char>(file)), {});
  return variables.find("SLURMD_NODENAME=" + node) != std::string::npos;
}

struct Slurm : testing::Test {
  static void SetUpTestSuite() {
    cluster_ = std::make_unique<TempFolder>();
    ::setenv("MAX_ARRAY", std::to_string(kLargestArray).c_str(), 1);
    ::setenv("SLURM_CONF", (fs::canonical(cluster_->path()) / "slurm.conf").c_str(), 1);
    exit_ = tell_cluster("up");
  }
  static void TearDownTestSuite() {
    tell_cluster("down");
    cluster_.reset();
  }
  static int tell_cluster(const std::string& what, const std::string& node = {}) {
    const std::string line = CLUSTER_SCRIPT " " + what + " " + cluster_->path().string() + " " + node;
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  void SetUp() override {
    if (exit_ == 77) GTEST_SKIP() << "no Slurm can be started here: " << CLUSTER_SCRIPT << " says why, above";
    ASSERT_EQ(exit_, 0) << "the cluster does not come up";
    file = folder.write("sweep.yaml", kSweep);
  }

  Words on_slurm(const Words& more) {
    Words words = sweep_run(folder, file, {"--launcher", "slurm", "--chunk", "1"});
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Words in_list(const std::string& name) {
    std::istringstream text(read_bytes(out / name));
    return {std::istream_iterator<std::string>(text), {}};
  }
  nlohmann::json status() { return nlohmann::json::parse(raywatt({"sweep", "status", out, "--json"}).out); }

  /// Returns results.csv of the same sweep, computed by processes on this host.
  static const std::string& local_table() {
    static const std::string table = [] {
      const TempFolder other;
      EXPECT_EQ(raywatt(sweep_run(other, other.write("sweep.yaml", kSweep), {"-j", "2"})).exit, 1);
      return read_bytes(other.path() / "out" / "results.csv");
    }();
    return table;
  }
  /// Stops a process of a node while it computes a point, once `finished` points are done. The process then still
  /// exists when the node is lost.
  void stop_a_worker_on(const std::string& node, std::size_t finished) {
    std::string worker;
    const auto is_computing = [&] {
      std::error_code missing;
      for (const fs::directory_entry& entry : fs::directory_iterator(store / "tmp", missing)) {
        // A temporary folder is named ".ID.PID-N.raywatt-tmp".
        const std::string process = entry.path().stem().extension();
        worker = process.substr(std::min<std::size_t>(1, process.size()), process.find('-') - 1);
        if (is_on(node, worker)) return true;
      }
      return false;
    };
    ASSERT_TRUE(wait_until([&] { return points_in(store) >= finished && is_computing(); }));
    ::kill(std::stoi(worker), SIGSTOP);
  }
  /// Returns the modification times of the results by point id. A result that was replaced has a new time.
  std::map<std::string, fs::file_time_type> results() {
    std::map<std::string, fs::file_time_type> times;
    std::error_code missing;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(store / "points", missing)) {
      if (entry.path().filename() != "report.json") continue;
      times[entry.path().parent_path().filename()] = entry.last_write_time(missing);
    }
    return times;
  }
  void expect_the_whole_sweep() {
    EXPECT_EQ(points_in(store), kGoodPoints);
    EXPECT_TRUE(read_bytes(out / "results.csv") == local_table()) << "the tables differ";
    for (const char* name : {"tmp", "locks", "streams"}) {
      if (!fs::exists(store / name)) continue;
      EXPECT_EQ(names_in(store / name), Words{}) << name;
    }
    EXPECT_FALSE(fs::exists(store / "damaged"));
  }
  void expect_as_before(const std::map<std::string, fs::file_time_type>& before) {
    const auto after = results();
    for (const auto& [id, time] : before) EXPECT_EQ(after.at(id), time) << "computed again";
  }

  static inline std::unique_ptr<TempFolder> cluster_;
  static inline int exit_ = -1;
  TempFolder folder;
  fs::path out = folder.path() / "out", store = folder.path() / "store", file;
};

TEST_F(Slurm, ACancelledSweepGoesOnWithWhatIsMissing) {
  const ProcessResult begun = raywatt(on_slurm({"--slurm-args", "--time=10 --comment=a"}));
  ASSERT_EQ(begun.exit, 0) << begun.err;
  EXPECT_SAYS(begun.out, "25 points: 25 handed in, 0 in the queue already, 0 with a result");
  EXPECT_SAYS(raywatt(on_slurm({})).out, " 0 handed in") << "what is in the queue is not handed in twice";
  ASSERT_TRUE(wait_until([&] { return points_in(store) >= 3; }));
  EXPECT_FALSE(status()["slurm"]["jobs"].empty());
  const ProcessResult cancelled = raywatt({"sweep", "cancel", out});
  EXPECT_EQ(cancelled.exit, 0) << cancelled.err;
  EXPECT_SAYS(cancelled.out, "cancelled job");
  const auto before = results();
  EXPECT_LT(before.size(), kGoodPoints);
  EXPECT_TRUE(status()["slurm"]["jobs"].empty());
  EXPECT_TRUE(names_in(store / "tmp").empty()) << "what was under way is dropped";

  const auto missing = status()["missing"].get<std::size_t>();
  const ProcessResult ended = raywatt(on_slurm({"--wait"}));
  EXPECT_EQ(ended.exit, 1) << ended.err << ended.out;
  EXPECT_SAYS(ended.out, " 1 failed\n");  // no point is missing
  std::size_t handed_in = 0;
  for (int k = 4; fs::exists(out / ("submit-" + std::to_string(k) + ".txt")); ++k) {
    for (const std::string& id : in_list("submit-" + std::to_string(k) + ".txt")) {
      handed_in += 1;
      EXPECT_FALSE(before.contains(id)) << "was there";
    }
  }
  EXPECT_EQ(handed_in, missing);
  expect_as_before(before);
  expect_the_whole_sweep();
}

TEST_F(Slurm, NodesShareOneFrameInSlicesAndALostOneTakesNoneWithIt) {
  file =
      folder.write("sweep.yaml",
                   "schema: raywatt-sweep/1\nresolution: 256x256\nprogram: full:4\nsets: [render.tile=8]\nslices: 9\n");
  const TempFolder local;
  ASSERT_EQ(raywatt(sweep_run(local, file, {"-j", "2"})).exit, 0);
  Program program(on_slurm({"--wait"}));
  stop_a_worker_on("n3", 2);
  ASSERT_EQ(tell_cluster("crash", "n3"), 0);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 0) << ending.err << ending.out;
  EXPECT_EQ(last_run_counts(out), (Tally{1, 1, 0, 0}));
  EXPECT_EQ(in_list("submit-1.txt").size(), 9U);
  EXPECT_EQ(points_in(store), 10U);
  EXPECT_EQ(read_bytes(out / "results.csv"), read_bytes(local.path() / "out" / "results.csv"));
  EXPECT_EQ(names_in(store / "tmp"), Words{});
  EXPECT_EQ(tell_cluster("start", "n3"), 0);
}

TEST_F(Slurm, ANodeThatIsLostTakesNoPointWithItAndTheTableIsTheLocalOne) {
  Program program(on_slurm({"--wait"}));
  stop_a_worker_on("n2", 3);
  const auto before = results();
  ASSERT_EQ(tell_cluster("crash", "n2"), 0);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 1) << ending.err << ending.out;
  EXPECT_EQ(last_run_counts(out), (Tally{25, 24, 0, 1}));
  EXPECT_EQ(in_list("submit-1.txt").size(), kLargestArray);
  EXPECT_EQ(in_list("submit-2.txt").size(), kLargestArray);
  EXPECT_EQ(in_list("submit-3.txt").size(), kPoints - 2 * kLargestArray);
  expect_as_before(before);
  expect_the_whole_sweep();
  raywatt(on_slurm({"--wait"}));
  EXPECT_EQ(last_run_counts(out), (Tally{25, 0, 24, 1}));
  EXPECT_FALSE(fs::exists(out / "submit-4.txt"));
}

}  // namespace
}  // namespace test
