#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/machines/ray_machine.h"
#include "hw_models/tni/tni_core.h"
#include "sim/engine.h"
#include "sim/report/energy.h"
#include "tools/analysis/units.h"
#include "tools/run/frame/run_job.h"
#include "tools/studies/microbench/benchmark.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/walk.h"

namespace tools {
namespace {

/// A leaf that a ray visits: its first triangle, and for each triangle the phase in which its test ends.
struct Leaf {
  std::uint32_t first = 0;
  std::vector<traces::ExitPhase> exits;
};

/// A ray that visits `visits` nodes with one hit child each, so that it never pushes to its stack. Then it visits
/// `leaf`, if that has triangle tests.
struct StraightRay {
  std::uint32_t visits = 1;
  Leaf leaf;

  std::vector<std::uint32_t> walk_steps() const {
    std::vector<std::uint32_t> steps;
    for (std::uint32_t i = 0; i < visits; ++i) {
      const bool last = i + 1 == visits;
      steps.push_back(traces::visit_step(i, last && leaf.exits.empty() ? 0 : 1, 0));
    }
    if (!leaf.exits.empty()) {
      std::uint32_t phases = 0;
      for (std::size_t i = 0; i < leaf.exits.size(); ++i) phases |= static_cast<std::uint32_t>(leaf.exits[i]) << 4 * i;
      steps.push_back(traces::leaf_step(leaf.first, static_cast<std::uint32_t>(leaf.exits.size())));
      steps.push_back(phases);
    }
    steps.push_back(traces::end_step(!leaf.exits.empty()));
    return steps;
  }
};

/// Formulas, in cycles, for latencies and rates of a T&I unit whose accesses all hit in its L1 caches.
class TniForms {
 public:
  TniForms(const hw::GpuConfig& config, std::uint32_t triangle_bytes)
      : tni_(config.tni), direct_(config.direct_interface), triangle_bytes_(triangle_bytes) {}

  /// Returns the intersection pipeline's stage after which a triangle test with exit phase `exit` has its result.
  std::uint32_t exit_stage(traces::ExitPhase exit) const {
    switch (exit) {
      case traces::ExitPhase::kDistance:
        return tni_.ist.distance_stage;
      case traces::ExitPhase::kBarycentric:
        return tni_.ist.barycentric_stage;
      case traces::ExitPhase::kHit:
        break;
    }
    return tni_.ist.latency;
  }
  /// Returns the cycles to read the first `triangles` triangles of a leaf, at one cache line per cycle. A line shared
  /// by two triangles is read twice.
  std::uint32_t lines_read(const Leaf& leaf, std::uint32_t triangles) const {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < triangles; ++i) {
      const std::uint64_t begin = std::uint64_t{leaf.first + i} * triangle_bytes_;
      count += begin / 64 == (begin + triangle_bytes_ - 1) / 64 ? 1 : 2;
    }
    return count;
  }
  std::uint32_t lines_read(const Leaf& leaf) const {
    return lines_read(leaf, static_cast<std::uint32_t>(leaf.exits.size()));
  }
  /// Returns the latency of a single leaf in an idle intersection unit, from its arrival to its answer.
  std::uint32_t lone_leaf_latency(const Leaf& leaf) const {
    std::uint32_t known = 0;
    for (std::uint32_t i = 0; i < leaf.exits.size(); ++i)
      known = std::max(known, lines_read(leaf, i + 1) - 1 + tni_.ist.l1.hit_cycles + exit_stage(leaf.exits[i]));
    return known;
  }
  /// Returns the latency of a single ray in an idle T&I unit, from its arrival at a traversal unit to its end.
  std::uint32_t lone_ray_latency(const StraightRay& ray) const {
    const std::uint32_t pass = tni_.trv.l1.hit_cycles + tni_.trv.box_latency;
    const std::uint32_t to_ist_and_back = tni_.trv.leaf_latency + lone_leaf_latency(ray.leaf) + 1;
    return box_passes(ray) * pass + (ray.leaf.exits.empty() ? 0 : to_ist_and_back);
  }

