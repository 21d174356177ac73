#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "traces/scene/cameras.h"
#include "traces/scene/scene.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/car/body.h"
#include "traces/scenes/modelling/detail.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::car {
namespace {

// Parts of a wheel, which rotates about z; the outer side faces +z.

/// Rotates a mesh from the y axis to the z axis.
Mesh rotate_y_to_z(Mesh mesh) {
  return transform_mesh(std::move(mesh), glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0),
                                                   glm::vec4(0, 0, 0, 1)));
}

std::uint32_t round_segments(const Detail& detail) { return detail.cell_count(48, 12); }

Mesh make_tyre(const Detail& detail) {
  Outline o({0.232F, -0.095F});
  o.line_to(0.240F, -0.108F).arc_to(0.318F, -0.112F, 0.012F).arc_to(kWheel, -0.088F, 0.006F);
  for (const float groove : {-0.05F, 0.0F, 0.05F}) {
    o.line_to(kWheel, groove - 0.008F).line_to(kWheel - 0.009F, groove - 0.005F);
    o.line_to(kWheel - 0.009F, groove + 0.005F).line_to(kWheel, groove + 0.008F);
  }
  o.line_to(kWheel, 0.088F).arc_to(0.318F, 0.112F, 0.006F).arc_to(0.240F, 0.108F, 0.012F).line_to(0.232F, 0.095F);
  Mesh tyre =
      rotate_y_to_z(make_lathe("tyre", simplify_line(o.points(), detail.cell_count(26, 10)), round_segments(detail)));
  return tyre;
}

/// Makes a rim with five pairs of spokes.
Mesh make_rim(const Detail& detail) {
  // The lip of the rim, then back into the barrel, with normals towards the axis.
  Outline lip({0.242F, 0.080F});
  lip.arc_to(0.240F, 0.113F, 0.002F).line_to(0.234F, 0.116F).line_to(0.226F, 0.108F).arc_to(0.212F, 0.075F, -0.004F);
  lip.line_to(0.205F, -0.02F).line_to(0.212F, -0.10F);
  Mesh rim =
      rotate_y_to_z(make_lathe("rim", simplify_line(lip.points(), detail.cell_count(12, 7)), round_segments(detail)));
  Outline hub({0.070F, 0.02F});
  hub.line_to(0.066F, 0.070F)
      .arc_to(0.040F, 0.086F, 0.004F)
      .line_to(0.034F, 0.082F)
      .line_to(0.032F, 0.090F)
      .line_to(0, 0.092F);
  append_mesh(rim, rotate_y_to_z(
                       make_lathe("", simplify_line(hub.points(), detail.cell_count(9, 6)), detail.cell_count(24, 8))));
  const std::uint32_t sides = detail.cell_count(8, 4), steps = detail.cell_count(5, 2);
  for (int k = 0; k < 5; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const Mesh spoke = make_surface(
          "", sides, steps,
          [&](float s, float t) {
            const double angle = k / 5.0 + side * (0.020 + 0.035 * static_cast<double>(t));
            const glm::vec2 out = circle_point(angle), across(-out.y, out.x),
                            round = circle_point(static_cast<double>(s));
            const float radius = 0.045F + 0.172F * t;
            const glm::vec2 p = out * radius + across * ((0.017F - 0.004F * t) * round.x);
            return glm::vec3(p, 0.072F + 0.026F * t * t + 0.014F * round.y);
          },
          true);
      append_mesh(rim, spoke);
    }
    const Outline bolt = Outline({0.010F, 0}).line_to(0.010F, 0.012F).line_to(0, 0.014F);
    const glm::vec2 at = 0.052F * circle_point(k / 5.0 + 0.1);
    append_mesh(rim, transform_mesh(rotate_y_to_z(make_lathe("", bolt.points(), 6)), placement_at({at, 0.074F})));
  }
  return rim;
}

Mesh make_brake_disc(const Detail& detail) {
  const Outline o = Outline({0, -0.012F})
                        .line_to(0.17F, -0.012F)
                        .line_to(0.17F, 0.012F)
                        .line_to(0.09F, 0.012F)
                        .line_to(0.085F, 0.045F)
                        .line_to(0, 0.045F);
  return rotate_y_to_z(make_lathe("brake disc", o.points(), detail.cell_count(32, 10)));
}

