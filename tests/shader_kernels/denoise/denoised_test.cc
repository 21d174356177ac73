#include "shader_kernels/programs/denoise/denoised.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/programs.h"
#include "sim/error.h"
#include "tests/shader_kernels/harness.h"
#include "tests/shader_kernels/showcase.h"

namespace kernels {
namespace {

using traces::Access;
using traces::Region;
using traces::WorkNode;

/// A sequence of frames of one scene, each denoised with the history of the previous one.
struct Sequence {
  explicit Sequence(traces::Scene of, RenderConfig config = small(64, 32)) : scene(std::move(of)), render(config) {
    denoise().filter = DenoiseFilter::kAtrous;
  }
  DenoiseConfig& denoise() { return programs.denoise; }

  /// Renders the next frame. `see` receives each entry.
  std::vector<float> next(bool record, auto&& see) {
    const traces::MemoryImage image = traces::build_memory_image(scene);
    const traces::BvhTracer tracer(image);
    const RateMap rates(programs.multirate);
    const auto program = make_program(parse_program(name), {image, scene.cameras.front(), render, programs, rates,
                                                            frame++, 1, nullptr, history.get()});
    needs = program->requirements();
    tiles = program->pass_end(0);
    run_tiles(*program, tracer, record, see);
    history = program->make_history();
    return program->picture();
  }
  std::vector<float> next() {
    return next(false, [](const TileResult&) {});
  }
  /// Renders the frame `number` without a denoiser.
  std::vector<float> noisy(std::uint32_t number, std::string_view program_name = "full:1") const {
    Sequence plain(scene, render);
    plain.denoise().filter = DenoiseFilter::kOff;
    plain.frame = number;
    plain.name = program_name;
    return plain.next();
  }

  traces::Scene scene;
  RenderConfig render;
  ProgramConfig programs;
  std::string_view name = "full:1";
  std::uint32_t frame = 0, tiles = 0;
  FrameRequirements needs;
  std::shared_ptr<const DenoiseHistory> history;
};

/// Returns a wall that fills the lower half of the picture, in ambient light as bright as the background.
traces::Scene furnace(const glm::vec3& albedo) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(0.75F);
  scene.ambient = glm::vec3(0.75F);
  traces::add_object(scene, traces::make_quad("wall", {-50, -100, 0}, {100, 0, 0}, {0, 100, 0}, 1),
                     traces::add_material(scene, {.name = "matte", .base_colour = albedo}));
  scene.cameras.push_back(traces::look_at("front", {0, 0, 20}, {0, 0, 0}, 0.5F));
  return scene;
}

/// Returns a wall in the soft shadow of a bar, lit by one light.
traces::Scene penumbra() {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 1000, {.name = "matte", .base_colour = glm::vec3(0.5F)});
  add_wall(scene, 6, 3, {.name = "bar", .base_colour = glm::vec3(0.3F)});
  scene.lights.push_back({.position = {5, 4, 14}, .direction = {0, 0, -1}, .intensity = glm::vec3(300)});
  scene.cameras.push_back(traces::look_at("front", {0, 0, 20}, {0, 0, 0}, 0.5F));
  return scene;
}

RenderConfig soft(std::uint32_t width = 64, std::uint32_t height = 32) {
  RenderConfig config = small(width, height);
  config.effects = "soft_shadows";
  config.shadow_rays = 1;
  config.light_radius = 0.001;
  return config;
}

double squared_distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
  return sum / static_cast<double>(a.size());
}

TEST(Denoised, ConstantLightStaysConstantBitForBit) {
  for (const HistoryPrecision precision : {HistoryPrecision::kHalf, HistoryPrecision::kFloat}) {
    for (const std::uint32_t iterations : {0U, 1U, 5U}) {
      Sequence frames(furnace(glm::vec3(1)), small(32, 16));
      frames.denoise().history = precision;
      frames.denoise().iterations = iterations;
      for (std::uint32_t i = 0; i < 3; ++i) {
        for (const float channel : frames.next()) ASSERT_EQ(channel, 0.75F) << iterations << " in frame " << i;
      }
    }
  }
}

TEST(Denoised, AlbedoIsTakenOutAndPutBack) {
  Sequence frames(furnace({0.8F, 0.3F, 0.1F}), small(32, 16));
  const std::vector<float> plain = frames.noisy(0);
  frames.next();
  const std::vector<float> filtered = frames.next();
  for (std::size_t i = 0; i < plain.size(); ++i) ASSERT_NEAR(filtered[i], plain[i], 5e-4F) << i;
}

