#include "tools/studies/reproduce/plan.h"

#include <algorithm>

namespace tools::reproduce {

std::string Program::text() const {
  std::string out = name;
  for (const std::string& set : sets) out += " --set " + set;
  return out;
}

const std::vector<Paper>& papers() {
  static const std::vector<Paper> all = {{"lee2016", "Lee et al. 2016, adaptive multi-rate ray sampling", lee2016},
                                         {"kim2016", "Kim et al. 2016, adaptive undersampling", kim2016},
                                         {"jin2009", "Jin et al. 2009, selective and adaptive supersampling", jin2009},
                                         {"sgrt-units", "Mechanisms of the SGRT line, 2013 to 2015", sgrt_units}};
  return all;
}

Sets reproduction_rules() {
  return {"scene.lights.rig=strongest", "render.depth=3", "render.samples=regular", "render.glass_shadows=opaque"};
}

std::uint32_t side(std::uint32_t pixels, bool quick) {
  constexpr std::uint32_t kQuickly = 16;
  return quick ? std::max(1U, pixels / kQuickly) : pixels;
}

}  // namespace tools::reproduce
