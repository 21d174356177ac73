#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "shader_kernels/programs/full.h"
#include "shader_kernels/programs/programs.h"
#include "sim/intervals.h"
#include "tools/run/frame/front_end.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/memory_image.h"

namespace hw::test {

/// A frame to simulate: a scene, a camera and the frame program `full`. Not movable: the program refers to the image.
class Frame {
 public:
  /// `tile`: side of a tile of the frame in samples.
  Frame(const std::string& scene, std::uint32_t width, std::uint32_t height, std::uint32_t samples = 1,
        std::uint32_t tile = 16, const traces::BvhConfig& bvh = {});
  Frame(traces::Scene&& scene, std::uint32_t width, std::uint32_t height, std::uint32_t samples = 1,
        std::uint32_t tile = 16, const traces::BvhConfig& bvh = {});
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;

  kernels::FullProgram& program() const { return program_; }
  const traces::Tracer& tracer() const { return tracer_; }
  Gpu::Workload workload() const;
  /// Records the work of all tiles of the frame, so that several machines can simulate them.
  std::vector<traces::TileWork> record() const;
  /// Returns the number of cache lines of the frame buffer that the tiles write.
  std::uint64_t picture_lines() const { return picture_lines_; }

 private:
  const traces::Camera camera_;
  const traces::MemoryImage image_;
  const std::vector<std::uint32_t> parents_;
  mutable kernels::FullProgram program_;  ///< mutable, because it stores the last picture
  const traces::BvhTracer tracer_;
  const std::uint64_t picture_lines_;
};

/// A frame to simulate with any frame program, given by name. Every run constructs a new program, because some programs
/// keep state between frames.
class Method {
 public:
  Method(const std::string& scene, const std::string& program, const kernels::ProgramConfig& programs,
         std::uint32_t width, std::uint32_t height, std::uint32_t tile, const traces::BvhConfig& bvh = {});
  Method(const traces::Scene& scene, const std::string& program, const kernels::ProgramConfig& programs,
         const kernels::RenderConfig& render, const traces::BvhConfig& bvh = {},
         const traces::PredictorConfig& predictor = {});
  Method(const Method&) = delete;
  Method& operator=(const Method&) = delete;

  /// Makes the machine build or refit the scene's trees before the tiles.
  Method& build_trees(bool refit = false, bool overlap = false,
                      traces::BuildEngine engine = traces::BuildEngine::kUnit);
  /// Makes kernels pose geometry before the trees of build_trees().
  Method& pose(const traces::PoseWork& work);
  /// Gives the machine a tree builder that has no work.
  void build_nothing() { builds_.emplace(); }
  const traces::MemoryImage& image() const { return image_; }
  const traces::TreeBuilds& builds() const { return *builds_; }

  std::unique_ptr<kernels::FrameProgram> make() const;
  const traces::Tracer& tracer() const { return tracer_; }
  Gpu::Workload workload() const;

 private:
  const kernels::ProgramSpec spec_;
  const kernels::ProgramConfig programs_;
  const kernels::RenderConfig render_;
  const kernels::RateMap rates_;
  const traces::Camera camera_;
  const traces::MemoryImage image_;
  const std::vector<std::uint32_t> parents_;
  const traces::BvhTracer tracer_;
  std::optional<traces::TreeBuilds> builds_;
};

/// Small frames that several tests share.
const Frame& cornell_64x32();
const Frame& teapot_64x32();

/// Results of simulating a frame on a machine.
struct Outcome {
  std::vector<sim::UnitReport> units;
  std::vector<KernelUse> kernels;
  tools::RenderResult function;
  sim::Time elapsed = 0;
  std::uint64_t cycles = 0;

  std::uint64_t rays() const;
  bool has_unit(std::string_view path) const;
  /// Returns a counter summed over the units whose path begins with `at` and ends with `kind` and digits, e.g. "core1"
  /// and "trv".
  std::uint64_t sum(std::string_view at, std::string_view kind, std::string_view counter) const;
  std::uint64_t sum(std::string_view kind, std::string_view counter) const { return sum("", kind, counter); }
};

enum class Engine : std::uint8_t {
  kFast,      ///< skips idle time
  kOracle,    ///< ticks units at every clock edge, as the reference
  kShuffled,  ///< skips idle time and ticks the units of a cycle in random order
};

/// Simulates a machine until it is done. `seed`: for Engine::kShuffled.
Outcome run_machine(Gpu& gpu, Engine engine, std::uint64_t seed = 0);

/// Simulates a frame on a machine. `workers`: number of threads of the front end; `seed`: for Engine::kShuffled.
Outcome play(const Frame& frame, const GpuConfig& config, Engine engine = Engine::kFast, std::uint64_t seed = 0,
             std::uint32_t workers = 0);

/// Simulates a frame on a machine and records counters over time in `intervals`.
Outcome play(const Frame& frame, const GpuConfig& config, sim::Intervals& intervals, Engine engine = Engine::kFast,
             std::uint64_t seed = 0, std::uint32_t workers = 0);

Outcome play(const Method& method, const GpuConfig& config, Engine engine = Engine::kFast, std::uint64_t seed = 0,
             std::uint32_t workers = 0);

/// Simulates prepared tiles whose rays are in the frame's scene. Functional results such as the picture stay empty.
Outcome play(const Frame& frame, std::span<const traces::TileWork> tiles, const GpuConfig& config,
             Engine engine = Engine::kFast, std::uint64_t seed = 0);

/// Simulates the tiles of a source on a machine with small random timing perturbations.
Outcome play(const Frame& frame, TileSource& tiles, const GpuConfig& config, const Perturbation& perturbation,
             Engine engine = Engine::kFast, std::uint64_t seed = 0);

/// Returns the first counter that differs between two runs, "core0.srp.rays: 12, 13"; empty if all are equal.
std::string difference(const Outcome& a, const Outcome& b);
/// Returns the first difference in functional results: picture, rays by kind, traversal steps; empty if all are equal.
std::string difference(const tools::RenderResult& a, const tools::RenderResult& b);

}  // namespace hw::test