TEST(Denoised, HistoryIsReadAndWrittenOnce) {
  for (const auto& [precision, bytes] :
       {std::pair{HistoryPrecision::kHalf, 20U}, std::pair{HistoryPrecision::kFloat, 32U}}) {
    Sequence frames(penumbra(), soft());
    frames.denoise().history = precision;
    frames.denoise().iterations = 0;
    frames.next();
    std::set<std::uint32_t> lines;
    std::uint64_t written = 0;
    frames.next(true, [&](const TileResult& tile) {
      if (tile.tile / frames.tiles != 1) return;
      for (const Access& access : tile.work.accesses) {
        ASSERT_EQ(access.kind(), Access::Kind::kStored);
        ASSERT_LT(access.element, frames.needs.region_bytes[static_cast<std::size_t>(Region::kSamples)] / 4);
        lines.insert(access.element / 16);
      }
      for (const WorkNode& node : tile.work.nodes) {
        if (node.kind == WorkNode::Kind::kTransfer && node.to_memory) written += node.items;
      }
    });
    constexpr std::uint64_t kPixels = std::uint64_t{64} * 32;
    EXPECT_EQ(written, kPixels * bytes);
    EXPECT_EQ(lines.size() * 64, kPixels * bytes) << "a static view reads each line of its history";
  }
}

TEST(Denoised, TransfersStayInTheirRegionsAndEdgesPointBackwards) {
  Sequence frames(penumbra(), soft(25, 19));
  frames.denoise().iterations = 5;
  frames.next(true, [&](const TileResult& tile) {
    EXPECT_EQ(tile.work.after_all, tile.tile >= frames.tiles && tile.tile % frames.tiles == 0);
    for (std::uint32_t n = 0; n < tile.work.nodes.size(); ++n) {
      const WorkNode& node = tile.work.nodes[n];
      for (const traces::Edge& edge : node.inputs) EXPECT_LT(edge.node, n);
      if (node.kind != WorkNode::Kind::kTransfer) continue;
      EXPECT_LE(node.offset + node.items, frames.needs.region_bytes[static_cast<std::size_t>(node.region)]);
    }
  });
}

TEST(Denoised, WithoutIterationsThereIsNoFilter) {
  for (const std::uint32_t iterations : {0U, 3U, 5U}) {
    Sequence frames(penumbra(), soft(32, 16));
    frames.denoise().iterations = iterations;
    std::uint32_t from_tile = 0, from_memory = 0, entries = 0;
    frames.next(true, [&](const TileResult& tile) {
      entries += 1;
      for (const WorkNode& node : tile.work.nodes) {
        if (node.kind != WorkNode::Kind::kLaunch) continue;
        const std::string_view kernel = kernel_catalogue()[node.kernel].name;
        from_tile += kernel == "filter_first_light" || kernel == "filter_light" ? 1 : 0;
        from_memory += kernel == "filter_stored_light" ? 1 : 0;
      }
    });
    EXPECT_EQ(entries, frames.tiles * (3 + iterations));
    EXPECT_EQ(from_tile, frames.tiles * std::min(iterations, 3U));
    EXPECT_EQ(from_memory, frames.tiles * (iterations - std::min(iterations, 3U)));
  }
}

TEST(Denoised, AStaticViewIsTheMeanOfItsFramesUpToTheCap) {
  constexpr std::uint32_t kCap = 5;
  Sequence frames(penumbra(), soft());
  frames.denoise().history = HistoryPrecision::kFloat;
  frames.denoise().iterations = 0;
  frames.denoise().alpha = 0;
  frames.denoise().history_cap = kCap;
  std::vector<float> mean;
  for (std::uint32_t n = 1; n <= kCap + 2; ++n) {
    const std::vector<float> noisy = frames.noisy(n - 1), shown = frames.next();
    mean.resize(noisy.size());
    const float weight = 1.0F / static_cast<float>(std::min(n, kCap));
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      mean[i] += (noisy[i] - mean[i]) * weight;
      ASSERT_NEAR(shown[i], mean[i], 2e-5F) << "frame " << n << ", value " << i;
    }
  }
}

