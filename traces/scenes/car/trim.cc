#include "traces/scenes/car/trim.h"

#include <utility>
#include <vector>

#include "traces/scenes/car/body.h"
#include "traces/scenes/car/drape.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/modelling/turned.h"

namespace traces::car {
namespace {

using Line = std::vector<glm::vec2>;

enum class Stuff : std::uint8_t { kGlass, kLens, kLed, kTailLight, kBlack, kGap, kChrome, kPlate, kCount };

/// A thin part on the surface of the body.
struct Sheet {
  Stuff stuff;
  From from;
  bool on_cabin;
  Mesh patch;
  float lift;
};

Line mirrored(Line line) {
  for (glm::vec2& p : line) p.x = -p.x;
  return line;
}

/// Makes sheets at one detail.
class SheetMaker {
 public:
  explicit SheetMaker(const Detail& detail) : detail_(detail) {}

  std::vector<Sheet> make() {
    add_windscreens();
    for (const From side : {From::kLeft, From::kRight}) add_side(side);
    strip(Stuff::kGap, From::kAbove, false, {{1.98F, -0.40F}, {2.03F, 0}, {1.98F, 0.40F}}, 0.008F, 16, 0.0025F);
    add_ends();
    return std::move(list_);
  }

 private:
  void patch(Stuff stuff, From from, bool on_cabin, const Line& a, const Line& b, double columns, double rows,
             float lift) {
    list_.push_back({stuff, from, on_cabin, make_patch(a, b, detail_.cells(columns, 2), detail_.cells(rows, 2)), lift});
  }
  void strip(Stuff stuff, From from, bool on_cabin, const Line& line, float width, double columns, float lift) {
    list_.push_back({stuff, from, on_cabin, make_strip(line, width, detail_.cells(columns, 2)), lift});
  }

  void add_windscreens() {
    const Line shield_low{{-0.545F, 0.965F}, {-0.3F, 0.93F}, {0.3F, 0.93F}, {0.545F, 0.965F}};
    const Line shield_high{{-0.405F, 1.190F}, {-0.2F, 1.215F}, {0.2F, 1.215F}, {0.405F, 1.190F}};
    patch(Stuff::kGlass, From::kFront, true, shield_low, shield_high, 24, 16, 0.004F);
    const Line back_low{{-0.42F, 1.0F}, {-0.2F, 0.985F}, {0.2F, 0.985F}, {0.42F, 1.0F}};
    const Line back_high{{-0.36F, 1.175F}, {-0.18F, 1.20F}, {0.18F, 1.20F}, {0.36F, 1.175F}};
    patch(Stuff::kGlass, From::kRear, true, back_low, back_high, 20, 14, 0.004F);
  }

  void add_side(From side) {
    patch(Stuff::kGlass, side, true, {{-0.44F, 0.90F}, {0.1F, 0.885F}, {0.66F, 0.875F}},
          {{-0.44F, 1.165F}, {-0.10F, 1.165F}, {0.25F, 1.08F}, {0.66F, 0.885F}}, 22, 10, 0.004F);
    patch(Stuff::kGlass, side, true, {{-1.28F, 0.965F}, {-0.9F, 0.915F}, {-0.49F, 0.902F}},
          {{-1.28F, 0.98F}, {-0.95F, 1.09F}, {-0.49F, 1.162F}}, 16, 10, 0.004F);
    // Gaps of doors, tank lid and bumpers; the sill.
    strip(Stuff::kGap, side, false, {{0.70F, 0.80F}, {0.72F, 0.6F}, {0.68F, 0.40F}, {0.56F, 0.27F}}, 0.008F, 20,
          0.0025F);
    strip(Stuff::kGap, side, false, {{-0.50F, 0.84F}, {-0.56F, 0.65F}, {-0.58F, 0.45F}, {-0.50F, 0.27F}}, 0.008F, 20,
          0.0025F);
    strip(Stuff::kGap, side, false, {{0.56F, 0.27F}, {0.0F, 0.265F}, {-0.50F, 0.27F}}, 0.008F, 20, 0.0025F);
    strip(Stuff::kBlack, side, false, {{0.91F, 0.198F}, {0, 0.198F}, {-0.92F, 0.198F}}, 0.055F, 24, 0.004F);
    patch(Stuff::kBlack, side, false, {{0.86F, 0.46F}, {0.80F, 0.45F}}, {{0.885F, 0.64F}, {0.80F, 0.645F}}, 4, 10,
          0.004F);
    patch(Stuff::kLens, side, false, {{1.86F, 0.475F}, {1.97F, 0.47F}}, {{1.86F, 0.495F}, {1.97F, 0.49F}}, 5, 2,
          0.004F);
    patch(Stuff::kTailLight, side, false, {{-1.93F, 0.475F}, {-1.80F, 0.475F}}, {{-1.93F, 0.495F}, {-1.80F, 0.495F}}, 5,
          2, 0.004F);
    const float sign = side == From::kLeft ? -1.0F : 1.0F;
    // Bonnet and boot.
    strip(Stuff::kGap, From::kAbove, false,
          {{0.98F, sign * 0.66F}, {1.4F, sign * 0.60F}, {1.8F, sign * 0.50F}, {1.98F, sign * 0.40F}}, 0.008F, 24,
          0.0025F);
  }

