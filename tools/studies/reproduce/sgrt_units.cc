#include <fmt/format.h>

#include "tools/studies/reproduce/plan.h"

// Mechanisms of the SGRT line against what they took the place of, each on five scenes and on machines in which
// different units set the pace. Baseline and what stands against it differ in one mechanism alone.

namespace tools::reproduce {
namespace {

constexpr std::uint32_t kWidth = 512, kHeight = 256;

struct Machine {
  std::string name;
  Sets sets;
};

Machine whole_gpu() { return {"whole GPU", {}}; }
/// The papers measured T&I units alone.
Machine units_alone() { return {"T&I alone", tni_alone()}; }
/// A core's intersection unit serves one traversal unit, which hardly ever waits for it.
Machine one_trv() {
  Machine machine = units_alone();
  machine.name = "T&I alone, one TRV";
  machine.sets.emplace_back("tni.trvs=1");
  return machine;
}

std::vector<View> views(bool quick) {
  if (quick) {
    View view{.scene = "chess", .stand_in = "chess", .files = {}};
    view.sets = reproduction_rules();
    view.sets.emplace_back("scene.triangles=15000");
    return {view};
  }
  std::vector<View> all = {{.scene = "car", .stand_in = "car", .files = {"car-62k.glb"}},
                           {.scene = "chess", .stand_in = "chess", .files = {"chess-42k.glb"}},
                           {.scene = "room", .stand_in = "bathroom", .files = {"hotel-room-99k.glb"}},
                           {.scene = "conference", .stand_in = "conference", .files = {"conference-331k.glb"}},
                           {.scene = "garden", .stand_in = "forest", .files = {"garden-outdoor-643k.glb"}}};
  for (View& view : all) view.sets = reproduction_rules();
  return all;
}

Sets both(Sets a, const Sets& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Collects the cases of one scene.
class Plan {
 public:
  Plan(std::vector<Case>& cases, const View& view, bool quick) : cases_(cases), view_(view), quick_(quick) {}

  void add(const std::string& setting, const std::string& experiment, const Sets& run, const Sets& reference,
           const std::vector<std::string>& metrics) {
    Case c{.view = view_,
           .setting = setting,
           .width = quick_ ? kWidth / 4 : kWidth,
           .height = quick_ ? kHeight / 4 : kHeight,
           .run = {"full:1", run},
           .reference = {"full:1", reference}};
    for (const std::string& metric : metrics) c.figures.push_back({experiment, metric});
    cases_.push_back(std::move(c));
  }

 private:
  std::vector<Case>& cases_;
  const View& view_;
  const bool quick_;
};

/// Before 2014: one box tester, all work through one pipe, a record of memory for each box.
void add_two_boxes(Plan& plan, const Machine& m) {
  plan.add("2-AABB against 1-AABB, " + m.name, "two-AABB traversal 2014", m.sets,
           both(m.sets, {"tni.trv.box_testers=1", "bvh.boxes=single"}), {"speedup", "tni_perf_per_watt"});
}

const std::vector<std::string> kCacheUse = {
    "l1_hits",        "l1_hits_ratio", "l1_first_hits",    "l1_first_hits_ratio",
    "l1_fills_ratio", "speedup",       "tni_perf_per_watt"};

void add_reorder(Plan& plan, const Machine& m) {
  for (const char* other : {"bypass", "blocking", "rau"}) {
    plan.add(fmt::format("reorder against {}, {}", other, m.name), "reorder buffer 2015", m.sets,
             both(m.sets, {std::string("tni.miss_handling=") + other}), kCacheUse);
  }
}

/// Sizes that the paper does not give: rays that a unit holds, and its caches.
void add_sizes(Plan& plan, const Machine& m) {
  const auto add = [&](const std::string& size, const Sets& sets) {
    for (const char* other : {"bypass", "blocking"}) {
      plan.add(fmt::format("{}, against {}", size, other), "reorder buffer 2015 by size", both(m.sets, sets),
               both(both(m.sets, sets), {std::string("tni.miss_handling=") + other}),
               {"l1_hits_ratio", "speedup", "tni_perf_per_watt"});
    }
  };
  for (const int rays : {8, 16, 32, 64}) {
    add(fmt::format("{} rays", rays), {fmt::format("tni.trv.rays={}", rays), fmt::format("tni.ist.leaves={}", rays)});
  }
  for (const int size : {4, 8, 64}) {
    add(fmt::format("caches of {} KiB", size),
        {fmt::format("tni.trv.l1.size={} KiB", size), fmt::format("tni.ist.l1.size={} KiB", size)});
  }
}

void add_direct_interface(Plan& plan, const Machine& m) {
  const std::vector<std::string> metrics = {"dram_bytes_ratio", "speedup", "gpu_perf_per_watt"};
  const auto add = [&](const std::string& how, const Sets& off) {
    plan.add("on against off, " + m.name + how, "direct interface 2013", m.sets,
             both(both(m.sets, {"direct_interface.enabled=false"}), off), metrics);
  };
  add("", {});
  // Rings of 512 rays and hits, 48 KiB a core, are written over before the L2 throws them out.
  if (m.name == "T&I alone") add(", records stay in the L2", {"direct_interface.ring=512"});
}

void add_hybrid(Plan& plan, const Machine& m) {
  plan.add(
      "hybrid against floats, " + m.name, "hybrid numbers 2015", both(m.sets, {"bvh.numbers=hybrid"}), m.sets,
      {"box_bytes_ratio", "node_bytes_ratio", "l1_fills_ratio", "dram_bytes_ratio", "speedup", "tni_perf_per_watt"});
}

}  // namespace

std::vector<Case> sgrt_units(bool quick) {
  std::vector<Case> cases;
  for (const View& view : views(quick)) {
    Plan plan(cases, view, quick);
    std::vector<Machine> machines = {units_alone()};
    if (!quick) machines.push_back(whole_gpu());
    for (const Machine& m : machines) {
      add_reorder(plan, m);
      add_direct_interface(plan, m);
    }
    if (!quick) add_sizes(plan, units_alone());
    // Other trees come last, so that each is built once.
    for (const Machine& m : machines) add_hybrid(plan, m);
    machines.push_back(one_trv());
    for (const Machine& m : machines) add_two_boxes(plan, m);
  }
  return cases;
}

}  // namespace tools::reproduce
