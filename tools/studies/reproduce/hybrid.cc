#include <string>

#include "tools/studies/reproduce/plan.h"

// A rasteriser for primary visibility beside the T&I units, against rays alone. What is left for rays decides, so each
// scene stands with shadows alone, with reflections and refractions, and with occlusion and soft shadows besides, for
// all pixels and for one of 2 x 2.

namespace tools::reproduce {
namespace {

constexpr std::uint32_t kHybridWidth = 512, kHybridHeight = 256;

std::vector<View> views(bool quick) {
  std::vector<View> all;
  for (const char* scene : {"cornell", "chess", "conference", "car", "atrium"}) {
    View view{.scene = scene, .stand_in = scene, .files = {}};
    view.sets = reproduction_rules();
    all.push_back(view);
    if (quick) return all;
  }
  return all;
}

}  // namespace

std::vector<Case> hybrid(bool quick) {
  std::vector<Case> cases;
  for (const View& view : views(quick)) {
    const auto add = [&](const std::string& setting, const Sets& sets) {
      Sets raster = sets;
      raster.emplace_back("render.primary=raster");
      cases.push_back({.view = view,
                       .setting = setting,
                       .width = quick ? kHybridWidth / 4 : kHybridWidth,
                       .height = quick ? kHybridHeight / 4 : kHybridHeight,
                       .run = {"full:1", raster},
                       .reference = {"full:1", sets},
                       .figures = {{"raster hybrid 2015", "rays_ratio"},
                                   {"raster hybrid 2015", "cycles"},
                                   {"raster hybrid 2015", "speedup"},
                                   {"raster hybrid 2015", "dram_bytes"},
                                   {"raster hybrid 2015", "dram_bytes_ratio"},
                                   {"raster hybrid 2015", "energy_ratio"},
                                   {"raster hybrid 2015", "gpu_perf_per_watt"},
                                   {"raster hybrid 2015", "raster_share"}}});
    };
    add("shadows", {"render.depth=1"});
    add("reflections and refractions", {});
    if (!quick) add("reflections and refractions, T&I alone", tni_alone());
    const std::string effects = "render.effects=occlusion, soft_shadows, reflections, refractions";
    add("occlusion and soft shadows", {effects});
    add("occlusion and soft shadows, half rate", {effects, "render.effect_rate=half"});
  }
  return cases;
}

}  // namespace tools::reproduce
