#include <array>
#include <string>

#include <fmt/format.h>

#include "tools/studies/reproduce/plan.h"

// Wide and quantised trees, compared with the binary tree they are collapsed from. Run and reference have T&I units
// with the same number of box testers and the same caches.

namespace tools::reproduce {
namespace {

/// Rays of a frame: which effects are traced after the first hit.
struct RayMix {
  std::string name;
  Sets sets;
};

std::array<RayMix, 2> ray_mixes() {
  return {
      {{"primary rays", {"render.depth=1", "render.effects=none"}},
       {"incoherent rays",
        {"render.depth=1", "render.effects=occlusion", "render.occlusion_rays=4", "render.occlusion_distance=10"}}}};
}

struct Tree {
  std::string name;
  Sets sets;
};

/// Returns the trees to compare. bvh.leaf_size is the most triangles of a leaf; the SAH usually makes smaller leaves.
std::vector<Tree> wide_trees() {
  return {{"4 children", {"bvh.width=4"}},
          {"8 children", {"bvh.width=8"}},
          {"4 children, q8", {"bvh.width=4", "bvh.format=q8"}},
          {"8 children, q8, pairs", {"bvh.width=8", "bvh.format=q8", "bvh.leaf=pair64"}},
          {"8 children, q12, blocks", {"bvh.width=8", "bvh.format=q12", "bvh.leaf=block128", "bvh.leaf_size=8"}},
          {"8 children, q12, full blocks",
           {"bvh.width=8", "bvh.format=q12", "bvh.leaf=block128", "bvh.leaf_size=8", "bvh.collapse=sah",
            "bvh.collapse_cost=bytes"}},
          {"8 children, cw80, octants", {"bvh.width=8", "bvh.format=cw80", "bvh.order=octant", "bvh.leaf_size=3"}}};
}

/// Returns settings of T&I units with four box testers. Stacks are unlimited, so that no tree is traversed twice.
Sets four_testers() { return {"tni.trv.box_testers=4", "tni.trv.stack=full"}; }

Case tree_case(const View& view, const std::string& setting, const RayMix& rays, const Sets& run, const Sets& reference,
               bool quick) {
  return case_of_full_1(view, fmt::format("{}, {}", setting, rays.name), join_sets(rays.sets, run),
                        join_sets(rays.sets, reference), quick);
}

/// Adds cases that compare each tree with the binary tree: energy, time, area, visits and traffic.
void add_tree_cases(std::vector<Case>& cases, const View& view, bool quick) {
  for (const Tree& tree : wide_trees()) {
    for (const RayMix& rays : ray_mixes()) {
      for (const bool whole : {false, true}) {
        if (quick && whole) continue;
        const Sets machine = whole ? four_testers() : join_sets(four_testers(), tni_alone_settings());
        Case c = tree_case(view, fmt::format("{} against 2, {}", tree.name, whole ? "whole GPU" : "T&I alone"), rays,
                           join_sets(machine, tree.sets), machine, quick);
        c.metrics = metric_list("wide trees 2016", {"energy_ratio", "perf_per_area", "tni_perf_per_watt", "speedup",
                                                    "visits_ratio", "tests_ratio", "dram_bytes_ratio"});
        cases.push_back(std::move(c));
      }
    }
  }
}

/// Adds cases that measure the size of each tree.
void add_size_cases(std::vector<Case>& cases, const View& view, bool quick) {
  for (const Tree& tree : wide_trees()) {
    Case c = tree_case(view, tree.name, ray_mixes().front(), tree.sets, {}, quick);
    c.setting = tree.name;
    c.machine = false;
    c.metrics = metric_list("size", {"bytes_per_triangle", "node_bytes_ratio"});
    cases.push_back(std::move(c));
  }
}

/// Adds cases that compare short stacks with an unlimited one, and a stack whose entries are dropped when they begin
/// beyond the hit with one whose entries are not.
void add_stack_cases(std::vector<Case>& cases, const View& view, bool quick) {
  const Sets machine = join_sets({"bvh.width=8", "bvh.format=q8"}, tni_alone_settings());
  const Sets full = join_sets(machine, {"tni.trv.stack=full"});
  for (const RayMix& rays : ray_mixes()) {
    for (const char* scheme : {"restart_trail", "parent"}) {
      for (const int entries : {5, 8}) {
        const Sets stack = {fmt::format("tni.trv.stack={}", scheme), fmt::format("tni.trv.stack_entries={}", entries)};
        Case c = tree_case(view, fmt::format("{} entries, {}, against a full stack", entries, scheme), rays,
                           join_sets(machine, stack), full, quick);
        c.metrics = metric_list("short stack 2019", {"visits_ratio", "speedup", "tni_perf_per_watt"});
        cases.push_back(std::move(c));
      }
    }
    Case c = tree_case(view, "entries per child, dropped beyond the hit, against entries per node", rays, full,
                       join_sets(full, {"tni.trv.stack_push=node"}), quick);
    c.metrics = metric_list("leaf cull 2019", {"tests_ratio", "visits_ratio", "tni_perf_per_watt"});
    cases.push_back(std::move(c));
  }
}

}  // namespace

std::vector<Case> wide_cases(bool quick) {
  std::vector<Case> cases;
  for (const View& view : sgrt_views(quick)) {
    add_tree_cases(cases, view, quick);
    add_stack_cases(cases, view, quick);
    add_size_cases(cases, view, quick);
  }
  return cases;
}

}  // namespace tools::reproduce
