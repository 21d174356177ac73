#include <array>

#include <fmt/format.h>

#include "hw_models/tni/tni_core.h"
#include "sim/engine.h"
#include "sim/report/energy_table.h"
#include "tools/analysis/units.h"
#include "tools/run/frame/run_job.h"
#include "tools/studies/microbench/benchmark.h"
#include "tools/studies/microbench/tni_forms.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

using traces::ExitPhase;

constexpr std::uint32_t kLeaves = 4000;
constexpr std::array kExits = {ExitPhase::kDistance, ExitPhase::kBarycentric, ExitPhase::kHit};
constexpr std::array kExitNames = {"distance", "barycentric", "hit"};

/// An intersection unit with every line in its cache, and a traversal unit that sends it equal leaves.
class IstStand {
 public:
  IstStand(const RunConfig& config, const Leaf& leaf, std::uint32_t leaves)
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
    machine_.finish(clock_.after(sim::run(*this), 1));
  }

  const std::vector<sim::Time>& answered() const { return source_.answered; }
  const sim::Clock& clock() const { return clock_; }
  sim::UnitReport report() const { return machine_.report().front(); }

  // As the engine sees it.
  sim::Machine& machine() { return machine_; }
  bool done() const { return source_.answered.size() == source_.leaves; }

 private:
  struct Source {
    Source(IstStand& s, const Leaf& leaf, std::uint32_t n) : stand(s), leaves(n) {
      job.first = leaf.first;
      job.count = static_cast<std::uint8_t>(leaf.exits.size());
      for (std::size_t i = 0; i < leaf.exits.size(); ++i)
        job.phases |= static_cast<std::uint32_t>(leaf.exits[i]) << 4 * i;
    }
    const sim::Clock& clock() const { return stand.clock_; }
    sim::Time tick(sim::Time now) {
      if (stand.answers_.can_pop(now)) {
        stand.answers_.pop(now);
        answered.push_back(now);
      }
      if (sent < leaves && stand.jobs_.can_push(now)) {
        stand.jobs_.push(now, job);
        sent += 1;
      }
      const sim::Time next = stand.clock_.after(now, 1);
      const sim::Time send = sent < leaves ? std::max(next, stand.jobs_.push_at()) : sim::kNever;
      return std::min(send, std::max(next, stand.answers_.pop_at()));
    }
    IstStand& stand;
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

/// pJ of all that a unit has counted.
double counted_pj(const sim::UnitReport& unit, const sim::EnergyTable& table) {
  double pj = 0;
  for (const sim::CounterReport& counter : unit.counters) {
    if (!counter.event.empty())
      pj += static_cast<double>(counter.value) * table.at(counter.event, unit.cache_bytes).nominal;
  }
  return pj;
}

/// A leaf of one triangle whose test ends there: into the buffer and out, a line, the phases, the answer's way.
double leaf_pj(ExitPhase exit, std::uint64_t cache_bytes, const sim::EnergyTable& table) {
  double pj = 0;
  for (const char* event :
       {"tni.ray_buffer_write", "tni.ray_buffer_read", "cache.l1_read", "tni.tri_phase1", "tni.hit_route"}) {
    pj += table.at(event, cache_bytes).nominal;
  }
  if (exit != ExitPhase::kDistance) pj += table.at("tni.tri_phase2", cache_bytes).nominal;
  if (exit == ExitPhase::kHit) pj += table.at("tni.tri_phase3", cache_bytes).nominal;
  return pj;
}

void add_exits(const RunConfig& config, Findings& found) {
  const TniForms forms(*config.gpu, config.bvh.triangle_bytes);
  const sim::EnergyTable table(config.energy.events);
  for (std::size_t i = 0; i < kExits.size(); ++i) {
    const Leaf one{0, {kExits[i]}}, four{0, {4, kExits[i]}};
    const auto name = [&](const char* what) { return fmt::format("{}, exit: {}", what, kExitNames[i]); };

    const IstStand lone(config, one, 1);
    const auto cycles = static_cast<double>(lone.clock().cycles(lone.answered().front()));  // two of them on wires
    found.figures.push_back({name("a lone test"), "cycles", cycles - 2, double(forms.leaf_time(one))});

    const IstStand full(config, four, kLeaves);
    const double leaves = steady_rate(full.answered()) * static_cast<double>(full.clock().period()) /
                          static_cast<double>(sim::kFemtosecondsPerSecond);
    const UpperBound bound = forms.leaves_per_cycle(four);
    found.figures.push_back(
        {name("leaves of 4 tests"), "tests/cycle", 4 * leaves, 4 * bound.value, bound.holds(), std::string(bound.by)});

    const sim::UnitReport unit = IstStand(config, one, kLeaves).report();
    found.figures.push_back({name("energy of a test"), "pJ", counted_pj(unit, table) / kLeaves,
                             leaf_pj(kExits[i], unit.cache_bytes, table)});
  }
}

/// How many tests ended at each of kExits.
using Exits = std::array<std::uint64_t, 3>;

/// By the counters of all intersection units.
Exits exits_of(const std::vector<sim::UnitReport>& units) {
  using Stats = hw::Ist::Stats;
  const Units<hw::Ist> ists(units);
  const std::uint64_t edge_tests = ists.counted(&Stats::edge_tests), hits = ists.counted(&Stats::hits);
  return {ists.counted(&Stats::tests) - edge_tests, edge_tests - hits, hits};
}

/// By what is recorded of each ray.
Exits exits_in_walks(const Inputs& inputs, const kernels::ProgramSpec& spec) {
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
    front_end.give_back(work);
  }
  return exits;
}

