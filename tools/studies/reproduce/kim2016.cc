#include <fmt/format.h>

#include "tools/studies/reproduce/plan.h"

// Kim 2016: undersampling with 2x2 base blocks and post-correction by two scans, the defaults.

namespace tools::reproduce {
namespace {

View view_of_kim(const std::string& scene, bool quick) {
  View view{.scene = scene, .stand_in = "", .files = {}};
  if (scene == "bathroom" || scene == "conference" || scene == "hairball") {
    view.stand_in = "kim2016-" + scene;
    if (quick) view.sets = {"scene.triangles=15000"};
    return view;
  }
  view.files = {scene + ".glb"};
  if (scene == "cafe") view.files.emplace_back("hotel-room-99k.glb");
  if (scene == "ben") view.files.emplace_back("cesium-man-skinned-5k.glb");
  if (scene == "kitchen") view.files.emplace_back("kitchen-866k.glb");
  if (scene == "san-miguel") view.files.emplace_back("garden-outdoor-643k.glb");
  view.sets = reproduction_rules();
  return view;
}

/// grid x grid samples per pixel, compared with all of them traced.
Case sampled(const View& view, std::uint32_t width, std::uint32_t height, std::uint32_t grid, bool quick) {
  return {.view = view,
          .setting = fmt::format("{}x{}", grid, grid),
          .width = side(width, quick),
          .height = side(height, quick),
          .run = {"undersample", {fmt::format("undersample.samples={}", grid * grid)}},
          .reference = {fmt::format("full:{}", grid * grid)}};
}

std::vector<Figure> figures(const std::string& experiment, const std::vector<std::string>& metrics) {
  std::vector<Figure> out;
  for (const std::string& metric : metrics) out.push_back({experiment, metric});
  return out;
}

/// Tables 5 and 3(a) of one scene, and its part of figures 1 and 6.
void add_table_5(std::vector<Case>& cases, const std::string& scene, bool quick) {
  const View view = view_of_kim(scene, quick);
  for (const std::uint32_t width : {512U, 1024U, 2048U}) {
    for (const std::uint32_t grid : {1U, 2U, 4U}) {
      if (quick && (width != 1024 || grid > 2)) continue;
      Case c = sampled(view, width, width, grid, quick);
      c.setting = fmt::format("{} {}", width, c.setting);
      c.figures = figures("table 5", {"speedup", "traced_ratio", "traced_ratio_lit", "psnr_db"});
      if (width == 1024 && grid == 1) {
        for (const char* share : {"tracing_share", "adaptive_share", "correction_share"}) {
          c.figures.push_back({"table 3a", share});
        }
        for (const char* ops : {"ops_of_traced", "ops_of_interpolated"}) c.figures.push_back({"operations", ops});
        if (scene == "kitchen") c.figures.push_back({"figure 1", "traced_ratio"});
        if (scene == "kitchen" || scene == "bathroom") c.picture = "1-" + scene;
      }
      cases.push_back(std::move(c));
    }
  }
}

/// Thin things and their shadows, with and without post-correction.
void add_figure_6_of_kim(std::vector<Case>& cases, bool quick) {
  const View view = view_of_kim("bathroom", quick);
  Case without = sampled(view, 1024, 1024, 1, quick);
  without.setting = "no correction";
  without.run.sets.emplace_back("undersample.correction=off");
  without.figures = figures("figure 6", {"psnr_db", "traced_ratio"});
  without.picture = "6-uncorrected";
  Case shadows = sampled(view, 1024, 1024, 1, quick);
  shadows.setting = "shadows corrected";
  shadows.run.sets.emplace_back("undersample.correct_shadows=true");
  shadows.figures = without.figures;
  shadows.picture = "6-corrected";
  Case fine = sampled(view, 1024, 1024, 4, quick);
  fine.figures = without.figures;
  fine.machine = false;
  fine.picture = "6-sixteen-samples";
  cases.insert(cases.end(), {without, shadows, fine});
}

/// Ever more materials of the bathroom are mirrors.
void add_table_3b(std::vector<Case>& cases, bool quick) {
  for (const std::uint32_t share : {20U, 40U, 60U, 80U, 100U}) {
    if (quick && share % 40 != 20) continue;
    View view = view_of_kim("bathroom", quick);
    view.mirrors = share;
    Case c = sampled(view, 1024, 1024, 1, quick);
    c.setting = fmt::format("mirrors {} %", share);
    c.figures = figures("table 3b", {"reflective_share", "speedup", "traced_ratio", "rays_ratio"});
    cases.push_back(std::move(c));
  }
}

void add_table_3c(std::vector<Case>& cases, bool quick) {
  int number = 0;
  for (const char* camera : {"corner", "door", "seated", "windows", "along"}) {
    View view = view_of_kim("conference", quick);
    view.camera = camera;
    Case c = sampled(view, 1024, 1024, 1, quick);
    c.setting = fmt::format("view {}", ++number);
    c.figures = figures("table 3c", {"traced_ratio", "speedup"});
    cases.push_back(std::move(c));
  }
}

void add_table_4(std::vector<Case>& cases, bool quick) {
  for (const std::uint32_t grid : {1U, 2U, 4U, 8U, 16U}) {
    if (quick && grid > 1) continue;
    Case c = sampled(view_of_kim("hairball", quick), 3840, 2160, grid, quick);
    c.machine = grid <= 2;
    // Scans keep some bytes of every sample of the frame, which would be 38 GB of 16 x 16.
    if (grid > 4) c.run.sets.emplace_back("undersample.correction=off");
    c.figures = figures("table 4", {"speedup", "traced_ratio", "psnr_db"});
    cases.push_back(std::move(c));
  }
}

}  // namespace

std::vector<Case> kim2016(bool quick) {
  std::vector<Case> cases;
  for (const char* scene : {"cafe", "ben", "kitchen", "conference", "bathroom", "san-miguel"}) {
    if (!quick || !view_of_kim(scene, quick).stand_in.empty()) add_table_5(cases, scene, quick);
  }
  add_figure_6_of_kim(cases, quick);
  add_table_3b(cases, quick);
  add_table_3c(cases, quick);
  add_table_4(cases, quick);
  return cases;
}

}  // namespace tools::reproduce
