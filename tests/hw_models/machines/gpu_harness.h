#pragma once
#include <cstdint>
#include <memory>
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

/// A scene, a camera and a frame program, without a machine. Not movable, because the program refers to the image.
class Frame {
 public:
  /// `tile`: side of a tile in samples.
  Frame(const std::string& scene, std::uint32_t width, std::uint32_t height, std::uint32_t samples = 1,
        std::uint32_t tile = 16, const traces::BvhConfig& bvh = {});
  Frame(traces::Scene&& scene, std::uint32_t width, std::uint32_t height, std::uint32_t samples = 1,
        std::uint32_t tile = 16, const traces::BvhConfig& bvh = {});
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;

  kernels::FullProgram& program() const { return program_; }
  const traces::Tracer& tracer() const { return tracer_; }
  Gpu::Workload workload() const;
  /// Returns the work of every tile, for repeated runs.
  std::vector<traces::TileWork> record() const;
  /// Returns the lines of the frame buffer that the tiles of the picture fill.
  std::uint64_t picture_lines() const { return picture_lines_; }

 private:
  const traces::Camera camera_;
  const traces::MemoryImage image_;
  const std::vector<std::uint32_t> parents_;
  mutable kernels::FullProgram program_;  ///< keeps the last picture
  const traces::BvhTracer tracer_;
  const std::uint64_t picture_lines_;
};

/// The same for any frame program, by name. Each run constructs the program again, since some keep state between
/// frames.
class Method {
 public:
  Method(const std::string& scene, const std::string& program, const kernels::ProgramConfig& programs,
         std::uint32_t width, std::uint32_t height, std::uint32_t tile, const traces::BvhConfig& bvh = {});
  Method(const traces::Scene& scene, const std::string& program, const kernels::ProgramConfig& programs,
         const kernels::RenderConfig& render, const traces::BvhConfig& bvh = {});
  Method(const Method&) = delete;
  Method& operator=(const Method&) = delete;

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
};

/// Small pictures that several tests share.
const Frame& cornell_64x32();
const Frame& teapot_64x32();

/// Results of a run on a machine.
struct Outcome {
  std::vector<sim::UnitReport> units;
  std::vector<KernelUse> kernels;
  tools::RenderResult function;
  sim::Time elapsed = 0;
  std::uint64_t cycles = 0;

  std::uint64_t rays() const;
  /// Returns a counter summed over the units whose path begins with `at` and ends with `kind` and digits: ("core1",
  /// "trv").
  std::uint64_t sum(std::string_view at, std::string_view kind, std::string_view counter) const;
  std::uint64_t sum(std::string_view kind, std::string_view counter) const { return sum("", kind, counter); }
};

enum class Engine : std::uint8_t {
  kFast,      ///< skips idle time
  kOracle,    ///< visits every clock edge
  kShuffled,  ///< skips, and visits the units of each cycle in random order
};

/// Runs a machine from its first cycle to its last.
Outcome run_machine(Gpu& gpu, Engine engine, std::uint64_t seed = 0);

/// Runs the frame on a machine, with `workers` threads in the front end.
Outcome play(const Frame& frame, const GpuConfig& config, Engine engine = Engine::kFast, std::uint64_t seed = 0,
             std::uint32_t workers = 0);

/// The same, and records intervals.
Outcome play(const Frame& frame, const GpuConfig& config, sim::Intervals& intervals, Engine engine = Engine::kFast,
             std::uint64_t seed = 0, std::uint32_t workers = 0);

Outcome play(const Method& method, const GpuConfig& config, Engine engine = Engine::kFast, std::uint64_t seed = 0,
             std::uint32_t workers = 0);

/// Runs prepared tiles, which trace rays in the frame's scene. The functional results stay empty.
Outcome play(const Frame& frame, std::span<const traces::TileWork> tiles, const GpuConfig& config,
             Engine engine = Engine::kFast, std::uint64_t seed = 0);

/// Runs the tiles of a source on a perturbed machine.
Outcome play(const Frame& frame, TileSource& tiles, const GpuConfig& config, const Perturbation& perturbation,
             Engine engine = Engine::kFast, std::uint64_t seed = 0);

/// Returns the first counter in which two runs differ ("core0.srp.rays: 12, 13"); empty if all are equal.
std::string difference(const Outcome& a, const Outcome& b);
/// The same for the functional results: picture, rays by kind, traversal steps.
std::string difference(const tools::RenderResult& a, const tools::RenderResult& b);

}  // namespace hw::test
