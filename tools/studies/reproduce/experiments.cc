#include <algorithm>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "tools/studies/reproduce/plan.h"

namespace tools::reproduce {

Sets join_sets(Sets a, const Sets& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<PaperMetric> metric_list(const std::string& experiment, const std::vector<std::string>& metrics) {
  std::vector<PaperMetric> out;
  for (const std::string& metric : metrics) out.push_back({experiment, metric});
  return out;
}

namespace {

/// Setting that reduces the number of triangles of a built-in scene, for quick runs.
constexpr const char* kFewTriangles = "scene.triangles=15000";

void add_metrics(Case& c, const std::string& experiment, const std::vector<std::string>& metrics) {
  for (PaperMetric& metric : metric_list(experiment, metrics)) c.metrics.push_back(std::move(metric));
}

/// Returns an experiment at the paper's resolution, or at a reduced one if `quick`.
Case case_of(const View& view, std::string setting, std::uint32_t width, std::uint32_t height, ProgramSetup run,
             ProgramSetup reference, bool quick) {
  return {.view = view,
          .setting = std::move(setting),
          .width = side_pixels(width, quick),
          .height = side_pixels(height, quick),
          .run = std::move(run),
          .reference = std::move(reference)};
}

}  // namespace

// Lee 2016: multi-rate sampling at 2048x1024. The paper's rate control is missing, which its section 5 lists as future
// work. The experiments measure T&I units alone, as figure 7 of the paper, and the whole machine.
namespace {

View view_of_lee(const std::string& scene, bool quick) {
  View view{.scene = scene, .stand_in = "lee2016-" + scene, .files = {}};
  if (quick) view.sets = {kFewTriangles};
  return view;
}

Case multirate_case(const View& view, bool super, bool quick) {
  const std::string setting = super ? "super" : "under";
  return case_of(view, setting, 2048, 1024, {"multirate:" + setting}, {super ? "full:4" : "full:1"}, quick);
}

Case whole_frame_case(const View& view, bool super, bool quick) {
  Case c = multirate_case(view, super, quick);
  c.metrics = {{"table 1", "psnr_db"}};
  add_metrics(c, "whole frame",
              {"traced_ratio", "work_ratio", "speedup", "speedup_x_work", "tni_power", "tni_perf_per_watt",
               "gpu_perf_per_watt"});
  add_metrics(c, "kernel shares", {"check_share", "interpolation_share", "starved_share"});
  return c;
}

Case tni_alone_machine(const View& view, bool super, bool quick) {
  Case c = multirate_case(view, super, quick);
  c.run.sets = c.reference.sets = tni_alone_settings();
  c.metrics = metric_list("figure 7", {"time_ratio", "speedup", "speedup_x_work", "tni_power", "tni_perf_per_watt"});
  if (view.scene == "village" && super) {
    add_metrics(c, "figure 1", {"psnr_db", "tni_perf_per_watt"});
    c.picture = "1-village";
  }
  return c;
}

}  // namespace

std::vector<Case> lee_cases(bool quick) {
  std::vector<Case> cases;
  for (const std::string scene : {"teapot", "chess", "car", "laboratory", "village"}) {
    if (quick && (scene == "car" || scene == "laboratory")) continue;
    const View view = view_of_lee(scene, quick);
    for (const bool super : {true, false}) {
      cases.push_back(tni_alone_machine(view, super, quick));
      cases.push_back(whole_frame_case(view, super, quick));
    }
    for (const bool super : {true, false}) {
      Case c = multirate_case(view, super, quick);
      c.reference = c.run;  // the default: attributes are stored in the tile buffer
      c.run.sets = {"multirate.attributes=dram"};
      c.metrics = metric_list("attributes in DRAM", {"dram_bytes_ratio", "energy_ratio", "time_ratio"});
      cases.push_back(std::move(c));
    }
  }
  for (const char* frame : {"1", "150", "340", "400", "600", "700"}) {
    View view = view_of_lee("village", quick);
    view.frame = frame;
    Case c = multirate_case(view, false, quick);
    c.machine = false;
    c.setting = std::string("frame ") + frame;
    c.metrics = metric_list("figure 4", {"similar_ratio", "traced_ratio"});
    c.picture = std::string("4-frame-") + frame;
    cases.push_back(std::move(c));
    if (quick && view.frame == "150") break;
  }
  return cases;
}

// Kim 2016: undersampling with 2x2 base blocks and post-correction by two scans over the frame, as by default.

namespace {

View view_of_kim(const std::string& scene, bool quick) {
  View view{.scene = scene, .stand_in = "", .files = {}};
  if (scene == "bathroom" || scene == "conference" || scene == "hairball") {
    view.stand_in = "kim2016-" + scene;
    if (quick) view.sets = {kFewTriangles};
    return view;
  }
  view.files = {scene + ".glb"};
  if (scene == "cafe") view.files.emplace_back("hotel-room-99k.glb");
  if (scene == "ben") view.files.emplace_back("cesium-man-skinned-5k.glb");
  if (scene == "kitchen") view.files.emplace_back("kitchen-866k.glb");
  if (scene == "san-miguel") view.files.emplace_back("garden-outdoor-643k.glb");
  view.sets = reproduction_settings();
  return view;
}

/// Returns an undersampling experiment with `samples_per_side` squared samples per pixel. The reference traces all of
/// them.
Case undersample_case(const View& view, std::uint32_t width, std::uint32_t height, std::uint32_t samples_per_side,
                      bool quick) {
  return case_of(view, fmt::format("{}x{}", samples_per_side, samples_per_side), width, height,
                 {"undersample", {fmt::format("undersample.samples={}", samples_per_side * samples_per_side)}},
                 {fmt::format("full:{}", samples_per_side * samples_per_side)}, quick);
}

/// Adds the experiments on one scene for tables 3(a) and 5 and figures 1 and 6 of Kim 2016.
void add_table_5(std::vector<Case>& cases, const std::string& scene, bool quick) {
  const View view = view_of_kim(scene, quick);
  for (const std::uint32_t width : {512U, 1024U, 2048U}) {
    for (const std::uint32_t grid : {1U, 2U, 4U}) {
      if (quick && (width != 1024 || grid > 2)) continue;
      Case c = undersample_case(view, width, width, grid, quick);
      c.setting = fmt::format("{} {}", width, c.setting);
      c.metrics = metric_list("table 5", {"speedup", "traced_ratio", "traced_ratio_lit", "psnr_db"});
      if (width == 1024 && grid == 1) {
        add_metrics(c, "table 3a", {"tracing_share", "adaptive_share", "correction_share"});
        add_metrics(c, "operations", {"ops_of_traced", "ops_of_interpolated"});
        if (scene == "kitchen") c.metrics.push_back({"figure 1", "traced_ratio"});
        if (scene == "kitchen" || scene == "bathroom") c.picture = "1-" + scene;
      }
      cases.push_back(std::move(c));
    }
  }
}

/// Adds the experiments of Kim's figure 6: thin objects and their shadows, with and without post-correction.
void add_figure_6_of_kim(std::vector<Case>& cases, bool quick) {
  const View view = view_of_kim("bathroom", quick);
  Case without = undersample_case(view, 1024, 1024, 1, quick);
  without.setting = "no correction";
  without.run.sets.emplace_back("undersample.correction=off");
  without.metrics = metric_list("figure 6", {"psnr_db", "traced_ratio"});
  without.picture = "6-uncorrected";
  Case shadows = undersample_case(view, 1024, 1024, 1, quick);
  shadows.setting = "shadows corrected";
  shadows.run.sets.emplace_back("undersample.correct_shadows=true");
  shadows.metrics = without.metrics;
  shadows.picture = "6-corrected";
  Case fine = undersample_case(view, 1024, 1024, 4, quick);
  fine.metrics = without.metrics;
  fine.machine = false;
  fine.picture = "6-sixteen-samples";
  cases.insert(cases.end(), {without, shadows, fine});
}

/// Adds the experiments of Kim's table 3(b): mirrors cover 20 to 100 % of the bathroom's pixels.
void add_table_3b(std::vector<Case>& cases, bool quick) {
  for (const std::uint32_t share : {20U, 40U, 60U, 80U, 100U}) {
    if (quick && share % 40 != 20) continue;
    View view = view_of_kim("bathroom", quick);
    view.mirrors = share;
    Case c = undersample_case(view, 1024, 1024, 1, quick);
    c.setting = fmt::format("mirrors {} %", share);
    c.metrics = metric_list("table 3b", {"reflective_share", "speedup", "traced_ratio", "rays_ratio"});
    cases.push_back(std::move(c));
  }
}

void add_table_3c(std::vector<Case>& cases, bool quick) {
  int number = 0;
  for (const char* camera : {"corner", "door", "seated", "windows", "along"}) {
    View view = view_of_kim("conference", quick);
    view.camera = camera;
    Case c = undersample_case(view, 1024, 1024, 1, quick);
    c.setting = fmt::format("view {}", ++number);
    c.metrics = metric_list("table 3c", {"traced_ratio", "speedup"});
    cases.push_back(std::move(c));
  }
}

void add_table_4(std::vector<Case>& cases, bool quick) {
  for (const std::uint32_t grid : {1U, 2U, 4U, 8U, 16U}) {
    if (quick && grid > 1) continue;
    Case c = undersample_case(view_of_kim("hairball", quick), 3840, 2160, grid, quick);
    c.machine = grid <= 2;
    // Post-correction is off, because its scans would store 38 GB of data for 16 x 16 samples per pixel.
    if (grid > 4) c.run.sets.emplace_back("undersample.correction=off");
    c.metrics = metric_list("table 4", {"speedup", "traced_ratio", "psnr_db"});
    cases.push_back(std::move(c));
  }
}

}  // namespace

std::vector<Case> kim_cases(bool quick) {
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

// Jin 2009: adaptive supersampling at 1024x1024, compared with 256 samples per pixel.

namespace {

/// Attributes that have two thresholds: for primary hits, and (prefix "secondary_") for hits of secondary rays.
constexpr const char* kGeometry[] = {"object", "normal", "shadow", "texture"};

View view_of_jin(const std::string& scene, bool quick) {
  View view{.scene = scene, .stand_in = "", .files = {}};
  if (scene == "bathroom" || scene == "conference" || scene == "forest") {
    view.stand_in = "jin2009-" + scene;
    if (quick) view.sets = {kFewTriangles};
    return view;
  }
  view.files = {scene + ".glb", scene == "room" ? "hotel-room-99k.glb" : "kitchen-866k.glb"};
  view.sets = reproduction_settings();
  view.sets.emplace_back("render.samples=jittered");
  return view;
}

std::string threshold_key(const std::string& key, double value) { return fmt::format("supersample.{}={}", key, value); }

/// Adds settings for the threshold of an attribute, for both primary and secondary hits.
void set_both_thresholds(Sets& sets, const std::string& key, double value) {
  sets.push_back(threshold_key(key, value));
  sets.push_back(threshold_key("secondary_" + key, value));
}

/// Returns the adaptive supersampling program with Jin's default thresholds. `alpha`: threshold of colour and texture.
ProgramSetup adaptive_supersampling(const std::string& scene, double alpha) {
  ProgramSetup program{"supersample", {threshold_key("colour", alpha)}};
  set_both_thresholds(program.sets, "object", scene == "conference" ? 0.0 : 0.05);
  set_both_thresholds(program.sets, "normal", 0.06);
  set_both_thresholds(program.sets, "shadow", 0.06);
  set_both_thresholds(program.sets, "texture", alpha);
  return program;
}

Case case_against_truth(const View& view, std::string setting, ProgramSetup run, bool quick) {
  Case c = case_of(view, std::move(setting), 1024, 1024, std::move(run), {"full:1"}, quick);
  c.truth = true;
  return c;
}

void add_table_2(std::vector<Case>& cases, const std::string& scene, bool quick) {
  const View view = view_of_jin(scene, quick);
  const auto add = [&](std::string setting, ProgramSetup run) {
    Case c = case_against_truth(view, std::move(setting), std::move(run), quick);
    c.metrics = metric_list("table 2", {"psnr_db", "time_of_fixed_1"});
    if (c.run.name == "supersample") {
      c.metrics.push_back({"table 2", "samples_of_fixed_9"});
      c.picture = fmt::format("1-{}-{}", scene, c.setting);
    }
    cases.push_back(std::move(c));
  };
  for (const int samples : {16, 9, 4, 1}) {
    add(fmt::format("fixed {}", samples), {fmt::format("full:{}", samples)});
  }
  if (scene != "forest") {
    add("tau 0.6", adaptive_supersampling(scene, 0.6));
    return;
  }
  for (const double alpha : {0.1, 0.3, 0.6, 1.0})
    add(fmt::format("tau {:.1f}", alpha), adaptive_supersampling(scene, alpha));
  ProgramSetup shadows = adaptive_supersampling(scene, 1.0);
  set_both_thresholds(shadows.sets, "shadow", 1.0);
  add("tau 1.0, shadows 1.0", shadows);
  shadows.sets.emplace_back("supersample.focus=true");
  add("in focus", shadows);
}

/// Adds the experiments of Jin's figure 6: one attribute has a strict threshold, all others have threshold 1.
void add_figure_6_of_jin(std::vector<Case>& cases, bool quick) {
  View view{.scene = "textured room", .stand_in = "atrium", .files = {}};
  view.sets = reproduction_settings();
  view.sets.emplace_back("render.samples=jittered");
  if (quick) view.sets.emplace_back(kFewTriangles);
  std::vector<std::string> keys = {"colour"};
  for (const char* key : kGeometry) keys.insert(keys.end(), {key, std::string("secondary_") + key});
  for (const std::string& strict : keys) {
    ProgramSetup run{"supersample", {}};
    for (const std::string& key : keys) run.sets.push_back(threshold_key(key, key == strict ? 0.05 : 1.0));
    Case c = case_against_truth(view, strict + " alone", std::move(run), quick);
    c.machine = false;
    c.metrics = metric_list("figure 6", {"sample_ratio", "psnr_db"});
    c.picture = "6-" + strict;
    cases.push_back(std::move(c));
  }
}

/// Adds the experiments of Jin's figure 7: quality over number of samples, for the colour test alone and for all tests.
void add_figure_7(std::vector<Case>& cases, bool quick) {
  const View view = view_of_jin("forest", quick);
  for (const double alpha : {0.1, 0.2, 0.3, 0.6, 1.0}) {
    ProgramSetup colour{"supersample", {threshold_key("colour", alpha)}};
    for (const char* key : kGeometry) set_both_thresholds(colour.sets, key, -1);
    for (const bool single : {true, false}) {
      Case c = case_against_truth(view, fmt::format("{} {:.1f}", single ? "colour only" : "all thresholds", alpha),
                                  single ? colour : adaptive_supersampling("forest", alpha), quick);
      c.machine = false;
      c.metrics = metric_list("figure 7", {"sample_ratio", "psnr_db"});
      c.picture = single ? fmt::format("7-colour-{:.1f}", alpha) : fmt::format("7-all-{:.1f}", alpha);
      cases.push_back(std::move(c));
    }
  }
}

}  // namespace

std::vector<Case> jin_cases(bool quick) {
  std::vector<Case> cases;
  for (const char* scene : {"bathroom", "conference", "room", "kitchen", "forest"}) {
    if (quick && (view_of_jin(scene, quick).stand_in.empty() || std::string(scene) == "conference")) continue;
    add_table_2(cases, scene, quick);
  }
  add_figure_7(cases, quick);
  add_figure_6_of_jin(cases, quick);
  return cases;
}

// Chiu 2012: a pixel has one shaded sample and four geometry samples. The reference shades sixteen samples.

namespace {

constexpr std::uint32_t kChiuSide = 1024;

ProgramSetup unfiltered_program() { return {"reconstruct", {"reconstruct.radius=0"}}; }
ProgramSetup sraa_program() { return {"reconstruct:sraa"}; }
ProgramSetup reconstruction_program() { return {"reconstruct"}; }
/// Returns the reconstruction program with geometry samples from rasterisers instead of rays.
ProgramSetup raster_reconstruction() { return {"reconstruct", {"render.primary=raster"}}; }
ProgramSetup printed_weights() { return {"reconstruct", {"reconstruct.normal_weight=factor"}}; }
/// Returns the reconstruction program with the colour test of `supersample`.
ProgramSetup colour_test() { return {"reconstruct", {"reconstruct.colour=0.02"}}; }
ProgramSetup four_samples() { return {"full:4", {"render.samples=rotated"}}; }
ProgramSetup sixteen_samples() { return {"full:16"}; }

struct Setting {
  std::string name;
  ProgramSetup run;
};

View view_of(const std::string& scene, const std::string& stand_in, bool quick, const std::string& camera = {}) {
  View view{.scene = scene, .stand_in = stand_in, .files = {}, .camera = camera};
  view.sets = reproduction_settings();
  if (quick && stand_in != "cornell") view.sets.emplace_back(kFewTriangles);
  return view;
}
/// Returns a view of the scene that replaces Sponza, a court with a polished floor.
View sponza_view(bool quick, const std::string& camera = {}) { return view_of("Sponza", "atrium", quick, camera); }

Case chiu_case(const View& view, const Setting& setting, std::uint32_t pixels, const ProgramSetup& reference,
               bool quick) {
  return case_of(view, setting.name, pixels, pixels, setting.run, reference, quick);
}

/// Returns the program with settings added so that T&I units never wait for rays and are measured alone.
ProgramSetup with_tni_alone_settings(ProgramSetup program) {
  program.sets = join_sets(std::move(program.sets), tni_alone_settings());
  return program;
}

/// Adds experiments that measure frame times at several resolutions, and the share of the geometry pass.
void add_times(std::vector<Case>& cases, bool quick) {
  const View view = sponza_view(quick);
  for (const std::uint32_t pixels : {256U, 512U, 768U, 1024U}) {
    if (quick && pixels == 768) continue;
    for (const bool whole : {true, false}) {
      const std::string name = fmt::format("{}x{}{}", pixels, pixels, whole ? "" : ", T&I alone");
      const auto on = [&](const ProgramSetup& program) { return whole ? program : with_tni_alone_settings(program); };
      for (const Setting& s : {Setting{"none", unfiltered_program()},
                               {"ours, by rays", reconstruction_program()},
                               {"ours", raster_reconstruction()},
                               {"16x", sixteen_samples()}}) {
        Case c = chiu_case(view, {s.name + ", " + name, on(s.run)}, pixels, on(sixteen_samples()), quick);
        c.metrics = metric_list("figure 3", {"frame_ms", "speedup", "rays_ratio"});
        cases.push_back(std::move(c));
      }
      Case passes = chiu_case(view, {name, on(reconstruction_program())}, pixels, on(unfiltered_program()), quick);
      passes.metrics = {{"table 1", "frame_ms"}, {"table 1", "geometry_share"}};
      cases.push_back(std::move(passes));
    }
  }
}

/// Adds experiments that write pictures: of each reconstruction filter, and of four shaded samples per pixel.
void add_picture_cases(std::vector<Case>& cases, const std::string& figure, const View& view,
                       const std::vector<Crop>& crops, bool quick) {
  const std::string number = figure.substr(figure.find(' ') + 1);
  for (const Setting& s : {Setting{"none", unfiltered_program()},
                           {"SRAA", sraa_program()},
                           {"ours", reconstruction_program()},
                           {"colour-test", colour_test()},
                           {"4x", four_samples()}}) {
    Case c = chiu_case(view, s, kChiuSide, sixteen_samples(), quick);
    c.machine = false;
    c.metrics = {{figure, "psnr_db"}};
    c.picture = number + "-" + s.name;
    c.crops = crops;
    cases.push_back(std::move(c));
  }
}

/// Adds experiments that measure errors by class of pixels (Mask), for each reconstruction filter and its variants.
void add_quality_cases(std::vector<Case>& cases, const View& view, const std::string& name, std::uint32_t width,
                       std::uint32_t height, const std::vector<std::string>& masks, bool quick) {
  for (const Setting& s : {Setting{"none", unfiltered_program()},
                           {"SRAA", sraa_program()},
                           {"ours", reconstruction_program()},
                           {"as printed", printed_weights()},
                           {"colour-test", colour_test()},
                           {"4x", four_samples()}}) {
    Case c = chiu_case(view, {fmt::format("{}, {}, {}x{}", s.name, name, width, height), s.run}, width,
                       sixteen_samples(), quick);
    c.height = side_pixels(height, quick);
    c.machine = false;
    c.metrics = {{"masks", "psnr_db"}, {"masks", "rays_ratio"}};
    for (const std::string& mask : masks) c.metrics.push_back({"masks", "psnr_at_" + mask});
    cases.push_back(std::move(c));
  }
}

void add_mask_cases(std::vector<Case>& cases, bool quick) {
  std::vector<std::string> masks = {"object_edges", "shadow_edges", "elsewhere"};
  const auto add = [&](const View& view, const std::string& name) {
    add_quality_cases(cases, view, name, kChiuSide, kChiuSide, masks, quick);
    if (!quick) add_quality_cases(cases, view, name, 512, 256, masks, quick);
  };
  add(view_of("Cornell box", "cornell", quick, "front"), "front");
  if (quick) return;
  View nearer = view_of("Cornell box", "cornell", quick, "path");
  nearer.frame = "60";
  add(nearer, "nearer");
  masks.emplace_back("texture_edges");
  for (const char* camera : {"corner", "seated"}) add(view_of("conference", "conference", quick, camera), camera);
  for (const char* camera : {"court", "arcade"}) add(sponza_view(quick, camera), camera);
}

}  // namespace

std::vector<Case> chiu_cases(bool quick) {
  std::vector<Case> cases;
  add_times(cases, quick);
  add_picture_cases(cases, "figure 4", view_of("Cornell box", "cornell", quick), {{"shadow", 0.34, 0.83, 0.0625}},
                    quick);
  add_picture_cases(cases, "figure 5", sponza_view(quick),
                    {{"primary", 0.48, 0.44, 0.0625},
                     {"shadow", 0.5, 0.7, 0.0625},
                     {"reflection", 0.61, 0.87, 0.0625},
                     {"reflected-shadow", 0.7, 0.9, 0.0625}},
                    quick);
  add_picture_cases(cases, "figure 6", view_of("textured floor", "chess", quick), {{"floor", 0.5, 0.8, 0.0625}}, quick);
  for (Case& c : cases) {
    if (c.view.scene == "textured floor") c.metrics.push_back({"figure 6", "psnr_at_texture_edges"});
  }
  add_mask_cases(cases, quick);
  return cases;
}

// Mechanisms of the SGRT papers. Each is compared with its predecessor on five scenes and on machines with different
// bottlenecks. Run and reference differ in this mechanism only.

Case case_of_full_1(const View& view, const std::string& setting, const Sets& run, const Sets& reference, bool quick) {
  const std::uint32_t part = quick ? 4 : 1;
  return case_of(view, setting, 512 / part, 256 / part, {"full:1", run}, {"full:1", reference}, false);
}

std::vector<View> sgrt_views(bool quick) {
  if (quick) {
    View view{.scene = "chess", .stand_in = "chess", .files = {}};
    view.sets = reproduction_settings();
    view.sets.emplace_back(kFewTriangles);
    return {view};
  }
  std::vector<View> all = {{.scene = "car", .stand_in = "car", .files = {"car-62k.glb"}},
                           {.scene = "chess", .stand_in = "chess", .files = {"chess-42k.glb"}},
                           {.scene = "room", .stand_in = "bathroom", .files = {"hotel-room-99k.glb"}},
                           {.scene = "conference", .stand_in = "conference", .files = {"conference-331k.glb"}},
                           {.scene = "garden", .stand_in = "forest", .files = {"garden-outdoor-643k.glb"}}};
  for (View& view : all) view.sets = reproduction_settings();
  return all;
}

namespace {

struct Machine {
  std::string name;
  Sets sets;
};

Machine whole_gpu() { return {"whole GPU", {}}; }
/// Returns the machine that the papers measured, in which T&I units never wait for rays.
Machine tni_alone_machine() { return {"T&I alone", tni_alone_settings()}; }
/// Returns a machine with one traversal unit per intersection unit, so that traversal rarely waits for intersection.
Machine one_trv_machine() {
  Machine machine = tni_alone_machine();
  machine.name = "T&I alone, one TRV";
  machine.sets.emplace_back("tni.trvs=1");
  return machine;
}

/// Collects the experiments on one view of a scene. Each has a run and a reference run.
class Plan {
 public:
  Plan(std::vector<Case>& cases, const View& view, bool quick) : cases_(cases), view_(view), quick_(quick) {}

  void add(const std::string& setting, const std::string& experiment, const Sets& run, const Sets& reference,
           const std::vector<std::string>& metrics) {
    Case c = case_of_full_1(view_, setting, run, reference, quick_);
    c.metrics = metric_list(experiment, metrics);
    cases_.push_back(std::move(c));
  }

 private:
  std::vector<Case>& cases_;
  const View& view_;
  const bool quick_;
};

/// Adds experiments that compare traversal with two box testers with the unit before 2014: one box tester, one pipe
/// shared by boxes and leaves, one record per box.
void add_two_box_cases(Plan& plan, const Machine& m) {
  plan.add("2-AABB against 1-AABB, " + m.name, "two-AABB traversal 2014", m.sets,
           join_sets(m.sets, {"tni.trv.box_testers=1", "bvh.boxes=single"}), {"speedup", "tni_perf_per_watt"});
}

const std::vector<std::string> kCacheUse = {
    "l1_hits",        "l1_hits_ratio", "l1_first_hits",    "l1_first_hits_ratio",
    "l1_fills_ratio", "speedup",       "tni_perf_per_watt"};

void add_reorder_cases(Plan& plan, const Machine& m) {
  for (const char* other : {"bypass", "blocking", "rau"}) {
    plan.add(fmt::format("reorder against {}, {}", other, m.name), "reorder buffer 2015", m.sets,
             join_sets(m.sets, {std::string("tni.miss_handling=") + other}), kCacheUse);
  }
}

/// Adds experiments that vary two sizes that the paper does not state: rays in flight per unit, and cache size.
void add_size_cases(Plan& plan, const Machine& m) {
  const auto add = [&](const std::string& size, const Sets& sets) {
    for (const char* other : {"bypass", "blocking"}) {
      plan.add(fmt::format("{}, against {}", size, other), "reorder buffer 2015 by size", join_sets(m.sets, sets),
               join_sets(join_sets(m.sets, sets), {std::string("tni.miss_handling=") + other}),
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

void add_direct_interface_cases(Plan& plan, const Machine& m) {
  const std::vector<std::string> metrics = {"dram_bytes_ratio", "speedup", "gpu_perf_per_watt"};
  const auto add = [&](const std::string& how, const Sets& off) {
    plan.add("on against off, " + m.name + how, "direct interface 2013", m.sets,
             join_sets(join_sets(m.sets, {"direct_interface.enabled=false"}), off), metrics);
  };
  add("", {});
  // The ring buffers of 512 rays and hits take 48 KiB per core. Their lines are overwritten before the L2 evicts them.
  if (m.name == "T&I alone") add(", records stay in the L2", {"direct_interface.ring=512"});
}

void add_hybrid_cases(Plan& plan, const Machine& m) {
  plan.add(
      "hybrid against floats, " + m.name, "hybrid numbers 2015", join_sets(m.sets, {"bvh.numbers=hybrid"}), m.sets,
      {"box_bytes_ratio", "node_bytes_ratio", "l1_fills_ratio", "dram_bytes_ratio", "speedup", "tni_perf_per_watt"});
}

}  // namespace

std::vector<Case> sgrt_unit_cases(bool quick) {
  std::vector<Case> cases;
  for (const View& view : sgrt_views(quick)) {
    Plan plan(cases, view, quick);
    std::vector<Machine> machines = {tni_alone_machine()};
    if (!quick) machines.push_back(whole_gpu());
    for (const Machine& m : machines) {
      add_reorder_cases(plan, m);
      add_direct_interface_cases(plan, m);
    }
    if (!quick) add_size_cases(plan, tni_alone_machine());
    // Experiments with another BVH come last, so that each BVH is built once.
    for (const Machine& m : machines) add_hybrid_cases(plan, m);
    machines.push_back(one_trv_machine());
    for (const Machine& m : machines) add_two_box_cases(plan, m);
  }
  return cases;
}

// Rasterisers find the primary hits, compared with tracing all rays. The gain depends on the remaining rays. Each scene
// therefore has three sets of effects: shadows; reflections and refractions; occlusion and soft shadows. The third set
// is measured at full and at half rate.

namespace {

std::vector<View> hybrid_views(bool quick) {
  std::vector<View> all;
  for (const char* scene : {"cornell", "chess", "conference", "car", "atrium"}) {
    View view{.scene = scene, .stand_in = scene, .files = {}};
    view.sets = reproduction_settings();
    all.push_back(view);
    if (quick) return all;
  }
  return all;
}

}  // namespace

std::vector<Case> hybrid_cases(bool quick) {
  std::vector<Case> cases;
  for (const View& view : hybrid_views(quick)) {
    const auto add = [&](const std::string& setting, const Sets& sets) {
      Case c = case_of_full_1(view, setting, join_sets(sets, {"render.primary=raster"}), sets, quick);
      c.metrics =
          metric_list("raster hybrid 2015", {"rays_ratio", "cycles", "speedup", "dram_bytes", "dram_bytes_ratio",
                                             "energy_ratio", "gpu_perf_per_watt", "raster_share"});
      cases.push_back(std::move(c));
    };
    add("shadows", {"render.depth=1"});
    add("reflections and refractions", {});
    if (!quick) add("reflections and refractions, T&I alone", tni_alone_settings());
    const std::string effects = "render.effects=occlusion, soft_shadows, reflections, refractions";
    add("occlusion and soft shadows", {effects});
    add("occlusion and soft shadows, half rate", {effects, "render.effect_rate=half"});
  }
  return cases;
}

namespace {

constexpr std::string_view kLeeNote =
    "Figure 7 is about the T&I unit. Its rows are of T&I units that never wait for rays, because shader cores and tile "
    "buffers are ideal. Rows of the whole frame are of the machine as configured, where fewer rays save time only if "
    "the T&I units are the bottleneck.";

constexpr std::string_view kKimNote =
    "Kim's GPU walks the tree in the kernels that also check and shade, so a sample that is not traced is cheap there. "
    "Here T&I units walk the tree, so such a sample costs the shader cores more than a traced one: operations "
    "ops_of_interpolated and ops_of_traced. Speed-ups equal those of the paper only if T&I units are the bottleneck.";

constexpr std::string_view kHybridNote =
    "The paper's abstract gives one value, the largest gain in performance per energy, without scenes, resolution or "
    "remaining rays. Here the pictures of both are equal. A rasteriser saves only primary rays. Shadow rays and the "
    "work of the shader cores remain, so the gain depends on their share.";

constexpr std::string_view kWideNote =
    "The 2016 publication compares two wide trees, on scenes and caches that its abstract does not give. Here a tree "
    "of "
    "four children is compared with the binary tree from which it is collapsed, on T&I units with the same testers and "
    "caches. The 2019 publication has trees of four children; here they have eight. Bytes per triangle are not "
    "published: "
    "their ranges are computed from record sizes, without the 12 bytes of labels that are counted here.";

constexpr std::string_view kCoherenceNote =
    "The published gains are of simulators of desktop and mobile GPUs with 4 to 16 warps in flight, on scenes that the "
    "abstracts do not name. Compare them with rt-warp-like (--config rt-warp-like). No mechanism can exceed the upper "
    "bound, an L1 that always hits. Rays of a bounce are played alone.";
constexpr std::string_view kBuildNote =
    "The abstract of the 2017 publication gives savings of energy per frame, without scenes, resolution and rays per "
    "frame. The share of building in a frame's energy, and so the saving, depends on these. The binning unit here "
    "moves "
    "the bytes of binning, but has the arithmetic of the streaming unit.";

constexpr std::string_view kChiuNote =
    "Chiu's passes process the whole frame one after the other; here a tile goes through both. The cost of the first "
    "pass, geometry, is the time of a frame beyond that of its shaded samples alone (geometry_share), so it includes "
    "the filters. T&I alone: shader cores and tile buffers are ideal, so times are those of the T&I units.";

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
      {"hybrid", "A rasteriser next to the T&I units, 2015", kHybridNote, hybrid_cases},
      {"wide", "Wide and quantised trees, 2016 to 2025", kWideNote, wide_cases},
      {"coherence", "Mechanisms against incoherent rays, 2021 to 2026", kCoherenceNote, coherence_cases},
      {"builders", "Building trees each frame, 2017", kBuildNote, build_cases}};
  return all;
}

Sets reproduction_settings() {
  return {"scene.lights.rig=strongest", "render.depth=3", "render.samples=regular", "render.glass_shadows=opaque"};
}

Sets tni_alone_settings() { return {"ideal.srp=true", "ideal.tile_buffer=true", "tile_buffer.tiles_in_flight=8"}; }

std::uint32_t side_pixels(std::uint32_t pixels, bool quick) {
  constexpr std::uint32_t kQuickly = 16;
  return quick ? std::max(1U, pixels / kQuickly) : pixels;
}

}  // namespace tools::reproduce