/// Makes the brake caliper, which does not rotate with the wheel.
Mesh make_caliper(const Detail& detail) {
  const std::uint32_t steps = detail.cell_count(8, 3);
  std::vector<glm::vec2> outline;
  for (const float radius : {0.19F, 0.12F}) {
    for (std::uint32_t i = 0; i <= steps; ++i) {
      const double share = static_cast<double>(radius > 0.15F ? i : steps - i) / steps;
      outline.push_back(radius * circle_point(0.39 + 0.19 * share));
    }
  }
  Mesh caliper = transform_mesh(make_extrusion("caliper", outline, 0.07F), placement_at({0, 0, -0.03F}));
  return caliper;
}

constexpr float kEnd = 16, kSide = 7.5F, kHeight = 5.2F;

/// Returns a texture of concrete slabs with joints and the holes of their formwork.
Texture concrete_texture() {
  return paint_texture("concrete", 512, 512, [](float u, float v) {
    const float cloud = fractal_noise(u, v, 5, 6, 41),
                speck = random_unit(42, static_cast<std::uint64_t>(u * 512), static_cast<std::uint64_t>(v * 512));
    const float from_u = std::min(u, 1 - u), from_v = std::min(v, 1 - v);
    float shade = 0.64F + 0.26F * (cloud - 0.5F) + 0.05F * (speck - 0.5F);
    if (from_u < 0.006F || from_v < 0.006F) shade *= 0.45F;
    const glm::vec2 hole = glm::abs(glm::vec2(from_u - 0.2F, from_v - 0.2F));
    if (hole.x * hole.x + hole.y * hole.y < 0.015F * 0.015F) shade *= 0.4F;
    return glm::vec4(shade, shade * 0.985F, shade * 0.96F, 1);
  });
}

/// Returns a texture of a floor with two white lines and worn paint; u runs along the hall.
Texture floor_texture() {
  return paint_texture("painted floor", 1024, 512, [](float u, float v) {
    const float cloud = fractal_noise(u, v, 8, 6, 43);
    const float shade = 0.24F + 0.16F * (cloud - 0.5F);
    glm::vec3 colour(shade, shade * 1.02F, shade * 1.08F);
    for (const float line : {0.30F, 0.70F}) {
      const bool is_on = line < 0.5F || u * 8 - static_cast<float>(static_cast<int>(u * 8)) < 0.55F;
      if (std::abs(v - line) < 0.006F && is_on && cloud > 0.32F)
        colour = glm::vec3(0.85F, 0.83F, 0.76F) * (0.75F + 0.4F * cloud);
    }
    return glm::vec4(colour, 1);
  });
}

/// Adds a long hall of concrete with a painted floor, lights in the ceiling and glowing columns along the walls.
void add_hall(Scene& scene, const Detail& detail) {
  const std::uint32_t concrete = add_material(scene, make_textured("concrete", add_texture(scene, concrete_texture())));
  const std::uint32_t floor =
      add_material(scene, make_textured("painted floor", add_texture(scene, floor_texture()), glm::vec3(1), 0.14F));
  const std::uint32_t dark = add_material(scene, make_paint("dark steel", {0.07F, 0.075F, 0.08F}, 0.08F));
  const std::uint32_t glow = add_material(scene, make_lamp("light column", {0.92F, 0.95F, 0.98F}));
  const std::uint32_t bright = add_material(scene, make_lamp("ceiling light", {30, 29, 27}));

  const glm::vec3 x(2 * kEnd, 0, 0), y(0, kHeight, 0), z(0, 0, 2 * kSide);
  const glm::vec3 low(-kEnd, 0, -kSide), high(kEnd, kHeight, kSide);
  const auto wall = [&](const char* name, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
                        const glm::vec2& repeats, std::uint32_t material) {
    Mesh quad = make_quad(name, corner, u, v, detail.cell_count(8));
    scale_uvs(quad, repeats);
    add_object(scene, std::move(quad), material);
  };
  Mesh ground = make_quad("floor", {-kEnd, 0, kSide}, x, -z, detail.cell_count(12));
  add_object(scene, std::move(ground), floor);
  wall("back wall", low, x, y, {12, 2}, concrete);
  wall("front wall", high, -x, -y, {12, 2}, concrete);
  wall("left end", low, y, z, {2, 6}, concrete);
  wall("right end", high, -y, -z, {2, 6}, concrete);
  wall("ceiling", high, -z, -x, {6, 12}, dark);

  // Glowing columns between ribs of steel.
  const std::uint32_t column =
      add_mesh(scene, make_box("light column", {-0.09F, 0.25F, 0}, {0.09F, 4.3F, 0.08F}), glow);
  const std::uint32_t rib = add_mesh(
      scene, make_rounded_box("rib", {-0.25F, 0, 0}, {0.25F, kHeight, 0.45F}, 0.06F, detail.cell_count(2)), dark);
  const std::uint32_t beam =
      add_mesh(scene, make_box("beam", {-0.2F, kHeight - 0.5F, -kSide}, {0.2F, kHeight, kSide}), dark);
  for (int k = 0; k < 8; ++k) {
    const float at = -14 + 4 * static_cast<float>(k);
    for (const float side : {-1.0F, 1.0F}) {
      const double turns = side < 0 ? 0 : 0.5;
      add_instance(scene, rib, placement_at({at, 0, side * kSide}, turns));
      add_instance(scene, column, placement_at({at + 2, 0, side * kSide}, turns));
    }
    add_instance(scene, beam, placement_at({at, 0, 0}));
  }
  // Strips under the ceiling. The middle ones light the hall, the others only glow.
  for (int k = 0; k < 3; ++k) {
    const float at = -8 + 8 * static_cast<float>(k);
    for (const float side : {-2.6F, 2.6F}) {
      Mesh strip =
          make_box("ceiling strip", {at - 3, kHeight - 0.75F, side - 0.22F}, {at + 3, kHeight - 0.65F, side + 0.22F});
      add_object(scene, std::move(strip), k == 1 ? bright : glow);
    }
  }
}