TEST(Denoised, FilterAndHistoryEachRemoveNoise) {
  Sequence frames(penumbra(), soft());
  Sequence exact = frames;
  exact.render.shadow_rays = 64;
  const std::vector<float> truth = exact.noisy(0, "full:1");
  const double noisy = squared_distance(frames.noisy(0), truth);
  EXPECT_LT(squared_distance(frames.next(), truth), 0.5 * noisy);
  Sequence unfiltered = frames;
  unfiltered.history = nullptr;
  unfiltered.frame = 0;
  unfiltered.denoise().iterations = 0;
  for (std::uint32_t i = 0; i < 7; ++i) unfiltered.next();
  EXPECT_LT(squared_distance(unfiltered.next(), truth), 0.3 * noisy) << "the mean of eight frames";
}

TEST(Denoised, AStillPictureHardlySoftensFromFrameToFrame) {
  // The history is filtered once in each frame, so that shadows would blur if weights did not follow its variance.
  Sequence frames(penumbra(), soft());
  Sequence exact = frames;
  exact.render.shadow_rays = 64;
  const std::vector<float> truth = exact.noisy(0);
  frames.denoise().iterations = 1;
  for (std::uint32_t i = 0; i < 3; ++i) frames.next();
  const double early = squared_distance(frames.next(), truth);
  for (std::uint32_t i = 0; i < 11; ++i) frames.next();
  EXPECT_LT(squared_distance(frames.next(), truth), 2 * early);
}

TEST(Denoised, ANoisyMirrorHasNoHalo) {
  RenderConfig config = small(96, 54);
  config.depth = 3;
  Sequence frames(traces::open_scene("cornell"), config);
  frames.name = "path:1";
  frames.denoise().iterations = 5;
  for (std::uint32_t i = 0; i < 7; ++i) frames.next();
  const std::vector<float> shown = frames.next();
  // Green of the wall, left and right of the mirror's last pixels in a row.
  const auto green = [&](std::size_t x) { return shown[3 * (34 * std::size_t{96} + x) + 1]; };
  EXPECT_LT(green(22), 1.15F * green(20));
  EXPECT_LT(green(43), 1.15F * green(45));
}

TEST(Denoised, PicturesDoNotDependOnTileSize) {
  std::vector<std::vector<float>> pictures;
  for (const std::uint32_t tile : {8U, 16U, 32U}) {
    RenderConfig config = soft(26, 19);
    config.tile = tile;
    Sequence frames(penumbra(), config);
    frames.denoise().iterations = 5;
    frames.next();
    pictures.push_back(frames.next());
  }
  EXPECT_EQ(pictures[0], pictures[1]);
  EXPECT_EQ(pictures[0], pictures[2]);
}

TEST(Denoised, SeveralSamplesShareAPixelsGuide) {
  Sequence frames(furnace(glm::vec3(1)));
  frames.name = "full:4";
  frames.denoise().iterations = 0;
  frames.next();
  for (const float channel : frames.next()) ASSERT_EQ(channel, 0.75F);
}

/// Returns motion in pixels of all pixels of a frame, {x, y}, and lengths of their histories.
struct Motions {
  std::vector<std::pair<float, float>> by_pixel;
  std::vector<std::uint32_t> lengths;
};
Motions motions_of(Sequence& frames) {
  const std::uint32_t width = frames.render.width;
  Motions out{std::vector<std::pair<float, float>>(std::size_t{width} * frames.render.height), {}};
  out.lengths.resize(out.by_pixel.size());
  frames.next(false, [&](const TileResult& tile) {
    for (std::uint32_t i = 0; i < tile.width * tile.height; ++i) {
      const std::size_t pixel = std::size_t{tile.y + i / tile.width} * width + tile.x + i % tile.width;
      const DenoiseRecords& records = tile.buffer.denoise;
      if (tile.tile < frames.tiles) {
        const auto moved = [](std::uint32_t steps) { return (static_cast<float>(steps) - kNoMotion) / kMotionSteps; };
        out.by_pixel[pixel] = {moved(records.motions[i] & 0xffffU), moved(records.motions[i] >> 16U)};
      } else if (tile.tile < 2 * frames.tiles) {
        out.lengths[pixel] = records.guide_words[i].normal >> 24U;
      }
    }
  });
  return out;
}

