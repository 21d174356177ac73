#include <algorithm>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <latch>
#include <memory>
#include <mutex>
#include <optional>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/machines/gpu.h"
#include "shader_kernels/catalogue.h"
#include "sim/engine.h"
#include "tests/allocations/count.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/temp_folder.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/replay_program.h"
#include "traces/trace_file/trace_reader.h"
#include "traces/trace_file/trace_writer.h"

// Rendering and simulating a frame allocates no memory in the steady state, because storage is reused. Exceptions:
// storage may still grow where nodes of a tile move between threads, and where traces are written or read, but not with
// every ray.

namespace test {
namespace {

constexpr std::uint32_t kTimes = 6, kWidth = 192, kHeight = 96, kTile = 16;
/// Number of tiles in the list: more than a machine and all worker threads ever hold at once.
constexpr std::uint32_t kInMachine = 24, kOfWorker = 8;

enum Half : std::uint8_t { kTiming, kFunction };

/// A frame whose list contains every tile several times, so that its last tiles are no larger than earlier ones. With
/// workers, each new thread first makes every tile once and waits until all have done so. So all storage is warm,
/// independent of scheduling.
class Again final : public kernels::FrameProgram {
 public:
  Again(kernels::FrameProgram& frame, std::uint32_t workers)
      : FrameProgram(frame.width(), frame.height()), frame_(frame), workers_(workers), all_threads_(workers) {}
  std::uint32_t tiles() const override { return kTimes * frame_.tiles(); }
  kernels::FrameRequirements requirements() const override { return frame_.requirements(); }
  void run_tile(std::uint32_t index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override {
    if (workers_ != 0) {
      const bool thread_comes = comes(std::this_thread::get_id(), threads_),
                 room_comes = comes<const kernels::TileResult*>(&out, rooms_);
      for (std::uint32_t tile = 0; (thread_comes || room_comes) && tile < frame_.tiles(); ++tile) {
        frame_.run_tile(tile, tracer, record, out);
      }
      if (thread_comes) all_threads_.arrive_and_wait();
    }
    frame_.run_tile(index % frame_.tiles(), tracer, record, out);
  }

 private:
  /// True on the first call with this value.
  template <class T>
  bool comes(const T& what, std::vector<T>& known) const {
    const std::lock_guard lock(mutex_);
    if (std::ranges::find(known, what) != known.end()) return false;
    known.push_back(what);
    return true;
  }

  kernels::FrameProgram& frame_;
  const std::uint32_t workers_;
  mutable std::latch all_threads_;
  mutable std::mutex mutex_;
  mutable std::vector<std::thread::id> threads_;
  mutable std::vector<const kernels::TileResult*> rooms_;
};

/// Counts allocations during the last round, except its last tile, which copies the picture. Separates the functional
/// half from the machine.
class Counting final : public hw::TileSource {
 public:
  Counting(tools::FrontEnd& front_end, std::uint32_t tiles, std::uint32_t workers, traces::TraceWriter* trace,
           CountAllocations& count)
      : front_end_(front_end),
        warm_up_((kTimes - 1) * tiles),
        end_(kTimes * tiles - 1),
        many_(workers == 0 ? 0 : kInMachine + kOfWorker * workers),
        trace_(trace),
        count_(count) {}
  const traces::TileWork* next() override {
    if (handed_ == warm_up_) count_.start();
    count_.group(kFunction);
    const traces::TileWork* work = take();
    if (trace_ != nullptr && work != nullptr) trace_->add_tile(*work);
    count_.group(kTiming);
    handed_ += 1;
    if (handed_ == warm_up_) rays_before_ = rays();
    if (handed_ == end_) count_.stop();
    return work;
  }
  void release_work(const traces::TileWork* work) override {
    count_.group(kFunction);
    front_end_.release_work(work);
    count_.group(kTiming);
  }
  std::uint64_t rays_counted() const { return rays() - rays_before_; }

 private:
  /// With workers, it takes more tiles at once than usual shortly before it counts. So the front end then has all the
  /// storage that it may need.
  const traces::TileWork* take() {
    if (handed_ == warm_up_ - many_) {
      for (std::uint32_t i = 0; i < many_; ++i) held_.push_back(front_end_.next());
    }
    if (held_.empty()) return front_end_.next();
    const traces::TileWork* work = held_.front();
    held_.pop_front();
    return work;
  }
  std::uint64_t rays() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t n : front_end_.result().rays) sum += n;
    return sum;
  }

  tools::FrontEnd& front_end_;
  const std::uint32_t warm_up_, end_, many_;
  traces::TraceWriter* const trace_;
  CountAllocations& count_;
  std::deque<const traces::TileWork*> held_;
  std::uint32_t handed_ = 0;
  std::uint64_t rays_before_ = 0;
};

/// A frame that is written to a trace and read back.
class Trace {
 public:
  explicit Trace(const hw::test::Method& frame) : workload_(frame.workload()) {}