using Line = std::vector<glm::vec2>;

enum class Stuff : std::uint8_t { kGlass, kLens, kLed, kTailLight, kBlack, kGap, kChrome, kPlate, kCount };

/// A thin part on the surface of the car's body, such as a window or a gap.
struct Sheet {
  Stuff stuff;
  From from;
  bool on_cabin;
  Mesh patch;
  float lift;
};

Line mirror_line(Line line) {
  for (glm::vec2& p : line) p.x = -p.x;
  return line;
}

/// Makes the thin parts on the surface of the car's body.
class SheetMaker {
 public:
  explicit SheetMaker(const Detail& detail) : detail_(detail) {}

  std::vector<Sheet> make_sheets() {
    add_windscreens();
    for (const From side : {From::kLeft, From::kRight}) add_side(side);
    add_strip(Stuff::kGap, From::kAbove, false, {{1.98F, -0.40F}, {2.03F, 0}, {1.98F, 0.40F}}, 0.008F, 16, 0.0025F);
    add_ends();
    return std::move(list_);
  }

 private:
  void add_patch(Stuff stuff, From from, bool on_cabin, const Line& a, const Line& b, double columns, double rows,
                 float lift) {
    list_.push_back(
        {stuff, from, on_cabin, make_patch(a, b, detail_.cell_count(columns, 2), detail_.cell_count(rows, 2)), lift});
  }
  void add_strip(Stuff stuff, From from, bool on_cabin, const Line& line, float width, double columns, float lift) {
    list_.push_back({stuff, from, on_cabin, make_strip(line, width, detail_.cell_count(columns, 2)), lift});
  }

  void add_windscreens() {
    const Line shield_low{{-0.545F, 0.965F}, {-0.3F, 0.93F}, {0.3F, 0.93F}, {0.545F, 0.965F}};
    const Line shield_high{{-0.405F, 1.190F}, {-0.2F, 1.215F}, {0.2F, 1.215F}, {0.405F, 1.190F}};
    add_patch(Stuff::kGlass, From::kFront, true, shield_low, shield_high, 24, 16, 0.004F);
    const Line back_low{{-0.42F, 1.0F}, {-0.2F, 0.985F}, {0.2F, 0.985F}, {0.42F, 1.0F}};
    const Line back_high{{-0.36F, 1.175F}, {-0.18F, 1.20F}, {0.18F, 1.20F}, {0.36F, 1.175F}};
    add_patch(Stuff::kGlass, From::kRear, true, back_low, back_high, 20, 14, 0.004F);
  }