TEST(Denoised, MotionPointsToThePreviousPixelOfAMovingObject) {
  // The picture of 64 x 32 pixels shows a field of 20.4 x 10.2 at the wall and of 14.3 x 7.1 at the bar, 14 away.
  Sequence frames(penumbra(), soft());
  frames.denoise().iterations = 0;
  frames.next();
  constexpr float kMoved = 1.5F;
  for (traces::Mesh& mesh : frames.scene.meshes) {
    if (mesh.positions.front().z < 5) continue;
    for (glm::vec3& position : mesh.positions) position.x += kMoved;
  }
  const Motions found = motions_of(frames);
  const float pixel = 2 * std::tan(0.25F) / 32 * 14;
  const std::size_t at_bar = std::size_t{16} * 64 + 32 + static_cast<std::size_t>(kMoved / pixel);
  const std::size_t at_wall = std::size_t{3} * 64 + 3;
  EXPECT_NEAR(found.by_pixel[at_bar].first, -kMoved / pixel, 0.05F);
  EXPECT_NEAR(found.by_pixel[at_bar].second, 0, 1e-6F);
  EXPECT_EQ(found.by_pixel[at_wall], (std::pair{0.0F, 0.0F}));
  EXPECT_EQ(found.lengths[at_bar], 2U);
  EXPECT_EQ(found.lengths[at_wall], 2U);
  // Where the bar was, the wall appears: the history there shows the bar.
  const std::size_t uncovered = std::size_t{16} * 64 + 32 - static_cast<std::size_t>(1.2F / pixel);
  EXPECT_EQ(found.by_pixel[uncovered], (std::pair{0.0F, 0.0F}));
  EXPECT_EQ(found.lengths[uncovered], 1U);
}

TEST(Denoised, MotionOfTheCameraMovesWallAndBackground) {
  Sequence frames(furnace(glm::vec3(1)));
  frames.denoise().iterations = 0;
  frames.next();
  frames.scene.cameras.front() = traces::look_at("turned", {0, 0, 20}, {1, 0, 0}, 0.5F);
  const Motions turned = motions_of(frames);
  // The middle of the picture was tan(a) / pixel to the right of the middle, with tan(a) = 1/20.
  const float expected = 1.0F / 20 / (2 * std::tan(0.25F) / 32);
  for (const std::size_t row : {15U, 16U}) {  // background, wall
    EXPECT_NEAR(turned.by_pixel[row * 64 + 32].first, expected, 0.1F) << row;
    EXPECT_NEAR(turned.by_pixel[row * 64 + 32].second, 0, 0.05F) << row;
    EXPECT_EQ(turned.lengths[row * 64 + 32], 2U) << row;
  }
  EXPECT_EQ(turned.lengths[16 * 64 + 63], 1U) << "was outside the previous picture";
}

TEST(Denoised, WhatCannotBeDenoisedIsRefused) {
  Sequence frames(penumbra(), soft());
  frames.name = "multirate:under";
  EXPECT_THROW(frames.next(), sim::InputError);
  frames.name = "full:4";
  EXPECT_NO_THROW(frames.next());
  frames.render.effect_rate = EffectRate::kHalf;
  EXPECT_THROW(frames.next(), sim::InputError);
}

// Effects at a lower rate, whose tiles finish pixels that they share with their neighbours.

constexpr EffectRate kFilteredRates[] = {EffectRate::kHalf, EffectRate::kCheckerboard};

RenderConfig at_rate(EffectRate rate, RenderConfig config) {
  config.effect_rate = rate;
  return config;
}

TEST(DenoisedLowRate, ConstantLightStaysConstantBitForBit) {
  for (const EffectRate rate : kFilteredRates) {
    for (const char* effects : {"occlusion", "bounce"}) {
      for (const HistoryPrecision precision : {HistoryPrecision::kHalf, HistoryPrecision::kFloat}) {
        RenderConfig config = at_rate(rate, small(37, 21));
        config.effects = effects;
        config.tile = 16;
        Sequence frames(furnace(glm::vec3(1)), config);
        frames.denoise().history = precision;
        frames.denoise().iterations = 5;
        for (std::uint32_t i = 0; i < 3; ++i) {
          for (const float channel : frames.next()) ASSERT_EQ(channel, 0.75F) << effects << " in frame " << i;
        }
      }
    }
  }
}

