#include <string>
#include <vector>

#include <fmt/format.h>

#include "tools/studies/reproduce/plan.h"

// Building trees on the machine, frame by frame: a streaming unit, a unit that builds by a binned surface area
// heuristic, and kernels. Frames are of moving scenes, so each charges the building of its whole tree.

namespace tools::reproduce {
namespace {

std::vector<View> moving_views(bool quick) {
  std::vector<View> views = {{.scene = "car", .stand_in = "car", .files = {}}};
  if (!quick)
    views.push_back({.scene = "large car", .stand_in = "car", .files = {}, .sets = {"scene.triangles=600000"}});
  for (View& view : views) {
    view.sets = join_sets(reproduction_settings(), view.sets);
    if (quick) view.sets.emplace_back("scene.triangles=3000");
  }
  return views;
}

Sets streaming_unit() { return {"build.engine=unit", "build.policy=rebuild", "bvh.builder=lbvh"}; }

Sets ploc_unit() {
  return {"build.engine=unit", "build.policy=rebuild", "bvh.builder=ploc", "tree_builder.comparators=16"};
}

/// Returns a unit that reads and writes the boxes of all triangles once per level, as binning does, above subtrees that
/// fit on chip. The passes are those of a merge of two runs; the tree is that of the surface area heuristic.
Sets binning_unit() {
  return {"build.engine=unit", "build.policy=rebuild", "tree_builder.ways=2", "tree_builder.record_bytes=32"};
}

Sets build_kernels() { return {"build.engine=srp", "build.policy=rebuild", "bvh.builder=lbvh"}; }

}  // namespace

std::vector<Case> build_cases(bool quick) {
  struct Rays {
    const char* name;
    Sets sets;
  };
  const std::vector<Rays> mixes = {
      {"primary rays", {"render.depth=1", "render.effects=none"}},
      {"diffuse rays",
       {"render.depth=1", "render.effects=occlusion", "render.occlusion_rays=4", "render.occlusion_distance=10"}}};
  std::vector<Case> cases;
  for (const View& view : moving_views(quick)) {
    for (const Rays& rays : mixes) {
      const auto add = [&](const char* setting, const Sets& run, const Sets& reference, const char* experiment) {
        Case c = case_of_full_1(view, fmt::format("{}, {}", setting, rays.name), join_sets(rays.sets, run),
                                join_sets(rays.sets, reference), quick);
        c.metrics = metric_list(experiment, {"energy_ratio", "speedup", "dram_bytes_ratio", "visits_ratio"});
        cases.push_back(std::move(c));
      };
      add("streaming unit against binning unit", streaming_unit(), binning_unit(), "merge tree 2017");
      add("streaming unit of PLOC against binning unit", ploc_unit(), binning_unit(), "PLOC tree 2018");
      add("kernels against streaming unit", build_kernels(), streaming_unit(), "kernels");
      add("streaming unit against a free tree", streaming_unit(), {"build.engine=host"}, "cost of building");
    }
  }
  return cases;
}

}  // namespace tools::reproduce
