#include "tools/sampling/sampled_run.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/engine.h"
#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "tools/analysis/report_paths.h"
#include "tools/analysis/units.h"
#include "tools/run/frame/run_tiles.h"

namespace tools {
namespace {

/// Returns the difference of two marks.
MeasuredPart between(const Mark& a, const Mark& b) {
  MeasuredPart part{b.time - a.time, b.units, b.kernels, {}};
  sim::subtract_reports(part.units, a.units);
  for (std::size_t k = 0; k < part.kernels.size(); ++k) part.kernels[k] -= a.kernels[k];
  return part;
}

/// Traits of the work in a part: counted by the machine where it does, else those of the tiles in flight, weighted by
/// the share of their time in the part.
TileTraits traits_of(const MeasuredPart& part, sim::Time begin, sim::Time end, const TimedTiles& tiles,
                     std::span<const TileTraits> traits, std::span<const hw::KernelSchedule> kernels) {
  TileTraits sum;
  for (const TimedTiles::Played& tile : tiles.played()) {
    const sim::Time from = std::max(tile.begin, begin), to = std::min(tile.end, end);
    if (from < to)
      sum.add(traits[tile.tile], static_cast<double>(to - from) / static_cast<double>(tile.end - tile.begin));
  }
  const Units<hw::Trv> trvs(part.units);
  sum.visits =
      static_cast<double>(trvs.counted(&hw::Trv::Stats::visits) - trvs.counted(&hw::Trv::Stats::restarted_visits));
  sum.tests = static_cast<double>(Units<hw::Ist>(part.units).counted(&hw::Ist::Stats::tests));
  sum.array = 0;
  for (std::size_t k = 0; k < kernels.size(); ++k)
    sum.array += static_cast<double>(part.kernels[k].items) * kernels[k].ii;
  return sum;
}

}  // namespace

SampledRun run_blocks(const Inputs& inputs, RunTiles& source, const kernels::FrameRequirements& requirements,
                      std::span<const TimedBlock> blocks, std::span<const TileTraits> traits) {
  std::vector<std::uint32_t> marked;
  for (const TimedBlock& block : blocks) {
    if (block.first != blocks.front().first) marked.push_back(block.first);
    if (marked.empty() || block.measured != marked.back()) marked.push_back(block.measured);
  }
  TimedTiles tiles(source, {blocks.begin(), blocks.end()}, std::move(marked));
  const auto gpu = std::make_unique<hw::Gpu>(*inputs.config.gpu,
                                             hw::Gpu::Workload{inputs.image, inputs.parents, requirements,
                                                               inputs.config.render.srgb == kernels::SrgbEncoder::kDma},
                                             tiles);
  tiles.connect(*gpu);
  source.played_by(*gpu);
  gpu->finish(sim::run(*gpu));
  tiles.finish();

  SampledRun run;
  run.units = gpu->report();
  run.kernels = gpu->kernels();
  run.elapsed = gpu->elapsed();
  run.cycle = gpu->elapsed() / gpu->cycles();
  run.timed = tiles.played().size();
  run.warmed = tiles.warmed();
  run.warming_seconds = tiles.warming_seconds();
  // A measured part ends at the dispatch of the next block; the last one ends with the run.
  const Mark finished{0, gpu->elapsed(), gpu->report(), gpu->kernel_use()};
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const bool is_last = i + 1 == blocks.size();
    const Mark &begin = tiles.at(blocks[i].measured), &end = is_last ? finished : tiles.at(blocks[i + 1].first);
    MeasuredPart part = between(begin, end);
    part.traits = traits_of(part, begin.time, end.time, tiles, traits, run.kernels);
    if (i == 0) {
      run.begin = std::move(part);
    } else if (is_last) {
      run.end = std::move(part);
    } else {
      run.parts.push_back(std::move(part));
    }
  }
  return run;
}

std::map<std::string, double> summed_counters(std::vector<sim::UnitReport> units) {
  for (sim::UnitReport& unit : units) {
    std::erase_if(unit.counters, [](const sim::CounterReport& c) { return c.kind == sim::CounterKind::kPeak; });
  }
  constexpr std::string_view kUnits = "units.";
  std::map<std::string, double> sums;
  for (const ReportNumber& number : unit_sums({{"units", sim::units_json(units)}})) {
    if (number.path.find(".counters.") != std::string::npos) sums[number.path.substr(kUnits.size())] = number.value;
  }
  return sums;
}

MeasuredPart weighted_sum(std::span<const MeasuredPart* const> parts, std::span<const double> weights,
                          const SampledRun& run) {
  const auto sum = [&](auto&& of) {
    double total = static_cast<double>(of(run.begin)) + static_cast<double>(of(run.end));
    for (std::size_t k = 0; k < parts.size(); ++k) total += weights[k] * static_cast<double>(of(*parts[k]));
    return std::max(0.0, total);
  };
  const auto rounded = [](double x) { return static_cast<std::uint64_t>(std::llround(x)); };
  MeasuredPart whole;
  whole.time = rounded(sum([](const MeasuredPart& p) { return p.time; }));
  const double longer = static_cast<double>(whole.time) / static_cast<double>(run.elapsed);
  whole.units = run.units;
  for (std::size_t u = 0; u < run.units.size(); ++u) {
    sim::UnitReport& unit = whole.units[u];
    for (std::size_t i = 0; i < unit.counters.size(); ++i) {
      sim::CounterReport& counter = unit.counters[i];
      if (counter.kind != sim::CounterKind::kPeak)
        counter.value = rounded(sum([&](const MeasuredPart& p) { return p.units[u].counters[i].value; }));
    }
    // Reasons are scaled to add up to the unit's time; the largest takes the rounding difference.
    unit.elapsed = rounded(longer * static_cast<double>(unit.elapsed));
    std::vector<double> spent;
    for (std::size_t i = 0; i < unit.cycles_by_reason.size(); ++i) {
      spent.push_back(sum([&](const MeasuredPart& p) { return p.units[u].cycles_by_reason[i].second; }));
    }
    const double all = std::accumulate(spent.begin(), spent.end(), 0.0);
    std::uint64_t given = 0;
    for (std::size_t i = 0; i < unit.cycles_by_reason.size(); ++i) {
      unit.cycles_by_reason[i].second =
          all == 0 ? 0 : static_cast<std::uint64_t>(spent[i] / all * static_cast<double>(unit.elapsed));
      given += unit.cycles_by_reason[i].second;
    }
    if (unit.cycles_by_reason.empty()) continue;
    std::ranges::max_element(unit.cycles_by_reason, {}, [](const auto& why) { return why.second; })->second +=
        unit.elapsed - given;
  }
  whole.kernels.resize(run.begin.kernels.size());
  for (std::size_t k = 0; k < whole.kernels.size(); ++k) {
    const auto of = [&](std::uint64_t hw::KernelUse::*member) {
      return rounded(sum([&](const MeasuredPart& p) { return p.kernels[k].*member; }));
    };
    using Use = hw::KernelUse;
    whole.kernels[k] = {of(&Use::launches), of(&Use::items), of(&Use::idle), of(&Use::cycles), of(&Use::starved)};
  }
  return whole;
}

}  // namespace tools