  /// Adds the parts of front and rear.
  void add_ends() {
    // Face: grille, side intakes, headlights with a bright line.
    patch(Stuff::kBlack, From::kFront, false, {{-0.44F, 0.235F}, {0, 0.225F}, {0.44F, 0.235F}},
          {{-0.52F, 0.37F}, {0, 0.385F}, {0.52F, 0.37F}}, 24, 6, 0.004F);
    for (const float y : {0.27F, 0.305F, 0.34F}) {
      strip(Stuff::kChrome, From::kFront, false, {{-0.44F, y}, {0, y}, {0.44F, y}}, 0.007F, 24, 0.010F);
    }
    const Line intake_low{{0.60F, 0.26F}, {0.76F, 0.28F}}, intake_high{{0.58F, 0.385F}, {0.79F, 0.41F}};
    const Line light_low{{0.45F, 0.515F}, {0.62F, 0.525F}, {0.80F, 0.575F}};
    const Line light_high{{0.45F, 0.545F}, {0.62F, 0.59F}, {0.80F, 0.65F}};
    const Line led{{0.475F, 0.527F}, {0.62F, 0.540F}, {0.785F, 0.592F}};
    for (const bool left : {false, true}) {
      const auto at = [left](const Line& line) { return left ? mirrored(line) : line; };
      patch(Stuff::kBlack, From::kFront, false, at(intake_low), at(intake_high), 8, 6, 0.004F);
      patch(Stuff::kLens, From::kFront, false, at(light_low), at(light_high), 18, 7, 0.004F);
      strip(Stuff::kLed, From::kFront, false, at(led), 0.012F, 16, 0.008F);
      // Rear: lamps, exhausts in a black diffuser.
      patch(Stuff::kTailLight, From::kRear, false, at({{0.36F, 0.715F}, {0.60F, 0.715F}, {0.84F, 0.70F}}),
            at({{0.36F, 0.755F}, {0.60F, 0.775F}, {0.84F, 0.765F}}), 18, 4, 0.005F);
    }
    strip(Stuff::kTailLight, From::kRear, false, {{-0.36F, 0.735F}, {0, 0.735F}, {0.36F, 0.735F}}, 0.014F, 12, 0.005F);
    patch(Stuff::kBlack, From::kRear, false, {{-0.60F, 0.42F}, {0, 0.41F}, {0.60F, 0.42F}},
          {{-0.66F, 0.50F}, {0, 0.505F}, {0.66F, 0.50F}}, 20, 4, 0.004F);
    patch(Stuff::kPlate, From::kRear, false, {{-0.26F, 0.57F}, {0.26F, 0.57F}}, {{-0.26F, 0.68F}, {0.26F, 0.68F}}, 8, 3,
          0.010F);
    strip(Stuff::kGap, From::kRear, false, {{-0.78F, 0.80F}, {0, 0.81F}, {0.78F, 0.80F}}, 0.009F, 24, 0.003F);
    // A badge on the nose.
    patch(Stuff::kChrome, From::kFront, false, {{-0.035F, 0.475F}, {0, 0.455F}, {0.035F, 0.475F}},
          {{-0.035F, 0.485F}, {0, 0.51F}, {0.035F, 0.485F}}, 8, 3, 0.006F);
  }