TEST(DenoisedLowRate, WithoutHistoryAndFilterThePictureIsThatOfTheProgram) {
  for (const EffectRate rate : kFilteredRates) {
    RenderConfig config = at_rate(rate, small(67, 37));
    config.effects = "occlusion, soft_shadows, reflections, refractions";
    config.tile = 16;
    Sequence frames(showcase_scene(), config);
    frames.denoise().iterations = 0;
    frames.denoise().history = HistoryPrecision::kFloat;
    const std::vector<float> plain = frames.noisy(0), shown = frames.next();
    for (std::size_t i = 0; i < plain.size(); ++i) ASSERT_NEAR(shown[i], plain[i], 2e-6F) << i;
  }
}

TEST(DenoisedLowRate, PicturesDoNotDependOnTileSizeOrRecording) {
  for (const EffectRate rate : kFilteredRates) {
    std::vector<std::vector<float>> pictures;
    for (const std::uint32_t tile : {8U, 16U, 34U, 128U}) {
      RenderConfig config = at_rate(rate, soft(35, 19));
      config.tile = tile;
      Sequence frames(penumbra(), config);
      frames.denoise().iterations = 5;
      frames.next();
      pictures.push_back(frames.next(tile == 16, [](const TileResult&) {}));
    }
    for (const std::vector<float>& picture : pictures) EXPECT_EQ(picture, pictures[0]);
  }
}

TEST(DenoisedLowRate, GuidesAreThoseOfTheFullRate) {
  const auto moved = [](const RenderConfig& config) {
    Sequence frames(penumbra(), config);
    frames.denoise().iterations = 0;
    frames.next();
    frames.scene.cameras.front() = traces::look_at("turned", {0, 0, 20}, {1, 0, 0}, 0.5F);
    return motions_of(frames);
  };
  const Motions full = moved(soft());
  for (const EffectRate rate : kFilteredRates) {
    const Motions lower = moved(at_rate(rate, soft()));
    EXPECT_EQ(lower.by_pixel, full.by_pixel);
    EXPECT_EQ(lower.lengths, full.lengths);
  }
}

TEST(DenoisedLowRate, TransfersOfBordersAndOfTheDenoiserDoNotOverlap) {
  RenderConfig config = at_rate(EffectRate::kHalf, soft(35, 19));
  config.tile = 16;
  Sequence frames(penumbra(), config);
  frames.denoise().iterations = 5;
  std::uint64_t denoiser_end = 0, border_begin = ~std::uint64_t{0}, borders = 0;
  frames.next(true, [&](const TileResult& tile) {
    for (std::uint32_t n = 0; n < tile.work.nodes.size(); ++n) {
      const WorkNode& node = tile.work.nodes[n];
      for (const traces::Edge& edge : node.inputs) EXPECT_LT(edge.node, n);
      if (node.kind != WorkNode::Kind::kTransfer) continue;
      EXPECT_LE(node.offset + node.items, frames.needs.region_bytes[static_cast<std::size_t>(node.region)]);
      if (node.region != Region::kSamples) continue;
      // A tile of the program writes its block last.
      const bool is_border = tile.tile < frames.tiles && n + 1 != tile.work.nodes.size();
      if (is_border) {
        borders += 1;
        border_begin = std::min(border_begin, node.offset);
      } else {
        denoiser_end = std::max(denoiser_end, node.offset + node.items);
      }
    }
  });
  EXPECT_GT(borders, 0U);
  EXPECT_LE(denoiser_end, border_begin);
}

TEST(DenoisedLowRate, FilterAndHistoryEachRemoveNoise) {
  for (const EffectRate rate : kFilteredRates) {
    Sequence filtered(penumbra(), at_rate(rate, soft()));
    Sequence exact = filtered, unfiltered = filtered;
    exact.render.shadow_rays = 64;
    const std::vector<float> truth = exact.noisy(0);
    const double noisy = squared_distance(filtered.noisy(0), truth);
    filtered.denoise().iterations = 1;
    EXPECT_LT(squared_distance(filtered.next(), truth), 0.5 * noisy);
    unfiltered.denoise().iterations = 0;
    for (std::uint32_t i = 0; i < 7; ++i) unfiltered.next();
    EXPECT_LT(squared_distance(unfiltered.next(), truth), 0.3 * noisy) << "the mean of eight frames";
  }
}

}  // namespace
}  // namespace kernels