  void add_side(From side) {
    add_patch(Stuff::kGlass, side, true, {{-0.44F, 0.90F}, {0.1F, 0.885F}, {0.66F, 0.875F}},
              {{-0.44F, 1.165F}, {-0.10F, 1.165F}, {0.25F, 1.08F}, {0.66F, 0.885F}}, 22, 10, 0.004F);
    add_patch(Stuff::kGlass, side, true, {{-1.28F, 0.965F}, {-0.9F, 0.915F}, {-0.49F, 0.902F}},
              {{-1.28F, 0.98F}, {-0.95F, 1.09F}, {-0.49F, 1.162F}}, 16, 10, 0.004F);
    // Gaps of doors, tank lid and bumpers, and the sill.
    add_strip(Stuff::kGap, side, false, {{0.70F, 0.80F}, {0.72F, 0.6F}, {0.68F, 0.40F}, {0.56F, 0.27F}}, 0.008F, 20,
              0.0025F);
    add_strip(Stuff::kGap, side, false, {{-0.50F, 0.84F}, {-0.56F, 0.65F}, {-0.58F, 0.45F}, {-0.50F, 0.27F}}, 0.008F,
              20, 0.0025F);
    add_strip(Stuff::kGap, side, false, {{0.56F, 0.27F}, {0.0F, 0.265F}, {-0.50F, 0.27F}}, 0.008F, 20, 0.0025F);
    add_strip(Stuff::kBlack, side, false, {{0.91F, 0.198F}, {0, 0.198F}, {-0.92F, 0.198F}}, 0.055F, 24, 0.004F);
    add_patch(Stuff::kBlack, side, false, {{0.86F, 0.46F}, {0.80F, 0.45F}}, {{0.885F, 0.64F}, {0.80F, 0.645F}}, 4, 10,
              0.004F);
    add_patch(Stuff::kLens, side, false, {{1.86F, 0.475F}, {1.97F, 0.47F}}, {{1.86F, 0.495F}, {1.97F, 0.49F}}, 5, 2,
              0.004F);
    add_patch(Stuff::kTailLight, side, false, {{-1.93F, 0.475F}, {-1.80F, 0.475F}},
              {{-1.93F, 0.495F}, {-1.80F, 0.495F}}, 5, 2, 0.004F);
    const float sign = side == From::kLeft ? -1.0F : 1.0F;
    // Gaps of bonnet and boot.
    add_strip(Stuff::kGap, From::kAbove, false,
              {{0.98F, sign * 0.66F}, {1.4F, sign * 0.60F}, {1.8F, sign * 0.50F}, {1.98F, sign * 0.40F}}, 0.008F, 24,
              0.0025F);
  }

  /// Adds grille, intakes, headlights and badge at the front of the car; tail lights, diffuser and number plate at the
  /// rear.
  void add_ends() {
    // Front: grille, side intakes, headlights with a bright line.
    add_patch(Stuff::kBlack, From::kFront, false, {{-0.44F, 0.235F}, {0, 0.225F}, {0.44F, 0.235F}},
              {{-0.52F, 0.37F}, {0, 0.385F}, {0.52F, 0.37F}}, 24, 6, 0.004F);
    for (const float y : {0.27F, 0.305F, 0.34F}) {
      add_strip(Stuff::kChrome, From::kFront, false, {{-0.44F, y}, {0, y}, {0.44F, y}}, 0.007F, 24, 0.010F);
    }
    const Line intake_low{{0.60F, 0.26F}, {0.76F, 0.28F}}, intake_high{{0.58F, 0.385F}, {0.79F, 0.41F}};
    const Line light_low{{0.45F, 0.515F}, {0.62F, 0.525F}, {0.80F, 0.575F}};
    const Line light_high{{0.45F, 0.545F}, {0.62F, 0.59F}, {0.80F, 0.65F}};
    const Line led{{0.475F, 0.527F}, {0.62F, 0.540F}, {0.785F, 0.592F}};
    for (const bool left : {false, true}) {
      const auto at = [left](const Line& line) { return left ? mirror_line(line) : line; };
      add_patch(Stuff::kBlack, From::kFront, false, at(intake_low), at(intake_high), 8, 6, 0.004F);
      add_patch(Stuff::kLens, From::kFront, false, at(light_low), at(light_high), 18, 7, 0.004F);
      add_strip(Stuff::kLed, From::kFront, false, at(led), 0.012F, 16, 0.008F);
      // Rear: lamps, exhausts in a black diffuser.
      add_patch(Stuff::kTailLight, From::kRear, false, at({{0.36F, 0.715F}, {0.60F, 0.715F}, {0.84F, 0.70F}}),
                at({{0.36F, 0.755F}, {0.60F, 0.775F}, {0.84F, 0.765F}}), 18, 4, 0.005F);
    }
    add_strip(Stuff::kTailLight, From::kRear, false, {{-0.36F, 0.735F}, {0, 0.735F}, {0.36F, 0.735F}}, 0.014F, 12,
              0.005F);
    add_patch(Stuff::kBlack, From::kRear, false, {{-0.60F, 0.42F}, {0, 0.41F}, {0.60F, 0.42F}},
              {{-0.66F, 0.50F}, {0, 0.505F}, {0.66F, 0.50F}}, 20, 4, 0.004F);
    add_patch(Stuff::kPlate, From::kRear, false, {{-0.26F, 0.57F}, {0.26F, 0.57F}}, {{-0.26F, 0.68F}, {0.26F, 0.68F}},
              8, 3, 0.010F);
    add_strip(Stuff::kGap, From::kRear, false, {{-0.78F, 0.80F}, {0, 0.81F}, {0.78F, 0.80F}}, 0.009F, 24, 0.003F);
    // A badge on the nose.
    add_patch(Stuff::kChrome, From::kFront, false, {{-0.035F, 0.475F}, {0, 0.455F}, {0.035F, 0.475F}},
              {{-0.035F, 0.485F}, {0, 0.51F}, {0.035F, 0.485F}}, 8, 3, 0.006F);
  }

