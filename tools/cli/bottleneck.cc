#include "tools/studies/bottleneck/bottleneck.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"

namespace tools {
namespace {

using sim::Json;

std::string text_of(const Bottleneck& b) {
  std::string out =
      fmt::format("{} cycles of the T&I clock\nlimited by (estimate)  {}\ntime goes to           {}\n\n",
                  sim::si_text(static_cast<double>(b.cycles)), b.limiter, top_down_text(time_json(b.time)));
  const bool replicated = b.plays.count > 1;
  sim::Table table({"made perfect", "cycles", "speed-up", "estimated",
                    replicated ? fmt::format("noise, of {} plays", b.plays.count) : "noise, assumed"});
  for (const Bound& bound : b.bounds) {
    const NoisySpeedup s = noisy_speedup(b, bound);
    const std::string mean = replicated ? fmt::format("mean {:.3f} ", s.value) : "";
    table.add_row({bound.resource, sim::si_text(static_cast<double>(bound.cycles)),
                   fmt::format("{:.3f}", b.speedup(bound)), fmt::format("{:.2f}", bound.estimated),
                   fmt::format("{}± {:.2g}, {}", mean, s.half_width, s.outside ? "outside" : "within")});
  }
  sim::Table caches({"first-level caches", "hits", "cycles a miss", "time waited for"});
  for (const CacheShare& cache : b.caches) {
    caches.add_row({cache.name, fmt::format("{:.1f} %", 100 * cache.hit_rate),
                    fmt::format("{:.1f}", cache.cycles_a_miss), fmt::format("{:.1f} %", 100 * cache.share)});
  }
  const char* const note =
      replicated ? "" : "noise: assumed for this size of picture; --replicates 5 measures it (docs/noise.md)\n";
  return out + table.text() + note + "\n" + caches.text();
}

Json json_of(const Bottleneck& b) {
  Json bounds = Json::object();
  for (const Bound& bound : b.bounds) {
    bounds[bound.resource] = {
        {"cycles", bound.cycles}, {"speedup", b.speedup(bound)}, {"estimated_speedup", bound.estimated}};
    const NoisySpeedup s = noisy_speedup(b, bound);
    bounds[bound.resource]["noise"] = {{"from", b.plays.count > 1 ? "replicates" : "default"},
                                       {"plays", b.plays.count},
                                       {"speedup", s.value},
                                       {"half_width", s.half_width},
                                       {"outside", s.outside}};
  }
  Json caches = Json::object();
  for (const CacheShare& cache : b.caches) {
    caches[cache.name] = {{"hit_rate", cache.hit_rate}, {"cycles_a_miss", cache.cycles_a_miss}, {"share", cache.share}};
  }
  return {{"schema", "raywatt-bottleneck/1"}, {"cycles", b.cycles}, {"limiter", b.limiter}, {"named", b.named},
          {"top_down", time_json(b.time)},    {"bounds", bounds},   {"caches", caches},     {"warnings", b.warnings}};
}

}  // namespace

void add_bottleneck(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "bottleneck", "What a frame gains if one resource is made perfect, for each resource, and what limits it");
  const auto options = std::make_shared<JobOptions>();
  const auto json = std::make_shared<bool>(false);
  add_work_options(*verb, *options);
  verb->add_option("--replicates", options->replicates,
                   "play every run so many times, slightly perturbed, and say which speed-ups are outside the noise\n"
                   "(docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  verb->add_flag("--json", *json, "as JSON");
  add_progress_option(*verb, options->progress);
  verb->footer("Example: raywatt bottleneck sgrt-2016 --scene chess --resolution 512x256");
  verb->callback([=] {
    Progress progress(options->progress, options->quiet);
    const Bottleneck b = find_bottleneck(*options, &progress);
    progress.end("done");
    fmt::print("{}", *json ? sim::json_text(json_of(b)) : for_terminal(text_of(b)));
  });
}

}  // namespace tools