  const Detail detail_;
  std::vector<Sheet> list_;
};

Mesh make_mirror(float side, const Detail& detail) {
  const std::uint32_t cells = detail.cells(9, 3);
  Mesh shell = make_surface(
      "", 2 * cells, cells,
      [&](float s, float t) {
        const glm::vec2 round = on_circle(static_cast<double>(s)), up = on_circle(0.25 - 0.5 * static_cast<double>(t));
        // Blunt at the rear, where the glass is; long and round in front.
        const float x = -up.y < 0 ? 0.10F * up.y : 0.03F * up.y;
        return glm::vec3(x, 0.062F * up.x * round.x, -0.105F * up.x * round.y);
      },
      true);
  shell = transformed(std::move(shell), placed({0.50F, 0.945F, side * 0.985F}));
  const glm::vec3 path[] = {{0.50F, 0.86F, side * 0.76F}, {0.51F, 0.90F, side * 0.84F}, {0.51F, 0.93F, side * 0.93F}};
  const float radii[] = {0.022F, 0.018F, 0.016F};
  append(shell, make_tube("", path, radii, detail.cells(8, 4)));
  return shell;
}

Mesh make_handle(float side, const Detail& detail) {
  const float z = side_at(-0.33F, 0.70F);
  return make_rounded_box("handle", {-0.42F, 0.69F, side * z - 0.018F}, {-0.22F, 0.715F, side * z + 0.018F}, 0.01F,
                          detail.cells(2));
}

Mesh make_exhausts(const Detail& detail) {
  Mesh pipes;
  for (const float z : {-0.50F, -0.40F, 0.40F, 0.50F}) {
    const Outline o = Outline({0.036F, 0})
                          .line(0.040F, 0.10F)
                          .line(0.036F, 0.105F)
                          .line(0.032F, 0.10F)
                          .line(0.030F, 0.02F)
                          .line(0, 0.02F);
    const glm::mat4 to_rear(glm::vec4(0, 1, 0, 0), glm::vec4(-1, 0, 0, 0), glm::vec4(0, 0, 1, 0),
                            glm::vec4(-2.08F, 0.40F, z, 1));
    append(pipes, transformed(make_lathe("", o.points(), detail.cells(20, 8)), to_rear));
  }
  pipes.name = "exhausts";
  return pipes;
}

}  // namespace

std::uint64_t triangles_of_trim(const Detail& detail) {
  std::uint64_t sum = make_exhausts(detail).triangles.size();
  for (const Sheet& sheet : SheetMaker(detail).make()) sum += sheet.patch.triangles.size();
  return sum + 2 * (make_mirror(1, detail).triangles.size() + make_handle(1, detail).triangles.size());
}

void add_trim(Scene& scene, const Mesh& shell, const Mesh& cabin, std::uint32_t node, std::uint32_t lacquer,
              const Detail& detail) {
  const Material looks[] = {
      paint("tinted glass", {0.012F, 0.014F, 0.016F}, 0.32F), metal("headlight", {0.55F, 0.58F, 0.62F}, 0.45F),
      lamp("daytime light", {0.95F, 0.97F, 0.99F}),           paint("tail light", {0.35F, 0.0F, 0.0F}, 0.15F),
      paint("black plastic", {0.018F, 0.018F, 0.02F}, 0.04F), paint("gap", {0.01F, 0.006F, 0.006F}),
      metal("chrome", {0.85F, 0.86F, 0.88F}, 0.75F),          paint("number plate", {0.82F, 0.82F, 0.78F}, 0.03F)};
  const char* const names[] = {"windows",    "headlights", "daytime lights", "tail lights",
                               "black trim", "gaps",       "chrome",         "plate"};
  Mesh parts_of[static_cast<std::size_t>(Stuff::kCount)];
  for (const Sheet& sheet : SheetMaker(detail).make()) {
    append(parts_of[static_cast<std::size_t>(sheet.stuff)],
           draped(sheet.on_cabin ? cabin : shell, sheet.patch, sheet.from, sheet.lift));
  }
  const auto add = [&](Mesh mesh, std::uint32_t material) {
    hang(scene, add_instance(scene, add_mesh(scene, std::move(mesh), material)), node);
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

}  // namespace traces::car