  const Detail detail_;
  std::vector<Sheet> list_;
};

Mesh make_mirror(float side, const Detail& detail) {
  const std::uint32_t cells = detail.cell_count(9, 3);
  Mesh shell = make_surface(
      "", 2 * cells, cells,
      [&](float s, float t) {
        const glm::vec2 round = circle_point(static_cast<double>(s)),
                        up = circle_point(0.25 - 0.5 * static_cast<double>(t));
        // The mirror is blunt at the rear, where the glass is, and long and round in front.
        const float x = -up.y < 0 ? 0.10F * up.y : 0.03F * up.y;
        return glm::vec3(x, 0.062F * up.x * round.x, -0.105F * up.x * round.y);
      },
      true);
  shell = transform_mesh(std::move(shell), placement_at({0.50F, 0.945F, side * 0.985F}));
  const glm::vec3 path[] = {{0.50F, 0.86F, side * 0.76F}, {0.51F, 0.90F, side * 0.84F}, {0.51F, 0.93F, side * 0.93F}};
  const float radii[] = {0.022F, 0.018F, 0.016F};
  append_mesh(shell, make_tube("", path, radii, detail.cell_count(8, 4)));
  return shell;
}

Mesh make_handle(float side, const Detail& detail) {
  const float z = half_width_at(-0.33F, 0.70F);
  return make_rounded_box("handle", {-0.42F, 0.69F, side * z - 0.018F}, {-0.22F, 0.715F, side * z + 0.018F}, 0.01F,
                          detail.cell_count(2));
}

Mesh make_exhausts(const Detail& detail) {
  Mesh pipes;
  for (const float z : {-0.50F, -0.40F, 0.40F, 0.50F}) {
    const Outline o = Outline({0.036F, 0})
                          .line_to(0.040F, 0.10F)
                          .line_to(0.036F, 0.105F)
                          .line_to(0.032F, 0.10F)
                          .line_to(0.030F, 0.02F)
                          .line_to(0, 0.02F);
    const glm::mat4 to_rear(glm::vec4(0, 1, 0, 0), glm::vec4(-1, 0, 0, 0), glm::vec4(0, 0, 1, 0),
                            glm::vec4(-2.08F, 0.40F, z, 1));
    append_mesh(pipes, transform_mesh(make_lathe("", o.points(), detail.cell_count(20, 8)), to_rear));
  }
  pipes.name = "exhausts";
  return pipes;
}

/// Returns the approximate number of triangles that add_trim() adds.
std::uint64_t triangles_of_trim(const Detail& detail) {
  std::uint64_t sum = make_exhausts(detail).triangles.size();
  for (const Sheet& sheet : SheetMaker(detail).make_sheets()) sum += sheet.patch.triangles.size();
  return sum + 2 * (make_mirror(1, detail).triangles.size() + make_handle(1, detail).triangles.size());
}

