#include "tests/hw_models/machines/gpu_harness.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/engine.h"
#include "traces/accel/build.h"
#include "traces/scenes/library.h"

namespace hw::test {

namespace {

kernels::RenderConfig render_config(std::uint32_t width, std::uint32_t height, std::uint32_t tile) {
  kernels::RenderConfig config;
  config.width = width;
  config.height = height;
  config.tile = tile;
  config.fusion = kernels::Fusion::kOff;  // the list in monotone.cc is for frames with separate launches
  return config;
}

/// Every pixel is written once, and each tile starts at a new line.
std::uint64_t lines_of_picture(const kernels::FullProgram& program, std::uint32_t width, std::uint32_t height) {
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(program.tile_pixels())));
  std::uint64_t lines = 0;
  for (std::uint32_t y = 0; y < height; y += side) {
    for (std::uint32_t x = 0; x < width; x += side) {
      lines += (std::min(side, width - x) * std::min(side, height - y) * kernels::kPixelBytes + 63) / 64;
    }
  }
  return lines;
}

class Tiles final : public TileSource {
 public:
  explicit Tiles(std::span<const traces::TileWork> works) : works_(works) {}
  const traces::TileWork* next() override { return next_ == works_.size() ? nullptr : &works_[next_++]; }
  void release_work(const traces::TileWork*) override {}

 private:
  std::span<const traces::TileWork> works_;
  std::size_t next_ = 0;
};

/// True for "core0.tni.trv2" and kind "trv".
bool is_kind(std::string_view path, std::string_view kind) {
  path.remove_suffix(path.size() - 1 - path.find_last_not_of("0123456789"));
  return path.ends_with(kind) && (path.size() == kind.size() || path[path.size() - kind.size() - 1] == '.');
}

}  // namespace

Outcome run_machine(Gpu& gpu, Engine engine, std::uint64_t seed) {
  switch (engine) {
    case Engine::kFast:
      gpu.finish(sim::run<sim::Skip::kOn>(gpu));
      break;
    case Engine::kOracle:
      gpu.finish(sim::run<sim::Skip::kOff>(gpu));
      break;
    case Engine::kShuffled:
      gpu.finish(sim::run_shuffled(gpu, seed));
      break;
  }
  return {gpu.unit_reports(), gpu.kernel_use(), {}, gpu.elapsed_time(), gpu.elapsed_cycles()};
}

Frame::Frame(const std::string& scene, std::uint32_t width, std::uint32_t height, std::uint32_t samples,
             std::uint32_t tile, const traces::BvhConfig& bvh)
    : Frame(traces::open_scene(scene), width, height, samples, tile, bvh) {}

Frame::Frame(traces::Scene&& scene, std::uint32_t width, std::uint32_t height, std::uint32_t samples,
             std::uint32_t tile, const traces::BvhConfig& bvh)
    : camera_(scene.cameras.front()),
      image_(traces::build_memory_image(scene, bvh, 1)),
      parents_(traces::parent_indices(image_)),
      program_(image_, camera_, render_config(width, height, tile), samples, 0),
      tracer_(image_),
      picture_lines_(lines_of_picture(program_, width, height)) {}

Gpu::Workload Frame::workload() const {
  const std::uint64_t picture_bytes = std::uint64_t{program_.tiles()} * program_.tile_pixels() * kernels::kPixelBytes;
  return {image_, parents_, {.tile_samples = program_.tile_samples(), .region_bytes = {picture_bytes}}};
}

std::vector<traces::TileWork> Frame::record() const {
  std::vector<traces::TileWork> works;
  kernels::TileResult tile;
  for (std::uint32_t t = 0; t < program_.tiles(); ++t) {
    program_.run_tile(t, tracer_, true, tile);
    works.push_back(tile.work);
  }
  return works;
}

Method::Method(const std::string& scene, const std::string& program, const kernels::ProgramConfig& programs,
               std::uint32_t width, std::uint32_t height, std::uint32_t tile, const traces::BvhConfig& bvh)
    : Method(traces::open_scene(scene), program, programs, render_config(width, height, tile), bvh) {}

Method::Method(const traces::Scene& scene, const std::string& program, const kernels::ProgramConfig& programs,
               const kernels::RenderConfig& render, const traces::BvhConfig& bvh,
               const traces::PredictorConfig& predictor)
    : spec_(kernels::parse_program(program)),
      programs_(programs),
      render_(render),
      rates_(programs.multirate),
      camera_(scene.cameras.front()),
      image_(traces::build_memory_image(scene, bvh, 1, nullptr, render.mip_maps)),
      parents_(traces::parent_indices(image_)),
      tracer_(image_, predictor) {}

std::unique_ptr<kernels::FrameProgram> Method::make() const {
  return kernels::make_program(spec_,
                               {image_, camera_, render_, programs_, rates_, 0, 1, builds_ ? &*builds_ : nullptr});
}

Method& Method::build_trees(bool refit, bool overlap, traces::BuildEngine engine) {
  builds_ = traces::tree_builds(image_, refit, overlap);
  builds_->engine = engine;
  return *this;
}

Method& Method::pose(const traces::PoseWork& work) {
  builds_->pose = work;
  return *this;
}

Gpu::Workload Method::workload() const {
  return {image_, parents_, make()->requirements(), render_.srgb == kernels::SrgbEncoder::kDma};
}

