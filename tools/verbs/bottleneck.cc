#include "tools/bottleneck.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/run_job.h"
#include "tools/verbs/verbs.h"

namespace tools {

namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Bottleneck& b) {
  std::string out = fmt::format("{} cycles (T&I clock); limited by {}\n\n", sim::si_text(static_cast<double>(b.cycles)), b.limiter);
  sim::Table table({"made perfect", "cycles at best", "speed-up"});
  for (const Bound& bound : b.bounds) {
    table.row({std::string(bound.resource), sim::si_text(static_cast<double>(bound.cycles)),
               fmt::format("{:.3f}", b.speedup(bound))});
  }
  return out + table.text();
}

Json json_of(const Bottleneck& b) {
  Json bounds = Json::object();
  for (const Bound& bound : b.bounds)
    bounds[std::string(bound.resource)] = {{"cycles", bound.cycles}, {"speedup", b.speedup(bound)}};
  return {{"schema", "raywatt-bottleneck/1"}, {"cycles", b.cycles}, {"limiter", b.limiter}, {"bounds", bounds}};
}

}  // namespace

void add_bottleneck(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "bottleneck", "What a frame gains if one resource is made perfect, for each resource, and what limits it");
  const auto options = std::make_shared<JobOptions>();
  const auto json = std::make_shared<bool>(false);
  add_work_options(*verb, *options);
  verb->add_flag("--json", *json, "as JSON");
  verb->footer("Example: raywatt bottleneck sgrt-2016 --scene chess --resolution 512x256");
  verb->callback([=] {
    const Bottleneck b = find_bottleneck(*options);
    fmt::print("{}", *json ? sim::json_text(json_of(b)) : text_of(b));
  });
}

}  // namespace tools