/// Adds the parts on the body, attached to `node`: windows, lights, grilles, gaps, mirrors, handles, plates, exhausts.
void add_trim(Scene& scene, const Mesh& shell, const Mesh& cabin, std::uint32_t node, std::uint32_t lacquer,
              const Detail& detail) {
  const Material looks[] = {make_paint("tinted glass", {0.012F, 0.014F, 0.016F}, 0.32F),
                            make_metal("headlight", {0.55F, 0.58F, 0.62F}, 0.45F),
                            make_lamp("daytime light", {0.95F, 0.97F, 0.99F}),
                            make_paint("tail light", {0.35F, 0.0F, 0.0F}, 0.15F),
                            make_paint("black plastic", {0.018F, 0.018F, 0.02F}, 0.04F),
                            make_paint("gap", {0.01F, 0.006F, 0.006F}),
                            make_metal("chrome", {0.85F, 0.86F, 0.88F}, 0.75F),
                            make_paint("number plate", {0.82F, 0.82F, 0.78F}, 0.03F)};
  const char* const names[] = {"windows",    "headlights", "daytime lights", "tail lights",
                               "black trim", "gaps",       "chrome",         "plate"};
  Mesh parts_of[static_cast<std::size_t>(Stuff::kCount)];
  for (const Sheet& sheet : SheetMaker(detail).make_sheets()) {
    append_mesh(parts_of[static_cast<std::size_t>(sheet.stuff)],
                drape_patch(sheet.on_cabin ? cabin : shell, sheet.patch, sheet.from, sheet.lift));
  }
  const auto add = [&](Mesh mesh, std::uint32_t material) {
    attach_to_node(scene, add_instance(scene, add_mesh(scene, std::move(mesh), material)), node);
  };
  std::uint32_t chrome = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(Stuff::kCount); ++k) {
    Material look = looks[k];
    if (static_cast<Stuff>(k) == Stuff::kTailLight) look.emission = {0.45F, 0.015F, 0.01F};
    parts_of[k].name = names[k];
    const std::uint32_t material = add_material(scene, look);
    if (static_cast<Stuff>(k) == Stuff::kChrome) chrome = material;
    add(std::move(parts_of[k]), material);
  }
  for (const float side : {-1.0F, 1.0F}) {
    Mesh mirror = make_mirror(side, detail);
    mirror.name = side < 0 ? "left mirror" : "right mirror";
    add(std::move(mirror), lacquer);
    add(make_handle(side, detail), lacquer);
  }
  add(make_exhausts(detail), chrome);
}

}  // namespace
}  // namespace traces::car