  /// Returns the throughput of a busy intersection unit, in leaves per cycle. Round robin makes all leaves in the unit
  /// end in the same round. If a round is shorter than the rest of the pipeline, the unit idles until the first leaf
  /// ends.
  UpperBound leaves_per_cycle(const Leaf& leaf) const {
    const std::uint32_t round = tni_.ist.leaves, rest = lone_leaf_latency(leaf) - lines_read(leaf) + 2;
    const std::uint32_t idle = rest > round ? rest - round : 0;
    return {double(round) / (round * lines_read(leaf) + idle), idle == 0 ? "intersection" : "leaves inside"};
  }
  /// Returns the upper bound of the throughput of the whole T&I unit, in rays per cycle.
  UpperBound rays_per_cycle(const StraightRay& ray) const {
    const auto tests = static_cast<std::uint32_t>(ray.leaf.exits.size());
    // One box tester: boxes and leaves share a pipe. Two: the box pipe and the leaf pipe work in parallel.
    const std::uint32_t busy = tni_.trv.box_testers == 1 ? box_passes(ray) + tests : std::max(box_passes(ray), tests);
    // A ray slot is occupied from dispatch to collection, which adds a cycle of wire in each direction.
    const std::uint32_t taken = lone_ray_latency(ray) + 2;
    std::vector<UpperBound> bounds = {{double(tni_.trvs) / busy, "traversal"},
                                      {double(tni_.trvs) * tni_.trv.rays / taken, "rays inside", false},
                                      {1.0 / direct_.interval, "interface"},
                                      {direct_.depth / 2.0, "interface"},
                                      {1, "dispatcher"}};
    if (tests != 0) {
      bounds.push_back({1.0 / lines_read(ray.leaf), "intersection"});
      bounds.push_back({double(tni_.ist.leaves) / (lone_leaf_latency(ray.leaf) + 1), "leaves inside", false});
    }
    return tightest_bound(bounds);
  }

 private:
  std::uint32_t box_passes(const StraightRay& ray) const { return ray.visits * (tni_.trv.box_testers == 1 ? 2 : 1); }

  const hw::TniConfig tni_;
  const hw::DirectInterfaceConfig direct_;
  const std::uint32_t triangle_bytes_;
};

constexpr std::uint32_t kRays = 12'000;

/// Source of identical rays for the T&I unit under test. Records the times at which their results arrive.
struct EqualRays {
  std::vector<std::uint32_t> steps;
  std::vector<sim::Time> hits{};
  std::uint32_t ray_count() const { return kRays; }
  const std::uint32_t* ray_walk(std::uint32_t) const { return steps.data(); }
  std::uint32_t ray_key(std::uint32_t) const { return 0; }
  void record_return_time(std::uint32_t, sim::Time now) { hits.push_back(now); }
};

/// Test harness for a T&I unit whose caches always hit: sends identical rays and receives their results.
class TniHarness {
 public:
  TniHarness(const hw::GpuConfig& config, std::uint32_t triangle_bytes, const StraightRay& ray)
      : clock_(config.clocks.tni.clock()), equal_{ray.walk_steps()} {
    const sim::UnitId source = machine_.unit({"rays", clock_});
    hw::TniCore tni(machine_, config.tni, {.l1 = true}, 0, clock_);
    std::vector<hw::MemoryPort> memory;  // required by the unit but not used, as caches always hit
    for (const hw::MemoryClient& client : tni.memory_clients()) {
      memory.push_back({machine_.link<hw::MemRequest>(1, 1, client.unit, client.unit),
                        machine_.link<hw::MemResponse>(1, 1, client.unit, client.unit)});
    }
    source_ = &hw::build_source_and_tni(machine_, config.direct_interface, source, equal_, tni,
                                        {{}, {0, triangle_bytes}}, memory);
  }

  /// Simulates the T&I unit under test and returns its rays per cycle, without the start and end of the run.
  double rays_per_cycle() {
    sim::run(*this);
    return steady_rate(equal_.hits) * static_cast<double>(clock_.period()) /
           static_cast<double>(sim::kFemtosecondsPerSecond);
  }

  // Called by the engine.
  sim::Machine& machine() { return machine_; }
  bool done() const { return source_->is_done(); }