  /// A trace to be written, positioned at the tiles of its only part.
  std::unique_ptr<traces::TraceWriter> begin(const kernels::FrameProgram& program) const {
    auto writer = std::make_unique<traces::TraceWriter>(file(), traces::Json{{"version", traces::kTraceVersion}});
    const kernels::FrameRequirements requirements = program.requirements();
    writer->begin_part({}, traces::links_of(workload_.image), traces::counts_of(workload_.image), requirements);
    return writer;
  }
  /// Writes the whole frame; replay() is valid afterwards.
  void record(kernels::FrameProgram& program, const traces::Tracer& tracer) {
    const std::unique_ptr<traces::TraceWriter> writer = begin(program);
    tools::FrontEnd front_end(program, tracer, 0);
    while (const traces::TileWork* work = front_end.next()) writer->add_tile(*work), front_end.release_work(work);
    writer->end_part({{"continued", 0}, {"sampling", {{"wanted", 1}}}});
    writer->commit();
    reader_.emplace(file());
    for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) kernels_.push_back(kernel.id);
    scope_ = reader_->tile_scope(reader_->parts().front(), static_cast<std::uint32_t>(kernels_.size()));
    scope_.region_bytes = reader_->parts().front().requirements.region_bytes;
    replay_.emplace(*reader_, reader_->parts().front(), scope_, kernels_);
  }
  kernels::FrameProgram& replay() { return *replay_; }

 private:
  std::filesystem::path file() const { return folder_.path() / "a.trace"; }

  const hw::Gpu::Workload workload_;
  const TempFolder folder_;
  std::optional<traces::TraceReader> reader_;
  std::vector<traces::KernelId> kernels_;
  traces::TileScope scope_;
  std::optional<tools::ReplayProgram> replay_;
};

enum class File : std::uint8_t { kNone, kWritten, kRead };

struct Case {
  std::string name, scene, program = "full:1";
  hw::GpuConfig machine{};
  traces::BvhConfig bvh{};
  std::uint32_t workers = 0;
  File trace = File::kNone;
  std::uint64_t rays_an_allocation = 0;  ///< minimum rays per allocation; 0: no allocation is allowed
  bool has_late_tiles = false;  ///< more tiles than before are in flight late in the frame, and their nodes need room
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

std::vector<Case> cases() {
  hw::GpuConfig through_memory, restarting;
  through_memory.direct_interface.enabled = false;
  restarting.tni.trv.stack = hw::StackScheme::kRestartTrail;
  restarting.tni.trv.stack_entries = 2;
  traces::BvhConfig two_level;
  two_level.instances = traces::InstanceLevels::kTwoLevel;
  return {{.name = "cornell", .scene = "cornell"},
          {.name = "chess", .scene = "chess"},
          {.name = "one_worker", .scene = "cornell", .workers = 1, .rays_an_allocation = 50},
          {.name = "three_workers", .scene = "cornell", .workers = 3, .rays_an_allocation = 50},
          {.name = "tree_of_two_levels", .scene = "chess", .bvh = two_level},
          {.name = "rays_through_memory", .scene = "cornell", .machine = through_memory, .has_late_tiles = true},
          {.name = "restart_trail", .scene = "cornell", .machine = restarting, .has_late_tiles = true},
          {.name = "adaptive", .scene = "cornell", .program = "multirate:super", .rays_an_allocation = 50},
          {.name = "recorded", .scene = "cornell", .trace = File::kWritten, .rays_an_allocation = 50},
          {.name = "replayed", .scene = "cornell", .trace = File::kRead, .rays_an_allocation = 50}};
}

class Allocations : public testing::TestWithParam<Case> {};

TEST_P(Allocations, StopInTheSteadyStateOfAFrame) {
  if (!can_count_allocations()) GTEST_SKIP() << "the sanitizer has the heap";
  const Case& c = GetParam();
  const hw::test::Method frame(c.scene, c.program, {}, kWidth, kHeight, kTile, c.bvh);
  const std::unique_ptr<kernels::FrameProgram> program = frame.make();
  Trace trace(frame);
  if (c.trace == File::kRead) trace.record(*frame.make(), frame.tracer());
  const auto written = c.trace == File::kWritten ? trace.begin(*program) : nullptr;
  kernels::FrameProgram& tiles = c.trace == File::kRead ? trace.replay() : *program;
  Again again(tiles, c.workers);
  tools::FrontEnd front_end(again, frame.tracer(), c.workers);
  CountAllocations count;
  Counting counted(front_end, tiles.tiles(), c.workers, written.get(), count);
  hw::Gpu gpu(c.machine, frame.workload(), counted);
  sim::run(gpu);
  EXPECT_GT(counted.rays_counted(), 30'000U);
  const std::uint64_t most = c.rays_an_allocation == 0 ? 0 : counted.rays_counted() / c.rays_an_allocation;
  const std::uint64_t most_of_tiles = c.has_late_tiles ? counted.rays_counted() / 1000 : most;
  EXPECT_LE(count.count(kFunction), most_of_tiles) << "functional half, for " << counted.rays_counted() << " rays:\n"
                                                   << count.sites(kFunction);
  EXPECT_LE(count.count(kTiming), most) << "timing half, for " << counted.rays_counted() << " rays:\n"
                                        << count.sites(kTiming);
}

INSTANTIATE_TEST_SUITE_P(Of, Allocations, testing::ValuesIn(cases()), [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace test