namespace traces {
namespace {

constexpr float kSeconds = 6, kWay = 7;

/// Returns the distance that the car has driven at time `seconds`. The car starts and ends at rest.
float distance_driven(float seconds) {
  const float t = seconds / kSeconds;
  return kWay * t * t * t * (10 - 15 * t + 6 * t * t);
}

/// Attaches a mesh to a node of the car and shows it at the node's rest position.
void add_part(Scene& scene, Mesh mesh, std::uint32_t material, std::uint32_t node) {
  attach_to_node(scene, add_instance(scene, add_mesh(scene, std::move(mesh), material)), node);
}

void add_wheels(Scene& scene, std::uint32_t body, const Detail& detail) {
  const std::uint32_t rubber = add_material(scene, make_paint("rubber", {0.035F, 0.035F, 0.038F}));
  const std::uint32_t alloy = add_material(scene, make_metal("alloy", {0.86F, 0.87F, 0.90F}, 0.45F));
  const std::uint32_t steel = add_material(scene, make_metal("steel", {0.42F, 0.42F, 0.44F}, 0.35F));
  const std::uint32_t red = add_material(scene, make_paint("caliper", {0.75F, 0.62F, 0.04F}, 0.1F));
  const std::uint32_t tyre = add_mesh(scene, car::make_tyre(detail), rubber);
  const std::uint32_t rim = add_mesh(scene, car::make_rim(detail), alloy);
  const std::uint32_t disc = add_mesh(scene, car::make_brake_disc(detail), steel);
  const std::uint32_t caliper = add_mesh(scene, car::make_caliper(detail), red);
  constexpr int kKeys = 96;
  for (const float x : {car::kFrontAxle, car::kRearAxle}) {
    for (const float side : {-1.0F, 1.0F}) {
      const glm::vec3 centre(x, car::kWheel, side * car::kTrack);
      const glm::quat out = axis_rotation({0, 1, 0}, side > 0 ? 0 : 0.5);
      const std::uint32_t hub = add_node(scene, "hub", {.translation = centre}, body);
      const std::uint32_t still = add_node(scene, "brake", {.rotation = out}, hub);
      const std::uint32_t axle = add_node(scene, "axle", {}, hub);
      std::vector<TurnKey> turns;
      for (int k = 0; k <= kKeys; ++k) {
        const float seconds = kSeconds * static_cast<float>(k) / kKeys;
        constexpr float kRound = 6.2831853F * car::kWheel;
        turns.push_back({seconds, axis_rotation({0, 0, 1}, -static_cast<double>(distance_driven(seconds) / kRound))});
      }
      add_rotation_track(scene, axle, turns);
      const std::uint32_t wheel = add_node(scene, "wheel", {.rotation = out}, axle);
      for (const std::uint32_t mesh : {tyre, rim, disc}) attach_to_node(scene, add_instance(scene, mesh), wheel);
      attach_to_node(scene, add_instance(scene, caliper), still);
    }
  }
}

std::uint64_t triangles_of_car(const Detail& detail) {
  std::uint64_t sum = 0;
  for (const Mesh& mesh :
       {car::make_shell(detail), car::make_cabin(detail), car::make_underbody(detail), car::make_arch_lips(detail)}) {
    sum += mesh.triangles.size();
  }
  for (const Mesh& mesh :
       {car::make_tyre(detail), car::make_rim(detail), car::make_brake_disc(detail), car::make_caliper(detail)}) {
    sum += 4 * mesh.triangles.size();
  }
  return sum;
}

}  // namespace

/// Builds a coupe that drives through a hall: one large glossy object of smooth curves.
Scene build_car(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 55'000;
  Scene scene;
  scene.name = "car";
  scene.background = glm::vec3(0.05F);
  const std::uint64_t wanted = options.triangles_or_default(kClass);
  const Detail rough = detail_for(static_cast<double>(wanted), kClass);
  car::add_hall(scene, rough);
  const Detail detail =
      fit_detail(wanted, triangles_of_car, {.made = count_triangles(scene) + car::triangles_of_trim(rough)});

  const std::uint32_t node = add_node(scene, "car", {.translation = {-0.4F, 0, 0}});
  std::vector<Key> keys;
  for (int k = 0; k <= 48; ++k) {
    const float seconds = kSeconds * static_cast<float>(k) / 48;
    keys.push_back({seconds, {-0.4F + distance_driven(seconds), 0, 0}});
  }
  add_translation_track(scene, node, keys);
  const std::uint32_t lacquer = add_material(scene, make_paint("red lacquer", {0.62F, 0.025F, 0.02F}, 0.20F));
  const std::uint32_t black = add_material(scene, make_paint("underbody", {0.012F, 0.012F, 0.013F}));
  const Mesh shell = car::make_shell(detail), cabin = car::make_cabin(detail);
  car::add_trim(scene, shell, cabin, node, lacquer, rough);
  add_part(scene, shell, lacquer, node);
  add_part(scene, cabin, lacquer, node);
  add_part(scene, car::make_arch_lips(detail), lacquer, node);
  add_part(scene, car::make_underbody(detail), black, node);
  add_wheels(scene, node, detail);

  scene.cameras.push_back(look_at("front", {4.6F, 1.7F, 4.5F}, {-0.2F, 0.50F, 0.05F}, 0.44F));
  scene.cameras.push_back(look_at("rear", {-5.2F, 1.7F, 3.9F}, {-0.4F, 0.55F, 0}, 0.5F));
  const ViewKey path[] = {{0, {4.4F, 0.9F, 4.2F}, {-0.2F, 0.55F, 0}},
                          {1.5F, {4.2F, 1.0F, 4.6F}, {0.6F, 0.55F, 0}},
                          {3, {3.4F, 1.3F, 5.0F}, {3.0F, 0.55F, 0}},
                          {4.5F, {2.4F, 1.6F, 4.8F}, {5.6F, 0.5F, 0}},
                          {6, {2.2F, 1.9F, 4.4F}, {6.4F, 0.5F, 0}}};
  add_camera_path(scene, "path", path, 0.6F);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
