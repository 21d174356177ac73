#include <fmt/format.h>

#include "tools/studies/reproduce/plan.h"

// Chiu 2012: one shaded sample per pixel and the geometry of four, compared with sixteen samples.

namespace tools::reproduce {
namespace {

constexpr std::uint32_t kChiuSide = 1024;

Program none() { return {"reconstruct", {"reconstruct.radius=0"}}; }
Program sraa() { return {"reconstruct:sraa"}; }
Program ours() { return {"reconstruct"}; }
/// With geometry by rasterisers.
Program rasterised() { return {"reconstruct", {"render.primary=raster"}}; }
Program printed() { return {"reconstruct", {"reconstruct.normal_weight=factor"}}; }
/// With the colour test of supersample.
Program colour_test() { return {"reconstruct", {"reconstruct.colour=0.02"}}; }
Program four() { return {"full:4", {"render.samples=rotated"}}; }
Program sixteen() { return {"full:16"}; }

struct Setting {
  std::string name;
  Program run;
};

View view_of(const std::string& scene, const std::string& stand_in, bool quick, const std::string& camera = {}) {
  View view{.scene = scene, .stand_in = stand_in, .files = {}, .camera = camera};
  view.sets = reproduction_rules();
  if (quick && stand_in != "cornell") view.sets.emplace_back("scene.triangles=15000");
  return view;
}
/// A court with a polished floor.
View sponza(bool quick, const std::string& camera = {}) { return view_of("Sponza", "atrium", quick, camera); }

Case compared(const View& view, const Setting& setting, std::uint32_t pixels, const Program& reference, bool quick) {
  return {.view = view,
          .setting = setting.name,
          .width = side(pixels, quick),
          .height = side(pixels, quick),
          .run = setting.run,
          .reference = reference};
}

/// `program` on T&I units that always have rays at hand.
Program alone(Program program) {
  const Sets sets = tni_alone();
  program.sets.insert(program.sets.end(), sets.begin(), sets.end());
  return program;
}

/// Time by resolution: all of it, and its two passes.
void add_times(std::vector<Case>& cases, bool quick) {
  const View view = sponza(quick);
  for (const std::uint32_t pixels : {256U, 512U, 768U, 1024U}) {
    if (quick && pixels == 768) continue;
    for (const bool whole : {true, false}) {
      const std::string name = fmt::format("{}x{}{}", pixels, pixels, whole ? "" : ", T&I alone");
      const auto on = [&](const Program& program) { return whole ? program : alone(program); };
      for (const Setting& s :
           {Setting{"none", none()}, {"ours, by rays", ours()}, {"ours", rasterised()}, {"16x", sixteen()}}) {
        Case c = compared(view, {s.name + ", " + name, on(s.run)}, pixels, on(sixteen()), quick);
        c.figures = {{"figure 3", "frame_ms"}, {"figure 3", "speedup"}, {"figure 3", "rays_ratio"}};
        cases.push_back(std::move(c));
      }
      Case passes = compared(view, {name, on(ours())}, pixels, on(none()), quick);
      passes.figures = {{"table 1", "frame_ms"}, {"table 1", "geometry_share"}};
      cases.push_back(std::move(passes));
    }
  }
}

/// Pictures by all filters, and four samples where the geometry's are.
void add_pictures(std::vector<Case>& cases, const std::string& figure, const View& view, const std::vector<Crop>& crops,
                  bool quick) {
  const std::string number = figure.substr(figure.find(' ') + 1);
  for (const Setting& s :
       {Setting{"none", none()}, {"SRAA", sraa()}, {"ours", ours()}, {"colour-test", colour_test()}, {"4x", four()}}) {
    Case c = compared(view, s, kChiuSide, sixteen(), quick);
    c.machine = false;
    c.figures = {{figure, "psnr_db"}};
    c.picture = number + "-" + s.name;
    c.crops = crops;
    cases.push_back(std::move(c));
  }
}

/// Errors by what the pixels show. Both readings of the weight of normals, and the colour test.
void add_quality(std::vector<Case>& cases, const View& view, const std::string& name, std::uint32_t width,
                 std::uint32_t height, const std::vector<std::string>& masks, bool quick) {
  for (const Setting& s : {Setting{"none", none()},
                           {"SRAA", sraa()},
                           {"ours", ours()},
                           {"as printed", printed()},
                           {"colour-test", colour_test()},
                           {"4x", four()}}) {
    Case c =
        compared(view, {fmt::format("{}, {}, {}x{}", s.name, name, width, height), s.run}, width, sixteen(), quick);
    c.height = side(height, quick);
    c.machine = false;
    c.figures = {{"masks", "psnr_db"}, {"masks", "rays_ratio"}};
    for (const std::string& mask : masks) c.figures.push_back({"masks", "psnr_at_" + mask});
    cases.push_back(std::move(c));
  }
}

void add_masks(std::vector<Case>& cases, bool quick) {
  std::vector<std::string> masks = {"object_edges", "shadow_edges", "elsewhere"};
  const auto add = [&](const View& view, const std::string& name) {
    add_quality(cases, view, name, kChiuSide, kChiuSide, masks, quick);
    if (!quick) add_quality(cases, view, name, 512, 256, masks, quick);
  };
  add(view_of("Cornell box", "cornell", quick, "front"), "front");
  if (quick) return;
  View nearer = view_of("Cornell box", "cornell", quick, "path");
  nearer.frame = "60";
  add(nearer, "nearer");
  masks.emplace_back("texture_edges");
  for (const char* camera : {"corner", "seated"}) add(view_of("conference", "conference", quick, camera), camera);
  for (const char* camera : {"court", "arcade"}) add(sponza(quick, camera), camera);
}

}  // namespace

std::vector<Case> chiu(bool quick) {
  std::vector<Case> cases;
  add_times(cases, quick);
  add_pictures(cases, "figure 4", view_of("Cornell box", "cornell", quick), {{"shadow", 0.34, 0.83, 0.0625}}, quick);
  add_pictures(cases, "figure 5", sponza(quick),
               {{"primary", 0.48, 0.44, 0.0625},
                {"shadow", 0.5, 0.7, 0.0625},
                {"reflection", 0.61, 0.87, 0.0625},
                {"reflected-shadow", 0.7, 0.9, 0.0625}},
               quick);
  add_pictures(cases, "figure 6", view_of("textured floor", "chess", quick), {{"floor", 0.5, 0.8, 0.0625}}, quick);
  for (Case& c : cases) {
    if (c.view.scene == "textured floor") c.figures.push_back({"figure 6", "psnr_at_texture_edges"});
  }
  add_masks(cases, quick);
  return cases;
}

}  // namespace tools::reproduce
