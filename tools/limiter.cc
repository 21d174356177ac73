#include "tools/limiter.h"

#include <cstdint>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace tools {

namespace {

struct Reason {
  std::string_view name;
  std::string_view words;
  bool busy = false;
};

/// A kind of unit that may hold a frame back, and what its reasons mean to a reader.
struct Resource {
  std::string_view kind;  ///< part of a unit's path
  std::string_view words;
  std::vector<Reason> reasons;
};

const std::vector<Resource>& resources() {
  static const std::vector<Resource> all = {{".trv",
                                             "traversal units",
                                             {{"visiting", "", true},
                                              {"serial", "", true},
                                              {"starved", "having no rays"},
                                              {"l1_miss", "node lines that are not in their caches"},
                                              {"mshr_full", "too few miss registers"},
                                              {"rau_full", "full ray accumulation tables"},
                                              {"ist", "waiting for triangle tests"},
                                              {"pipe", "too few rays to fill the pipelines"},
                                              {"output_full", "finished rays that cannot leave"}}},
                                            {".ist",
                                             "intersection units",
                                             {{"testing", "", true},
                                              {"starved", "having no leaves"},
                                              {"l1_miss", "triangle lines that are not in their caches"},
                                              {"mshr_full", "too few miss registers"},
                                              {"rau_full", "full ray accumulation tables"},
                                              {"pipe", "too few leaves to fill the pipeline"},
                                              {"output_full", "answers that queue"}}},
                                            {".srp",
                                             "shader cores",
                                             {{"running", "", true},
                                              {"switching", "", true},
                                              {"starved", "having no tile"},
                                              {"cache_miss", "misses of their data caches"},
                                              {"waiting", "waiting for rays"},
                                              {"no_slots", "waiting for ray slots in the tile buffer"}}},
                                            {"dram.",
                                             "memory channels",
                                             {{"reading", "", true},
                                              {"writing", "", true},
                                              {"idle", "having no requests"},
                                              {"latency", "access latency"},
                                              {"row_conflict", "row conflicts"},
                                              {"activate", "opening rows"},
                                              {"refresh", "refresh"},
                                              {"turnaround", "changes between reads and writes"},
                                              {"column", "spacing of column commands"},
                                              {"command_bus", "their command buses"},
                                              {"returns_full", "responses that do not leave"},
                                              {"rank_switch", "changes between ranks"},
                                              {"power_down_exit", "leaving power-down"}}}};
  return all;
}

/// Share of the time that all units of a kind gave one reason for.
double share(std::span<const sim::UnitReport> units, std::string_view kind, std::string_view reason) {
  std::uint64_t cycles = 0, elapsed = 0;
  for (const sim::UnitReport& unit : units) {
    if (unit.path.find(kind) == std::string::npos) continue;
    elapsed += unit.elapsed;
    for (const auto& [name, spent] : unit.why) cycles += name == reason ? spent : 0;
  }
  return elapsed == 0 ? 0 : static_cast<double>(cycles) / static_cast<double>(elapsed);
}

}  // namespace

Utilisation utilisation(std::span<const sim::UnitReport> units) {
  return {share(units, ".trv", "visiting"), share(units, ".srp", "running") + share(units, ".srp", "switching"),
          share(units, "dram.", "reading") + share(units, "dram.", "writing")};
}

std::string limiter(std::span<const sim::UnitReport> units) {
  double most_busy = -1, most_loss = 0;
  std::string words;
  for (const Resource& resource : resources()) {
    double busy = 0, loss = 0;
    std::string_view loses_to;
    for (const Reason& reason : resource.reasons) {
      const double part = share(units, resource.kind, reason.name);
      if (reason.busy) {
        busy += part;
      } else if (part > loss) {
        loss = part;
        loses_to = reason.words;
      }
    }
    if (busy < most_busy || (busy == most_busy && loss <= most_loss)) continue;
    most_busy = busy;
    most_loss = loss;
    words = fmt::format("{}, busy {:.0f} % of the time", resource.words, 100 * busy);
    if (loss >= 0.01) words += fmt::format("; they lose most to {} ({:.0f} %)", loses_to, 100 * loss);
  }
  return words;
}

}  // namespace tools
