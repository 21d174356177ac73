#include "tests/fuzz/seed_report.h"

namespace fuzz {

nlohmann::ordered_json seed_report() {
  using Json = nlohmann::ordered_json;
  const Json band = {{"low", 1}, {"nominal", 2.5}, {"high", 4}};
  const auto unit = [](const char* reason, const char* counter) -> Json {
    return {{"elapsed", 100}, {"why", {{"idle", 60}, {reason, 40}}}, {"counters", {{counter, 30}, {"l1_accesses", 7}}}};
  };
  return {{"schema", "raywatt-report/1"},
          {"partial", false},
          {"program", "full:1"},
          {"resolution", {4, 2}},
          {"scene", {{"name", "cornell"}, {"triangles", 30}}},
          {"provenance", {{"model_id", "m"}, {"scene_sha256", "s"}}},
          {"config", {{"cores", 1}, {"tni", {{"trvs", 2}, {"energy", band}}}, {"list", {1, 2}}}},
          {"totals",
           {{"cycles", 1000},
            {"time_ms", 0.5},
            {"rays", {{"total", 8}, {"primary", 8}}},
            {"traversal_steps", 40},
            {"dram_bytes", 512},
            {"dram_bytes_by_client", {{"frame_buffer", 128}}},
            {"energy_mj", band},
            {"energy_by_block_mj", {{"tni", band}, {"dram", band}}},
            {"energy_by_kind_mj", {{"clock", band}, {"leakage", band}}},
            {"energy_by_event_mj", {{"tni.box_test", 1.5}}},
            {"power_w", band},
            {"perf", {{"fps", 60}, {"mrays_per_s", 10}}},
            {"top_down", {{"gpu", {{"tni", 0.5}, {"demands", {{"tni", 0.2}}}}}}},
            {"sampling", {{"wanted", 8}}},
            {"sampled", {{"tiles", 2}}},
            {"traced_ratio", 0.5}}},
          {"frames", {{{"frame", 0}, {"cycles", 1000}}, {{"frame", 1}, {"cycles", 900}}}},
          {"units",
           {{"core0", {{"tni", {{"trv0", unit("visiting", "visits")}, {"trv1", unit("l1_miss", "visits")}}}}},
            {"l2", {{"bank0", unit("hit", "hits")}}},
            {"dram", {{"channel0", unit("bus", "bytes")}}}}},
          {"host", {{"name", "here"}, {"threads", 1}, {"wall_s", 0.25}}}};
}

}  // namespace fuzz