 private:
  const sim::Clock clock_;
  EqualRays equal_;
  sim::Machine machine_;
  hw::RaySource<EqualRays>* source_ = nullptr;
};

Findings measure_rays(const RunConfig& machine) {
  using enum traces::ExitPhase;
  hw::GpuConfig config = *machine.gpu;
  config.tni.trv.prefetch = hw::Prefetch::kNone;
  Findings found{"rays through one T&I unit", {}};
  const StraightRay misses{.visits = 4, .leaf = {}}, hits{.visits = 16, .leaf = {0, {kDistance, kHit}}};
  for (const std::uint32_t testers : {2U, 1U}) {
    for (const StraightRay& ray : {hits, misses}) {
      for (const std::uint32_t trvs : {1U, 2U, 4U, 8U}) {
        config.tni.trvs = trvs;
        config.tni.trv.box_testers = testers;
        const UpperBound bound = TniForms(config, machine.bvh.triangle_bytes).rays_per_cycle(ray);
        found.measurements.push_back(
            {fmt::format("{} TRV{}, {} box tester{}, {} nodes{}", trvs, trvs == 1 ? "" : "s", testers,
                         testers == 1 ? "" : "s", ray.visits, ray.leaf.exits.empty() ? "" : " and 2 triangles"),
             "rays/cycle", TniHarness(config, machine.bvh.triangle_bytes, ray).rays_per_cycle(), bound.value,
             bound.required_relation(), std::string(bound.by)});
      }
    }
  }
  return found;
}

}  // namespace

Benchmark rays_benchmark() {
  return {"rays",
          "Rays per cycle of one T&I unit with 1, 2, 4 and 8 traversal units, all lines in its caches",
          "Equal rays that go straight down a tree. Possible bottlenecks: traversal pipes, rays or leaves in flight,\n"
          "triangle lines of the intersection unit, the direct interface.\n"
          "\n"
          "Example: raywatt microbench rays --set tni.trv.rays=16",
          {json_option()},
          [](const BenchmarkJob& job) { return measure_rays(non_ideal_machine(job.machine)); }};
}

namespace {

using traces::ExitPhase;

constexpr std::uint32_t kLeaves = 4000;
constexpr std::array kExits = {ExitPhase::kDistance, ExitPhase::kBarycentric, ExitPhase::kHit};
constexpr std::array kExitNames = {"distance", "barycentric", "hit"};

/// Test harness for an intersection unit whose cache always hits: a source sends identical leaves.
class IstHarness {
 public:
  IstHarness(const RunConfig& config, const Leaf& leaf, std::uint32_t leaves)
      : clock_(config.gpu->clocks.tni.clock()),
        source_id_(machine_.unit({"leaves", clock_})),
        ist_id_(hw::declare_ist(machine_, config.gpu->tni, 0, clock_)),
        jobs_(machine_.link<hw::LeafJob>(2, 1, source_id_, ist_id_)),
        answers_(machine_.link<hw::LeafDone>(64, 1, ist_id_, source_id_)),
        source_(machine_.build<Source>(source_id_, *this, leaf, leaves)) {
    const hw::Ist::Links links{{&jobs_},
                               {&answers_},
                               machine_.link<hw::MemRequest>(1, 1, ist_id_, ist_id_),
                               machine_.link<hw::MemResponse>(1, 1, ist_id_, ist_id_)};
    machine_.build<hw::Ist>(ist_id_, config.gpu->tni.ist, hw::TniMode{.rau = {}, .ideal_l1 = true},
                            hw::TrianglesInMemory{0, config.bvh.triangle_bytes}, links, std::uint16_t{0}, clock_);
    machine_.finish(clock_.edge_after(sim::run(*this), 1));
  }

  const std::vector<sim::Time>& answer_times() const { return source_.answered; }
  const sim::Clock& clock() const { return clock_; }
  sim::UnitReport unit_report() const { return machine_.report().front(); }

  // Called by the engine.
  sim::Machine& machine() { return machine_; }
  bool done() const { return source_.answered.size() == source_.leaves; }

