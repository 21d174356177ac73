#include "tools/studies/reproduce/plan.h"

// Lee 2016: multi-rate sampling at 2048x1024, rate control off (the paper's section 5 says it was to come), in two
// scopes: T&I units alone, as in figure 7, and the whole frame.

namespace tools::reproduce {
namespace {

constexpr std::uint32_t kLeeWidth = 2048, kLeeHeight = 1024;

View view_of_lee(const std::string& scene, bool quick) {
  View view{.scene = scene, .stand_in = "lee2016-" + scene, .files = {}};
  if (quick) view.sets = {"scene.triangles=15000"};
  return view;
}

Case mode_of(const View& view, bool super, bool quick) {
  const std::string setting = super ? "super" : "under";
  return {.view = view,
          .setting = setting,
          .width = side(kLeeWidth, quick),
          .height = side(kLeeHeight, quick),
          .run = {"multirate:" + setting},
          .reference = {super ? "full:4" : "full:1"}};
}

Case whole_frame(const View& view, bool super, bool quick) {
  Case c = mode_of(view, super, quick);
  c.figures = {{"table 1", "psnr_db"},
               {"whole frame", "traced_ratio"},
               {"whole frame", "work_ratio"},
               {"whole frame", "speedup"},
               {"whole frame", "speedup_x_work"},
               {"whole frame", "tni_power"},
               {"whole frame", "tni_perf_per_watt"},
               {"whole frame", "gpu_perf_per_watt"},
               {"kernel shares", "check_share"},
               {"kernel shares", "interpolation_share"},
               {"kernel shares", "starved_share"}};
  return c;
}

Case units_alone(const View& view, bool super, bool quick) {
  Case c = mode_of(view, super, quick);
  c.run.sets = c.reference.sets = tni_alone();
  c.figures = {{"figure 7", "time_ratio"},
               {"figure 7", "speedup"},
               {"figure 7", "speedup_x_work"},
               {"figure 7", "tni_power"},
               {"figure 7", "tni_perf_per_watt"}};
  if (view.scene == "village" && super) {
    c.figures.insert(c.figures.end(), {{"figure 1", "psnr_db"}, {"figure 1", "tni_perf_per_watt"}});
    c.picture = "1-village";
  }
  return c;
}

}  // namespace

std::vector<Case> lee2016(bool quick) {
  std::vector<Case> cases;
  for (const std::string scene : {"teapot", "chess", "car", "laboratory", "village"}) {
    if (quick && (scene == "car" || scene == "laboratory")) continue;
    const View view = view_of_lee(scene, quick);
    for (const bool super : {true, false}) {
      cases.push_back(units_alone(view, super, quick));
      cases.push_back(whole_frame(view, super, quick));
    }
    for (const bool super : {true, false}) {
      Case c = mode_of(view, super, quick);
      c.reference = c.run;  // attributes in the tile buffer, as is the default
      c.run.sets = {"multirate.attributes=dram"};
      c.figures = {{"attributes in DRAM", "dram_bytes_ratio"},
                   {"attributes in DRAM", "energy_ratio"},
                   {"attributes in DRAM", "time_ratio"}};
      cases.push_back(std::move(c));
    }
  }
  for (const char* frame : {"1", "150", "340", "400", "600", "700"}) {
    View view = view_of_lee("village", quick);
    view.frame = frame;
    Case c = mode_of(view, false, quick);
    c.machine = false;
    c.setting = std::string("frame ") + frame;
    c.figures = {{"figure 4", "similar_ratio"}, {"figure 4", "traced_ratio"}};
    c.picture = std::string("4-frame-") + frame;
    cases.push_back(std::move(c));
    if (quick && view.frame == "150") break;
  }
  return cases;
}

}  // namespace tools::reproduce
