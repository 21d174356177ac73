#include <string>
#include <vector>

#include <fmt/format.h>

#include "tools/studies/reproduce/plan.h"

// Mechanisms against incoherent rays: prefetching, predicting, sorting and gathering in T&I units, next to an L1 that
// always hits.
// Run and reference differ in one mechanism. Shader cores are ideal, so that T&I units never wait for rays.

namespace tools::reproduce {
namespace {

struct Mechanism {
  std::string name;
  Sets sets;
};

const Mechanism kIdeal{"ideal L1", {"ideal.l1=true"}};
const Mechanism kStack{"stack prefetch", {"tni.trv.prefetch=stack"}};
const Mechanism kTreelet{"treelet prefetch", {"tni.trv.prefetch=treelet"}};
const Mechanism kPredictor{"predictor", {"tni.predictor.enabled=true"}};
const Mechanism kSort{"sort", {"tni.dispatcher.sort=origin_octant"}};
const Mechanism kGather{"gather", {"tni.trv.gather=node"}};

Mechanism with_key(const Mechanism& base, const std::string& text, const std::string& set) {
  return {base.name + " " + text, join_sets(base.sets, {set})};
}

/// Rays of a frame: the frame program and its settings.
struct TracedRays {
  std::string name, program;
  Sets sets;
};

const TracedRays kPaths{"path rays", "path:1", {"render.depth=4"}};
const TracedRays kPrimaries{"primary rays", "full:1", {"render.depth=1", "render.effects=none"}};
const TracedRays kOcclusion{"occlusion rays", "full:1", {"render.depth=1", "render.effects=occlusion"}};

Case coherence_case(const View& view, const std::string& setting, const TracedRays& rays, const Sets& run,
                    const Sets& reference, bool quick) {
  const Sets machine = join_sets(tni_alone_settings(), rays.sets);
  Case c = case_of_full_1(view, fmt::format("{}, {}", setting, rays.name), join_sets(machine, run),
                          join_sets(machine, reference), quick);
  c.run.name = c.reference.name = rays.program;
  return c;
}

const std::vector<std::string> kOfPrefetch = {"prefetch_accuracy", "prefetch_coverage", "speedup", "energy_ratio",
                                              "l1_fills_ratio"};
const std::vector<std::string> kOfPredictor = {"speedup", "energy_ratio", "visits_ratio", "rays_predicted",
                                               "predictions_correct"};
const std::vector<std::string> kOfOrder = {"speedup", "energy_ratio", "l1_first_hits_ratio", "l1_fills_ratio",
                                           "dram_bytes_ratio"};

void add_mechanisms(std::vector<Case>& cases, const View& view, bool quick) {
  const auto add = [&](const Mechanism& m, const TracedRays& rays, const std::string& experiment,
                       const std::vector<std::string>& metrics) {
    Case c = coherence_case(view, m.name, rays, m.sets, {}, quick);
    c.metrics = metric_list(experiment, metrics);
    cases.push_back(std::move(c));
  };
  for (const TracedRays& rays : {kPaths, kPrimaries}) {
    add(kIdeal, rays, "upper bound", {"speedup", "energy_ratio"});
    add(kStack, rays, "stack prefetch 2026", kOfPrefetch);
    add(kTreelet, rays, "treelet prefetch 2023", kOfPrefetch);
  }
  add(kIdeal, kOcclusion, "upper bound", {"speedup", "energy_ratio"});
  add(kPredictor, kOcclusion, "predictor 2021", kOfPredictor);
  add(kPredictor, kPrimaries, "predictor 2021", {"speedup", "energy_ratio"});
  add(kSort, kPaths, "sorting", kOfOrder);
  add(kGather, kPaths, "gathering", kOfOrder);
  if (quick) return;
  for (const int depth : {1, 4}) {
    add(with_key(kStack, fmt::format("of {}", depth), fmt::format("tni.trv.prefetch_depth={}", depth)), kPaths,
        "stack prefetch 2026", kOfPrefetch);
  }
  for (const int bytes : {512, 2048, 4096, 8192}) {
    add(with_key(kTreelet, fmt::format("of {} B", bytes), fmt::format("tni.trv.treelet_bytes={} B", bytes)), kPaths,
        "treelet prefetch 2023", kOfPrefetch);
  }
  for (const int window : {64, 1024}) {
    add(with_key(kSort, fmt::format("in {}", window), fmt::format("tni.dispatcher.window={}", window)), kPaths,
        "sorting", kOfOrder);
  }
}

/// Adds cases with few to many rays in flight per unit: what is left for a mechanism when rays hide latency.
void add_rays_in_flight(std::vector<Case>& cases, const View& view, bool quick) {
  for (const int rays : {2, 4, 8, 16, 32, 64}) {
    if (quick && rays != 2 && rays != 64) continue;
    const Sets few = {fmt::format("tni.trv.rays={}", rays), fmt::format("tni.ist.leaves={}", rays)};
    for (const Mechanism& m : {kIdeal, kStack, kTreelet, kSort, kGather}) {
      Case c = coherence_case(view, fmt::format("{}, {} rays in flight", m.name, rays), kPaths, join_sets(few, m.sets),
                              few, quick);
      c.metrics = metric_list("rays in flight", {"speedup"});
      cases.push_back(std::move(c));
    }
  }
}

/// Adds cases that play the rays of one bounce alone.
void add_bounces(std::vector<Case>& cases, const View& view, bool quick) {
  for (std::uint32_t bounce = 0; bounce < (quick ? 1 : 4); ++bounce) {
    for (const bool shadows : {false, true}) {
      Case c = coherence_case(view, fmt::format("bounce {}{}", bounce, shadows ? ", shadow rays" : ""), kPaths, {}, {},
                              quick);
      c.setting = fmt::format("bounce {}, {}", bounce, shadows ? "shadow rays" : "path rays");
      c.bounce = Bounce{bounce, shadows};
      c.metrics = metric_list("by bounce", {"bounce_rays", "visits_per_ray", "node_hits", "triangle_hits",
                                            "dram_bytes_per_ray", "lines_per_1000_rays"});
      cases.push_back(std::move(c));
    }
  }
}

}  // namespace

std::vector<Case> coherence_cases(bool quick) {
  std::vector<Case> cases;
  for (const View& view : sgrt_views(quick)) {
    add_mechanisms(cases, view, quick);
    add_rays_in_flight(cases, view, quick);
    add_bounces(cases, view, quick);
  }
  return cases;
}

}  // namespace tools::reproduce