 private:
  struct Source {
    Source(IstHarness& s, const Leaf& leaf, std::uint32_t n) : harness(s), leaves(n) {
      job.first = leaf.first;
      job.count = static_cast<std::uint8_t>(leaf.exits.size());
      for (std::size_t i = 0; i < leaf.exits.size(); ++i)
        job.phases |= static_cast<std::uint32_t>(leaf.exits[i]) << 4 * i;
    }
    const sim::Clock& clock() const { return harness.clock_; }
    sim::Time tick(sim::Time now) {
      if (harness.answers_.can_pop(now)) {
        harness.answers_.pop(now);
        answered.push_back(now);
      }
      if (sent < leaves && harness.jobs_.can_push(now)) {
        harness.jobs_.push(now, job);
        sent += 1;
      }
      const sim::Time next = harness.clock_.edge_after(now, 1);
      const sim::Time send = sent < leaves ? std::max(next, harness.jobs_.push_at()) : sim::kNever;
      return std::min(send, std::max(next, harness.answers_.pop_at()));
    }
    IstHarness& harness;
    const std::uint32_t leaves;
    hw::LeafJob job;
    std::uint32_t sent = 0;
    std::vector<sim::Time> answered;
  };

  const sim::Clock clock_;
  sim::Machine machine_;
  const sim::UnitId source_id_, ist_id_;
  sim::Link<hw::LeafJob>& jobs_;
  sim::Link<hw::LeafDone>& answers_;
  Source& source_;
};

/// Returns the energy of all counted events of a unit, in pJ.
double counted_pj(const sim::UnitReport& unit, const sim::EnergyTable& table) {
  double pj = 0;
  for (const sim::CounterReport& counter : unit.counters) {
    if (!counter.event.empty())
      pj += static_cast<double>(counter.value) * table.energy_of(counter.event, unit.cache_bytes).nominal;
  }
  return pj;
}

/// Returns the expected energy in pJ of testing a leaf with one triangle: buffer, cache line, test phases, answer.
double leaf_pj(ExitPhase exit, std::uint64_t cache_bytes, const sim::EnergyTable& table) {
  double pj = 0;
  for (const char* event :
       {"tni.ray_buffer_write", "tni.ray_buffer_read", "cache.l1_read", "tni.tri_phase1", "tni.hit_route"}) {
    pj += table.energy_of(event, cache_bytes).nominal;
  }
  if (exit != ExitPhase::kDistance) pj += table.energy_of("tni.tri_phase2", cache_bytes).nominal;
  if (exit == ExitPhase::kHit) pj += table.energy_of("tni.tri_phase3", cache_bytes).nominal;
  return pj;
}

void add_exit_measurements(const RunConfig& config, Findings& found) {
  const TniForms forms(*config.gpu, config.bvh.triangle_bytes);
  const sim::EnergyTable table(config.energy.events);
  for (std::size_t i = 0; i < kExits.size(); ++i) {
    const Leaf one{0, {kExits[i]}}, four{0, {4, kExits[i]}};
    const auto name = [&](const char* what) { return fmt::format("{}, exit: {}", what, kExitNames[i]); };

    const IstHarness lone(config, one, 1);
    // the measured time includes two cycles of wire
    const auto cycles = static_cast<double>(lone.clock().cycles(lone.answer_times().front()));
    found.measurements.push_back({name("a lone test"), "cycles", cycles - 2, double(forms.lone_leaf_latency(one))});

    const IstHarness full(config, four, kLeaves);
    const double leaves = steady_rate(full.answer_times()) * static_cast<double>(full.clock().period()) /
                          static_cast<double>(sim::kFemtosecondsPerSecond);
    const UpperBound bound = forms.leaves_per_cycle(four);
    found.measurements.push_back({name("leaves of 4 tests"), "tests/cycle", 4 * leaves, 4 * bound.value,
                                  bound.required_relation(), std::string(bound.by)});

    const sim::UnitReport unit = IstHarness(config, one, kLeaves).unit_report();
    found.measurements.push_back({name("energy of a test"), "pJ", counted_pj(unit, table) / kLeaves,
                                  leaf_pj(kExits[i], unit.cache_bytes, table)});
  }
}

/// Number of triangle tests that ended in each of the phases kExits.
using Exits = std::array<std::uint64_t, 3>;

/// Counts triangle tests by exit phase from the performance counters of all intersection units.
Exits exits_from_counters(const std::vector<sim::UnitReport>& units) {
  using Stats = hw::Ist::Stats;
  const Units<hw::Ist> ists(units);
  const std::uint64_t edge_tests = ists.sum_of(&Stats::edge_tests), hits = ists.sum_of(&Stats::hits);
  return {ists.sum_of(&Stats::tests) - edge_tests, edge_tests - hits, hits};
}

/// Counts triangle tests by exit phase from the recorded traversals of all rays of a frame program.
Exits exits_from_traversals(const Inputs& inputs, const kernels::ProgramSpec& spec) {
  const kernels::RateMap rates(inputs.config.programs.multirate);
  const auto program = kernels::make_program(spec, {inputs.image, inputs.camera, inputs.config.render,
                                                    inputs.config.programs, rates, inputs.frame, inputs.scene_size});
  const traces::BvhTracer tracer(inputs.image);
  FrontEnd front_end(*program, tracer, 0);
  Exits exits{};
  while (const traces::TileWork* work = front_end.next()) {
    for (std::size_t at = 0; at < work->walk.size(); ++at) {
      const std::uint32_t word = work->walk[at];
      if (traces::kind_of(word) != traces::StepKind::kLeaf || traces::is_enter(word)) continue;
      const std::uint32_t tests = traces::count_of(word);
      at += 1;
      for (std::uint32_t test = 0; test < tests; ++test)
        exits[static_cast<std::size_t>(traces::phase_of(work->walk[at], test)) - 1] += 1;
    }
    front_end.release_work(work);
  }
  return exits;
}

/// Measures early exits of triangle tests in a scene. Adds their number and the cycles and energy that they save to
/// `found`.
void add_scene_measurements(const JobOptions& job, Findings& found) {
  const Inputs inputs = load_inputs(job);
  const kernels::ProgramSpec spec = kernels::parse_program(job.program);
  const Exits measured = exits_from_counters(simulate_frame(inputs, spec, 1).units),
              expected = exits_from_traversals(inputs, spec);
  const std::string name =
      fmt::format("{}, {}x{}", inputs.scene.name, inputs.config.render.width, inputs.config.render.height);
  const auto tests = static_cast<double>(expected[0] + expected[1] + expected[2]);
  const TniForms forms(*inputs.config.gpu, inputs.config.bvh.triangle_bytes);
  const sim::EnergyTable table(inputs.config.energy.events);
  const std::uint64_t cache = inputs.config.gpu->tni.ist.l1.size.bytes;
  double cycles = 0, pj = 0;
  for (std::size_t i = 0; i < kExits.size(); ++i) {
    const auto n = static_cast<double>(expected[i]);
    found.measurements.push_back({fmt::format("{}, exit: {}", name, kExitNames[i]), "tests",
                                  static_cast<double>(measured[i]), n, Measurement::Relation::kExactly,
                                  fmt::format("{:.1f} %", tests == 0 ? 0 : 100 * n / tests)});
    cycles += n * forms.lone_leaf_latency({0, {kExits[i]}});
    pj += n * leaf_pj(kExits[i], cache, table);
  }
  if (tests == 0) return;
  found.notes.push_back(
      fmt::format("{}: a single test of this mix takes {:.1f} cycles and {:.1f} pJ; without early exits {} and {:.1f}.",
                  name, cycles / tests, pj / tests, forms.lone_leaf_latency({0, {ExitPhase::kHit}}),
                  leaf_pj(ExitPhase::kHit, cache, table)));
}

}  // namespace

Benchmark early_exit_benchmark() {
  return {
      "early_exit",
      "Cycles and energy of a triangle test by the phase that ends it, and the number of tests of a scene by phase",
      "Tests are measured on an intersection unit alone, with all lines in its cache. Energies are nominal, without\n"
      "leakage and clock. For the scene, the counters of the machine are compared with the recorded rays.\n"
      "\n"
      "Example: raywatt microbench early_exit --scene teapot",
      {json_option(),
       {"--scene", "built-in scene, workload (.yaml), or .gltf or .glb file (default: cornell)", &BenchmarkJob::scene},
       {"--resolution", "WIDTHxHEIGHT of the picture", &BenchmarkJob::resolution, true}},
      [](const BenchmarkJob& benchmark) {
        JobOptions job = benchmark.machine;
        job.scene = benchmark.scene;
        job.resolution = benchmark.resolution;
        Findings found{"intersection unit", {}};
        add_exit_measurements(non_ideal_machine(job), found);
        add_scene_measurements(job, found);
        return found;
      }};
}

}  // namespace tools
