#include <fmt/format.h>

#include "tools/studies/reproduce/plan.h"

// Jin 2009: supersampling at 1024x1024, pictures compared with 256 samples per pixel.

namespace tools::reproduce {
namespace {

constexpr std::uint32_t kJinSide = 1024;

/// Keys of the geometry that the pixel sees and that its secondary ray sees.
constexpr const char* kGeometry[] = {"object", "normal", "shadow", "texture"};

View view_of_jin(const std::string& scene, bool quick) {
  View view{.scene = scene, .stand_in = "", .files = {}};
  if (scene == "bathroom" || scene == "conference" || scene == "forest") {
    view.stand_in = "jin2009-" + scene;
    if (quick) view.sets = {"scene.triangles=15000"};
    return view;
  }
  view.files = {scene + ".glb", scene == "room" ? "hotel-room-99k.glb" : "kitchen-866k.glb"};
  view.sets = reproduction_rules();
  view.sets.emplace_back("render.samples=jittered");
  return view;
}

std::string threshold(const std::string& key, double value) { return fmt::format("supersample.{}={}", key, value); }

/// The same value for an attribute of the pixel and of its secondary ray.
void set_both(Sets& sets, const std::string& key, double value) {
  sets.push_back(threshold(key, value));
  sets.push_back(threshold("secondary_" + key, value));
}

/// The paper's defaults with tau_alpha: colour and both textures.
Program adaptive(const std::string& scene, double alpha) {
  Program program{"supersample", {threshold("colour", alpha)}};
  set_both(program.sets, "object", scene == "conference" ? 0.0 : 0.05);
  set_both(program.sets, "normal", 0.06);
  set_both(program.sets, "shadow", 0.06);
  set_both(program.sets, "texture", alpha);
  return program;
}

Case against_truth(const View& view, std::string setting, Program run, bool quick) {
  return {.view = view,
          .setting = std::move(setting),
          .width = side(kJinSide, quick),
          .height = side(kJinSide, quick),
          .run = std::move(run),
          .reference = {"full:1"},
          .truth = true};
}

void add_table_2(std::vector<Case>& cases, const std::string& scene, bool quick) {
  const View view = view_of_jin(scene, quick);
  const auto add = [&](std::string setting, Program run) {
    Case c = against_truth(view, std::move(setting), std::move(run), quick);
    c.figures = {{"table 2", "psnr_db"}, {"table 2", "time_of_fixed_1"}};
    if (c.run.name == "supersample") {
      c.figures.push_back({"table 2", "samples_of_fixed_9"});
      c.picture = fmt::format("1-{}-{}", scene, c.setting);
    }
    cases.push_back(std::move(c));
  };
  for (const int samples : {16, 9, 4, 1}) {
    add(fmt::format("fixed {}", samples), {fmt::format("full:{}", samples)});
  }
  if (scene != "forest") {
    add("tau 0.6", adaptive(scene, 0.6));
    return;
  }
  for (const double alpha : {0.1, 0.3, 0.6, 1.0}) add(fmt::format("tau {:.1f}", alpha), adaptive(scene, alpha));
  Program shadows = adaptive(scene, 1.0);
  set_both(shadows.sets, "shadow", 1.0);
  add("tau 1.0, shadows 1.0", shadows);
  shadows.sets.emplace_back("supersample.focus=true");
  add("in focus", shadows);
}

/// One attribute strict, all others at 1.
void add_figure_6_of_jin(std::vector<Case>& cases, bool quick) {
  View view{.scene = "textured room", .stand_in = "atrium", .files = {}};
  view.sets = reproduction_rules();
  view.sets.emplace_back("render.samples=jittered");
  if (quick) view.sets.emplace_back("scene.triangles=15000");
  std::vector<std::string> keys = {"colour"};
  for (const char* key : kGeometry) keys.insert(keys.end(), {key, std::string("secondary_") + key});
  for (const std::string& strict : keys) {
    Program run{"supersample", {}};
    for (const std::string& key : keys) run.sets.push_back(threshold(key, key == strict ? 0.05 : 1.0));
    Case c = against_truth(view, strict + " alone", std::move(run), quick);
    c.machine = false;
    c.figures = {{"figure 6", "sample_ratio"}, {"figure 6", "psnr_db"}};
    c.picture = "6-" + strict;
    cases.push_back(std::move(c));
  }
}

/// Colour alone against all thresholds: quality by number of samples.
void add_figure_7(std::vector<Case>& cases, bool quick) {
  const View view = view_of_jin("forest", quick);
  for (const double alpha : {0.1, 0.2, 0.3, 0.6, 1.0}) {
    Program colour{"supersample", {threshold("colour", alpha)}};
    for (const char* key : kGeometry) set_both(colour.sets, key, -1);
    for (const bool single : {true, false}) {
      Case c = against_truth(view, fmt::format("{} {:.1f}", single ? "colour only" : "all thresholds", alpha),
                             single ? colour : adaptive("forest", alpha), quick);
      c.machine = false;
      c.figures = {{"figure 7", "sample_ratio"}, {"figure 7", "psnr_db"}};
      c.picture = single ? fmt::format("7-colour-{:.1f}", alpha) : fmt::format("7-all-{:.1f}", alpha);
      cases.push_back(std::move(c));
    }
  }
}

}  // namespace

std::vector<Case> jin2009(bool quick) {
  std::vector<Case> cases;
  for (const char* scene : {"bathroom", "conference", "room", "kitchen", "forest"}) {
    if (quick && (view_of_jin(scene, quick).stand_in.empty() || std::string(scene) == "conference")) continue;
    add_table_2(cases, scene, quick);
  }
  add_figure_7(cases, quick);
  add_figure_6_of_jin(cases, quick);
  return cases;
}

}  // namespace tools::reproduce
