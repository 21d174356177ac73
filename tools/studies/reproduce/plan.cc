#include "tools/studies/reproduce/plan.h"

#include <algorithm>

namespace tools::reproduce {
namespace {

constexpr std::string_view kLeeNote =
    "Figure 7 is about the T&I unit. Its rows are of T&I units that never wait for rays, because shader cores and tile "
    "buffers are ideal. Rows of the whole frame are of the machine as configured, where fewer rays save time only if "
    "the "
    "T&I units are the bottleneck.";
constexpr std::string_view kKimNote =
    "Kim's GPU walks the tree in the kernels that also check and shade, so there a sample that is not traced is cheap. "
    "Here T&I units walk it, and the shader cores' part of the two turns around: a sample that is not traced costs "
    "them "
    "ops_of_interpolated operations, one that is traced ops_of_traced. Speed-ups are the paper's only as far as T&I "
    "units set the pace.";

constexpr std::string_view kHybridNote =
    "The paper's abstract gives one figure, the most that its hybrid gains in performance per energy, without scenes, "
    "resolution or what is left for rays. Pictures of both are the same here. What a rasteriser saves are primary "
    "rays: "
    "shadow rays and the shader cores' work stay, so gains follow from their share.";

constexpr std::string_view kChiuNote =
    "Chiu's passes follow each other over the whole frame; here a tile goes through both. Its first pass, geometry, is "
    "what a frame takes longer than one that shows its shaded samples alone (geometry_share), so the filters are in "
    "it. "
    "T&I alone: shader cores and tile buffers are ideal, so that times are the T&I units'.";

}  // namespace

std::string ProgramSetup::program_text() const {
  std::string out = name;
  for (const std::string& set : sets) out += " --set " + set;
  return out;
}

const std::vector<Paper>& all_papers() {
  static const std::vector<Paper> all = {
      {"lee2016", "Lee et al. 2016, adaptive multi-rate ray sampling", kLeeNote, lee_cases},
      {"kim2016", "Kim et al. 2016, adaptive undersampling", kKimNote, kim_cases},
      {"jin2009", "Jin et al. 2009, selective and adaptive supersampling", "", jin_cases},
      {"chiu", "Chiu et al. 2012, subpixel reconstruction antialiasing for ray tracing", kChiuNote, chiu_cases},
      {"sgrt-units", "Mechanisms of the SGRT line, 2013 to 2015", "", sgrt_unit_cases},
      {"hybrid", "A rasteriser beside the T&I units, 2015", kHybridNote, hybrid_cases}};
  return all;
}

Sets reproduction_rules() {
  return {"scene.lights.rig=strongest", "render.depth=3", "render.samples=regular", "render.glass_shadows=opaque"};
}

Sets tni_alone() { return {"ideal.srp=true", "ideal.tile_buffer=true", "tile_buffer.tiles_in_flight=8"}; }

std::uint32_t side_pixels(std::uint32_t pixels, bool quick) {
  constexpr std::uint32_t kQuickly = 16;
  return quick ? std::max(1U, pixels / kQuickly) : pixels;
}

}  // namespace tools::reproduce