const Frame& cornell_64x32() {
  static const Frame frame("cornell", 64, 32);
  return frame;
}

const Frame& teapot_64x32() {
  static const Frame frame("teapot", 64, 32);
  return frame;
}

std::uint64_t Outcome::rays() const {
  return std::accumulate(std::begin(function.rays), std::end(function.rays), std::uint64_t{0});
}

bool Outcome::has_unit(std::string_view path) const {
  return std::ranges::find(units, path, &sim::UnitReport::path) != units.end();
}

std::uint64_t Outcome::sum(std::string_view at, std::string_view kind, std::string_view counter) const {
  std::uint64_t total = 0;
  bool found = false;
  for (const sim::UnitReport& unit : units) {
    if (!unit.path.starts_with(at) || !is_kind(unit.path, kind)) continue;
    for (const sim::CounterReport& c : unit.counters) {
      if (c.name != counter) continue;
      total += c.value;
      found = true;
    }
  }
  if (!found) throw std::logic_error(fmt::format("no unit '{}...{}' has a counter '{}'", at, kind, counter));
  return total;
}

Outcome play(const Frame& frame, const GpuConfig& config, Engine engine, std::uint64_t seed, std::uint32_t workers) {
  tools::FrontEnd front_end(frame.program(), frame.tracer(), workers);
  const auto gpu = std::make_unique<Gpu>(config, frame.workload(), front_end);
  Outcome outcome = run_machine(*gpu, engine, seed);
  outcome.function = front_end.result();
  return outcome;
}

Outcome play(const Frame& frame, const GpuConfig& config, sim::Intervals& intervals, Engine engine, std::uint64_t seed,
             std::uint32_t workers) {
  tools::FrontEnd front_end(frame.program(), frame.tracer(), workers);
  const auto gpu = std::make_unique<Gpu>(config, frame.workload(), front_end);
  gpu->machine().record_intervals(intervals);
  Outcome outcome = run_machine(*gpu, engine, seed);
  outcome.function = front_end.result();
  return outcome;
}

Outcome play(const Method& method, const GpuConfig& config, Engine engine, std::uint64_t seed, std::uint32_t workers) {
  const std::unique_ptr<kernels::FrameProgram> program = method.make();
  tools::FrontEnd front_end(*program, method.tracer(), workers);
  const auto gpu = std::make_unique<Gpu>(config, method.workload(), front_end);
  Outcome outcome = run_machine(*gpu, engine, seed);
  outcome.function = front_end.result();
  return outcome;
}

Outcome play(const Frame& frame, std::span<const traces::TileWork> tiles, const GpuConfig& config, Engine engine,
             std::uint64_t seed) {
  Tiles source(tiles);
  return play(frame, source, config, {}, engine, seed);
}

Outcome play(const Frame& frame, TileSource& tiles, const GpuConfig& config, const Perturbation& perturbation,
             Engine engine, std::uint64_t seed) {
  const auto gpu = std::make_unique<Gpu>(config, frame.workload(), tiles, perturbation);
  return run_machine(*gpu, engine, seed);
}

std::string difference(const Outcome& a, const Outcome& b) {
  std::string found;
  const auto compare = [&](const std::string& name, std::uint64_t x, std::uint64_t y) {
    if (found.empty() && x != y) found = fmt::format("{}: {}, {}", name, x, y);
  };
  compare("elapsed", a.elapsed, b.elapsed);
  compare("cycles", a.cycles, b.cycles);
  compare("units", a.units.size(), b.units.size());
  for (std::size_t u = 0; u < std::min(a.units.size(), b.units.size()); ++u) {
    const sim::UnitReport &x = a.units[u], &y = b.units[u];
    if (found.empty() && x.path != y.path) found = fmt::format("unit {}: {}, {}", u, x.path, y.path);
    compare(x.path + ".elapsed", x.elapsed, y.elapsed);
    for (std::size_t i = 0; i < x.counters.size(); ++i) {
      compare(x.path + "." + x.counters[i].name, x.counters[i].value, y.counters[i].value);
    }
    for (std::size_t i = 0; i < x.cycles_by_reason.size(); ++i) {
      compare(x.path + ".why." + x.cycles_by_reason[i].first, x.cycles_by_reason[i].second,
              y.cycles_by_reason[i].second);
    }
  }
  for (std::size_t k = 0; k < a.kernels.size(); ++k) {
    const std::string kernel = fmt::format("kernel {}.", k);
    compare(kernel + "launches", a.kernels[k].launches, b.kernels[k].launches);
    compare(kernel + "items", a.kernels[k].items, b.kernels[k].items);
    compare(kernel + "idle", a.kernels[k].idle, b.kernels[k].idle);
    compare(kernel + "cycles", a.kernels[k].cycles, b.kernels[k].cycles);
    compare(kernel + "starved", a.kernels[k].starved, b.kernels[k].starved);
  }
  return found;
}

std::string difference(const tools::RenderResult& a, const tools::RenderResult& b) {
  if (a.rgb != b.rgb) return "picture";
  if (!std::ranges::equal(a.rays, b.rays) || a.continued != b.continued) return "rays by kind";
  if (a.traversal_steps != b.traversal_steps) return "traversal steps";
  return {};
}

}  // namespace hw::test