/// How often the rays of a scene leave early, and what that spares.
void add_scene(const JobOptions& job, Findings& found) {
  const Inputs inputs = load_inputs(job);
  const kernels::ProgramSpec spec = kernels::parse_program(job.program);
  const Exits measured = exits_of(simulate_frame(inputs, spec, 1).units), expected = exits_in_walks(inputs, spec);
  const std::string name =
      fmt::format("{}, {}x{}", inputs.scene.name, inputs.config.render.width, inputs.config.render.height);
  const auto tests = static_cast<double>(expected[0] + expected[1] + expected[2]);
  const TniForms forms(*inputs.config.gpu, inputs.config.bvh.triangle_bytes);
  const sim::EnergyTable table(inputs.config.energy.events);
  const std::uint64_t cache = inputs.config.gpu->tni.ist.l1.size.bytes;
  double cycles = 0, pj = 0;
  for (std::size_t i = 0; i < kExits.size(); ++i) {
    const auto n = static_cast<double>(expected[i]);
    found.figures.push_back({fmt::format("{}, exit: {}", name, kExitNames[i]), "tests",
                             static_cast<double>(measured[i]), n, Figure::Holds::kExactly,
                             fmt::format("{:.1f} %", tests == 0 ? 0 : 100 * n / tests)});
    cycles += n * forms.leaf_time({0, {kExits[i]}});
    pj += n * leaf_pj(kExits[i], cache, table);
  }
  if (tests == 0) return;
  found.notes.push_back(fmt::format(
      "{}: a lone test of this mix takes {:.1f} cycles and {:.1f} pJ; without early exits {} and {:.1f}.", name,
      cycles / tests, pj / tests, forms.leaf_time({0, {ExitPhase::kHit}}), leaf_pj(ExitPhase::kHit, cache, table)));
}

}  // namespace

Benchmark early_exit_benchmark() {
  return {
      "early_exit",
      "Cycles and energy of a triangle test by the phase that ends it, and how often rays of a scene end there",
      "Tests are measured on an intersection unit alone, with every line in its cache. Energies are nominal, without\n"
      "leakage and clock. Of the scene, what the machine counts beside a count of the recorded rays.\n"
      "\n"
      "Example: raywatt microbench early_exit --scene teapot",
      {json_option(),
       {"--scene", "built-in scene, workload (.yaml), or .gltf or .glb file (default: cornell)", &BenchmarkJob::scene},
       {"--resolution", "WIDTHxHEIGHT of its picture", &BenchmarkJob::resolution, true}},
      [](const BenchmarkJob& told) {
        JobOptions job = told.machine;
        job.scene = told.scene;
        job.resolution = told.resolution;
        Findings found{"intersection unit", {}};
        add_exits(real_machine(job), found);
        add_scene(job, found);
        return found;
      }};
}

}  // namespace tools
