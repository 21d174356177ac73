#include "traces/scenes/laboratory/looks.h"

#include <cmath>
#include <string>
#include <utility>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"

namespace traces::laboratory {
namespace {

/// Chart of the elements: 18 columns, seven rows and two below, coloured by kind.
Texture chart_texture() {
  constexpr glm::vec3 kColours[] = {{0.86F, 0.36F, 0.30F}, {0.93F, 0.66F, 0.28F}, {0.95F, 0.85F, 0.45F},
                                    {0.55F, 0.76F, 0.48F}, {0.42F, 0.68F, 0.80F}, {0.60F, 0.52F, 0.78F}};
  return paint_texture("chart of the elements", 1024, 512, [&](float u, float v) {
    const glm::vec4 paper(0.95F, 0.94F, 0.90F, 1), ink(0.13F, 0.13F, 0.16F, 1);
    if (v > 0.045F && v < 0.095F && std::abs(u - 0.5F) < 0.22F) {  // the title, as bars of writing
      const auto letter = static_cast<std::uint64_t>(u * 70);
      const float in = u * 70 - static_cast<float>(letter);
      return random(letter, 51) < 0.85F && in < 0.72F ? ink : paper;
    }
    const float x = (u - 0.05F) / 0.05F, y = (v - 0.14F) / 0.09F;
    if (x < 0 || y < 0 || x >= 18 || y >= 9.3F) return paper;
    const auto column = static_cast<int>(x);
    const bool is_apart = y >= 7.3F;
    const auto row = is_apart ? static_cast<int>(y - 0.3F) : static_cast<int>(y);
    if (!is_apart && y >= 7) return paper;
    const float in_x = x - static_cast<float>(column), in_y = (is_apart ? y - 0.3F : y) - static_cast<float>(row);
    const bool is_there = is_apart   ? column >= 2 && column < 17
                          : row == 0 ? column == 0 || column == 17
                          : row < 3  ? column < 2 || column > 11
                                     : true;
    if (!is_there || in_x < 0.06F || in_y < 0.06F || in_x > 0.94F || in_y > 0.94F) return paper;
    const auto id = static_cast<std::uint64_t>(row * 18 + column);
    if (in_x > 0.24F && in_x < 0.76F && in_y > 0.30F && in_y < 0.66F) {  // a symbol
      const auto i = static_cast<std::uint64_t>(in_x * 9), j = static_cast<std::uint64_t>(in_y * 11);
      if (random(id, i, j) < 0.6F) return ink;
    }
    const int kind = is_apart ? 5 : column == 0 ? 0 : column == 1 ? 1 : column < 12 ? 2 : column < 16 ? 3 : 4;
    return glm::vec4(kColours[kind], 1);
  });
}

/// A lined page of handwritten notes.
Texture page_texture() {
  return paint_texture("page", 512, 512, [](float u, float v) {
    const float y = v * 24;
    const auto line = static_cast<std::uint64_t>(y);
    const auto letter = static_cast<std::uint64_t>(u * 90);
    const float in = y - static_cast<float>(line);
    const glm::vec4 paper(0.95F, 0.95F, 0.92F, 1);
    if (in > 0.93F) return glm::vec4(0.65F, 0.75F, 0.88F, 1);
    if (u < 0.1F || u > 0.93F || line < 2 || line > 21 || u > 0.35F + 0.6F * random(line, 71)) return paper;
    const bool is_ink =
        random(letter / 5 * 7, line, 72) < 0.8F && random(letter, line, static_cast<std::uint64_t>(in * 6)) < 0.5F;
    return is_ink && in > 0.3F ? glm::vec4(0.12F, 0.15F, 0.42F, 1) : paper;
  });
}

/// A label of a bottle, with a red edge.
Texture label_texture() {
  return paint_texture("label", 128, 128, [](float u, float v) {
    const bool is_edge = u < 0.05F || u > 0.95F || v < 0.06F || v > 0.94F;
    const bool is_writing = v > 0.22F && v < 0.8F && u > 0.12F && u < 0.88F && v * 6 - std::floor(v * 6) < 0.5F &&
                            random(static_cast<std::uint64_t>(u * 24), static_cast<std::uint64_t>(v * 6), 81) < 0.7F;
    return is_edge      ? glm::vec4(0.65F, 0.15F, 0.12F, 1)
           : is_writing ? glm::vec4(0.15F, 0.15F, 0.2F, 1)
                        : glm::vec4(0.94F, 0.92F, 0.85F, 1);
  });
}

/// Clear glass. It transmits a little less and emits a little light in place of the paths that limited depth cuts off.
Material clear_glass() {
  Material m = glass("glass", {0.93F, 0.97F, 0.98F});
  m.transmission = 0.92F;
  m.emission = {0.045F, 0.054F, 0.057F};
  return m;
}

/// A liquid. It emits the light that it would scatter, as shadow rays do not reach it through glass.
Material liquid(std::string name, const glm::vec3& colour) {
  Material m = glass(std::move(name), colour, 1.33F);
  m.transmission = 0.5F;
  m.emission = 0.42F * colour;
  return m;
}

Material burning(std::string name, const glm::vec3& emission) {
  Material m = glass(std::move(name), {0.10F, 0.22F, 0.75F}, 1.0F);
  m.transmission = 0.75F;
  m.emission = emission;
  return m;
}

}  // namespace

Looks add_looks(Scene& scene) {
  const auto add = [&scene](Material material) { return add_material(scene, std::move(material)); };
  const auto show = [&scene](Texture texture, float mirror) {
    scene.textures.push_back(std::move(texture));
    const auto index = static_cast<std::uint32_t>(scene.textures.size() - 1);
    return add_material(scene, textured(scene.textures.back().name, index, glm::vec3(1), mirror));
  };
  return {
      .steel = add(metal("steel", {0.80F, 0.81F, 0.83F}, 0.6F)),
      .iron = add(paint("cast iron", {0.10F, 0.14F, 0.17F}, 0.08F)),
      .brass = add(metal("brass", {0.92F, 0.70F, 0.36F}, 0.55F)),
      .wood = show(wood_texture("rack wood", {0.76F, 0.55F, 0.34F}, {0.56F, 0.36F, 0.20F}, 61, 256), 0.05F),
      .porcelain = add(paint("porcelain", {0.88F, 0.87F, 0.84F}, 0.10F)),
      .plastic = add(paint("white plastic", {0.80F, 0.82F, 0.84F}, 0.08F)),
      .cork = add(paint("cork", {0.55F, 0.37F, 0.21F})),
      .rubber = add(paint("red rubber", {0.52F, 0.13F, 0.08F}, 0.03F)),
      .tiles =
          show(tile_texture("wall tiles", {0.84F, 0.89F, 0.88F}, {0.80F, 0.86F, 0.86F}, {0.55F, 0.58F, 0.58F}, 8, 53),
               0.07F),
      .floor = show(
          tile_texture("floor", {0.62F, 0.58F, 0.52F}, {0.50F, 0.47F, 0.43F}, {0.33F, 0.31F, 0.29F}, 8, 55, 256), 0),
      .plaster = add(paint("plaster", {0.80F, 0.80F, 0.76F})),
      .bench = show(stone_texture("bench top", {0.30F, 0.32F, 0.34F}, {0.19F, 0.20F, 0.22F}, 54), 0.14F),
      .lacquer = add(paint("lacquered wood", {0.74F, 0.76F, 0.74F}, 0.05F)),
      .shelf = show(wood_texture("beech", {0.80F, 0.62F, 0.42F}, {0.62F, 0.44F, 0.27F}, 52, 256), 0.04F),
      .chart = show(chart_texture(), 0),
      .rail = add(paint("black wood", {0.05F, 0.045F, 0.04F}, 0.05F)),
      .daylight = add(lamp("daylight", {9, 9.4F, 10})),
      .lamp = add(lamp("ceiling lamp", {12, 11.2F, 10})),
      .page = show(page_texture(), 0),
      .label = show(label_texture(), 0),
      .stopper = add(paint("black stopper", {0.03F, 0.03F, 0.035F}, 0.08F)),
      .flame = add(burning("flame", {0.07F, 0.16F, 0.50F})),
      .inner_flame = add(burning("inner flame", {0.35F, 0.65F, 0.95F})),
      .glass = add(clear_glass()),
      .blue = add(liquid("copper sulphate", {0.05F, 0.28F, 0.85F})),
      .green = add(liquid("nickel chloride", {0.08F, 0.62F, 0.22F})),
      .orange = add(liquid("dichromate", {0.95F, 0.38F, 0.04F})),
      .violet = add(liquid("permanganate", {0.42F, 0.06F, 0.55F})),
      .pink = add(liquid("phenolphthalein", {0.92F, 0.22F, 0.48F})),
      .yellow = add(liquid("chromate", {0.95F, 0.78F, 0.08F})),
      .red = add(liquid("iron thiocyanate", {0.70F, 0.04F, 0.05F})),
      .water = add(liquid("water", {0.62F, 0.74F, 0.78F})),
      .bottles = {add(paint("amber bottle", {0.20F, 0.09F, 0.03F}, 0.16F)),
                  add(paint("blue bottle", {0.06F, 0.13F, 0.25F}, 0.16F)),
                  add(paint("green bottle", {0.10F, 0.22F, 0.12F}, 0.16F)),
                  add(paint("white bottle", {0.55F, 0.56F, 0.52F}, 0.16F))},
  };
}

}  // namespace traces::laboratory
