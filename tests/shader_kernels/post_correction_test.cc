#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "block_harness.h"
#include "sim/hash.h"
#include "tests/full_size.h"

// Tests of post-correction along thin objects that only some samples hit.

namespace kernels {
namespace {

constexpr std::uint32_t kSide = 48;  // side of the picture in pixels
constexpr std::uint32_t kRods = 60;

/// Returns a red rod before a blue wall, at a random position and angle.
Stage rod_of(std::uint32_t seed, float pixels_thick) {
  constexpr float kFov = 0.5F;
  const float pixel = 2 * 4 * std::tan(0.5F * kFov) / kSide;
  const auto random = [seed](std::uint32_t draw) { return sim::hash_to_unit_float(sim::hash(seed, draw)); };
  const float angle = 2 * std::numbers::pi_v<float> * random(0);
  const glm::vec3 along(std::cos(angle), std::sin(angle), 0), across(-along.y, along.x, 0);
  const glm::vec3 middle = across * (pixel * (random(1) - 0.5F) * 0.5F * kSide);
  const float length = 40 * pixel, thickness = pixels_thick * pixel;
  traces::Scene scene = empty_scene();
  add_wall(scene, -1, 20, {.base_colour = glm::vec3(0), .emission = {0, 0, 0.5F}});
  traces::add_object(scene,
                     traces::make_quad("rod", middle - along * (0.5F * length) - across * (0.5F * thickness),
                                       along * length, across * thickness, 1),
                     traces::add_material(scene, {.base_colour = glm::vec3(0), .emission = {0.5F, 0, 0}}));
  return Stage(scene, traces::look_at("c", {0, 0, 4}, {0, 0, 0}, kFov));
}

struct Recovered {
  std::uint64_t lost = 0, found = 0;
  double share() const { return lost == 0 ? 1 : static_cast<double>(found) / static_cast<double>(lost); }
  void operator+=(const Recovered& other) {
    lost += other.lost;
    found += other.found;
  }
};

bool shows_rod(const Sampled& picture, std::size_t pixel) { return picture.rgb[3 * pixel] > 0.25F; }

UndersampleConfig scanning(Correction scans, Neighbourhood neighbours = Neighbourhood::kFour) {
  UndersampleConfig config;
  config.correction = scans;
  config.neighbours = neighbours;
  return config;
}

/// A picture of a rod, fully traced, and undersampled without correction.
struct Rod {
  Rod(std::uint32_t seed, float pixels_thick)
      : stage(rod_of(seed, pixels_thick)),
        truth(stage.full(render)),
        without(stage.undersample(render, scanning(Correction::kOff))) {}
  const RenderConfig render = small(kSide, kSide);
  const Stage stage;
  const Sampled truth, without;

  /// True if any traced sample hits the rod. Otherwise no correction scan can find it.
  bool met() const {
    for (std::size_t pixel = 0; pixel < kSide * kSide; ++pixel) {
      if (shows_rod(without, pixel)) return true;
    }
    return false;
  }
  /// Counts the pixels of the rod that are lost without correction, and those that the correction recovers.
  Recovered recovered(const UndersampleConfig& config) const {
    const Sampled with = stage.undersample(render, config);
    Recovered out;
    for (std::size_t pixel = 0; pixel < kSide * kSide; ++pixel) {
      const bool is_lost = shows_rod(truth, pixel) && !shows_rod(without, pixel);
      out.lost += is_lost ? 1 : 0;
      out.found += is_lost && shows_rod(with, pixel) ? 1 : 0;
    }
    return out;
  }
};

/// Targets: correction recovers 95 % of lost pixels, and 98 % on rods that a sample hits. No sample hits a rod along a
/// row without references, so no scan can find it; such a rod loses more pixels than ten others. Sixty rods therefore
/// give a poor estimate (tests/validation/DEVIATIONS.md, A5).
TEST(PostCorrection, FourScansRecoverRodsThickerThanAPixel) {
  const std::uint32_t many = test::full_or(100U, 15U) * kRods;
  Recovered all, met;
  for (std::uint32_t seed = 0; seed < many; ++seed) {
    const Rod rod(seed, 1.3F + 0.5F * static_cast<float>(seed % kRods) / (kRods - 1));
    const Recovered of = rod.recovered(scanning(Correction::kFour));
    all += of;
    if (rod.met()) met += of;
  }
  EXPECT_GT(all.lost, 5 * many) << "blocks of 2 lose a part of such rods";
  EXPECT_GE(all.share(), 0.95);
  EXPECT_GE(met.share(), 0.98);
  RecordProperty("lost", std::to_string(all.lost));
  RecordProperty("recovered", fmt::format("{:.4f}", all.share()));
  RecordProperty("recovered_of_rods_met", fmt::format("{:.4f}", met.share()));
  fmt::print("recovered {:.4f} of {} pixels of {} rods, {:.4f} of rods that were met\n", all.share(), all.lost, many,
             met.share());
}

TEST(PostCorrection, ThinnerRodsAreRecoveredLess) {
  const std::array<UndersampleConfig, 4> ways = {scanning(Correction::kTwo), scanning(Correction::kFour),
                                                 scanning(Correction::kTwo, Neighbourhood::kEight),
                                                 scanning(Correction::kFour, Neighbourhood::kEight)};
  fmt::print("{:>9}{:>8}{:>8}{:>8}{:>8}{:>8}\n", "thickness", "lost", "2 of 4", "4 of 4", "2 of 8", "4 of 8");
  double before = 0;
  for (const float thickness : {0.5F, 0.75F, 1.0F, 1.2F}) {
    std::array<Recovered, 4> of;
    for (std::uint32_t seed = 0; seed < kRods / 2; ++seed) {
      const Rod rod(seed, thickness);
      for (std::size_t way = 0; way < ways.size(); ++way) of[way] += rod.recovered(ways[way]);
    }
    fmt::print("{:>9.2f}{:>8}{:>8.3f}{:>8.3f}{:>8.3f}{:>8.3f}\n", thickness, of[0].lost, of[0].share(), of[1].share(),
               of[2].share(), of[3].share());
    EXPECT_LE(of[0].share(), of[1].share()) << "more scans find no less";
    EXPECT_LE(of[2].share(), of[3].share());
    EXPECT_LE(of[1].share(), of[3].share()) << "nor do more neighbours";
    EXPECT_GE(of[1].share(), before) << thickness;
    before = of[1].share();
  }
}

TEST(PostCorrection, ItsChangesAreTracedAndCounted) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const Stage rod = rod_of(seed, 1.4F);
    const RenderConfig render = small(kSide, kSide);
    const Sampled truth = rod.full(render), without = rod.undersample(render, scanning(Correction::kOff)),
                  with = rod.undersample(render, scanning(Correction::kFour));
    std::uint64_t changed = 0;
    for (std::size_t i = 0; i < truth.rgb.size(); ++i) {
      if (with.rgb[i] == without.rgb[i]) continue;
      changed += i % 3 == 0 ? 1 : 0;
      EXPECT_EQ(with.rgb[i], truth.rgb[i]);
    }
    EXPECT_GE(with.sampling.correction, changed);
    EXPECT_EQ(without.sampling.correction, 0U);
    EXPECT_EQ(with.sampling.traced, without.sampling.traced + with.sampling.correction);
    EXPECT_EQ(with.rays[0], without.rays[0] + with.sampling.correction);
  }
}

TEST(PostCorrection, PixelsOfManySamplesAreAveragedAgain) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const Stage rod = rod_of(seed, 0.75F);  // the rod is 1.5 samples thick
    UndersampleConfig config = scanning(Correction::kFour);
    const Sampled pixels = rod.undersample(small(2 * kSide, 2 * kSide), config);
    config.samples = 4;
    const Sampled samples = rod.undersample(small(kSide, kSide), config);
    EXPECT_GT(samples.sampling.correction, 0U);
    for (std::size_t i = 0; i < samples.rgb.size(); ++i) {
      const std::size_t channel = i % 3, x = i / 3 % kSide, y = i / 3 / kSide;
      const auto at = [&](std::size_t dx, std::size_t dy) {
        return pixels.rgb[3 * ((2 * y + dy) * 2 * kSide + 2 * x + dx) + channel];
      };
      EXPECT_EQ(samples.rgb[i], (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) * 0.25F);
    }
  }
}

/// Scans a picture of one row or column, one letter per sample. `how`: R reference, I interpolated, T traced. `what`:
/// the shown identity. `truth`: the identity that tracing would find. Returns the identities after the scan.
std::string scanned(const std::string& how, const std::string& what, const std::string& truth,
                    const PostCorrection::Scan& scan, std::uint32_t* suspects = nullptr) {
  const auto length = static_cast<std::uint32_t>(how.size());
  const std::uint32_t width = scan.is_along_y ? 1 : length, height = scan.is_along_y ? length : 1;
  PostCorrection correction(scanning(Correction::kFour), width, height, 16);
  for (std::uint32_t first = 0; first < length; first += 16) {
    const std::uint32_t part = std::min(16U, length - first);
    SampleTile at;
    at.x = scan.is_along_y ? 0 : first;
    at.y = scan.is_along_y ? first : 0;
    at.width = scan.is_along_y ? 1 : part;
    at.height = scan.is_along_y ? part : 1;
    TileResult tile;
    for (std::uint32_t i = 0; i < part; ++i) {
      const char c = how[first + i];
      const std::uint32_t kind = c == 'I' ? kInterpolatedSample : c == 'T' ? kTracedSample : 0;
      const auto shown = static_cast<std::uint32_t>(what[first + i]);
      tile.shown.push_back({shown | kind, glm::vec3(static_cast<float>(shown) / 256, 0, 0)});
    }
    correction.store_samples(tile, at);
  }
  const auto& all = correction.run_scan(scan, [&](std::span<const PostCorrection::Suspect> found) {
    PostCorrection::SuspectResults out;
    for (const PostCorrection::Suspect& s : found) {
      const char c = truth[s.x + s.y];
      out.identities.push_back(static_cast<std::uint32_t>(c) | kTracedSample);
      out.colours.emplace_back(static_cast<float>(c) / 256, 0, 0);
    }
    return out;
  });
  if (suspects != nullptr) *suspects = static_cast<std::uint32_t>(all.size());
  std::string shown;
  for (std::uint32_t i = 0; i < length; ++i) {
    shown += static_cast<char>(correction.sample_colour(scan.is_along_y ? 0 : i, scan.is_along_y ? i : 0).x * 256);
  }
  return shown;
}

TEST(PostCorrection, AScanFollowsItsFindsAndStopsAtAMistake) {
  for (const bool along_y : {false, true}) {
    const PostCorrection::Scan forward{along_y, false}, backward{along_y, true};
    std::uint32_t suspects = 0;
    EXPECT_EQ(scanned("RTIIIIR", "abaaaaa", "abbbaaa", forward, &suspects), "abbbaaa");
    EXPECT_EQ(suspects, 3U) << "the last of them shows what was thought";
    EXPECT_EQ(scanned("RTIIIIR", "abaaaaa", "abbbaaa", backward, &suspects), "abaaaaa") << "it looks the other way";
    EXPECT_EQ(suspects, 0U);
    EXPECT_EQ(scanned("RIIITR", "aaaaba", "aabbba", backward), "aabbba");
    EXPECT_EQ(scanned("RIRIR", "aabbb", "aaabb", forward, &suspects), "aabbb") << "references make no suspects";
    EXPECT_EQ(suspects, 0U);
    EXPECT_EQ(scanned("TTITI", "aaaba", "aaaba", forward, &suspects), "aaaba") << "alike, then a traced one";
    EXPECT_EQ(suspects, 1U);
    EXPECT_EQ(scanned(std::string("RT") + std::string(30, 'I'), std::string("ab") + std::string(30, 'a'),
                      std::string("a") + std::string(31, 'b'), forward, &suspects),
              std::string("a") + std::string(31, 'b'))
        << "over the edge of a tile";
    EXPECT_EQ(suspects, 30U);
  }
}

/// Returns thin slanted bars close to each other, with nothing behind them.
Stage fence() {
  traces::Scene scene = empty_scene();
  const std::uint32_t wood = traces::add_material(scene, {.base_colour = glm::vec3(0), .emission = {0.5F, 0, 0}});
  for (int i = -9; i <= 9; ++i) {
    const float x = 0.13F * static_cast<float>(i);
    traces::add_object(scene, traces::make_quad("bar", {x, -1.2F, 0}, {0.055F, 0, 0}, {0.3F, 2.4F, 0}, 1), wood);
  }
  return Stage(scene, traces::look_at("c", {0, 0, 4}, {0, 0, 0}, 0.5F));
}

TEST(PostCorrection, ManyCorrectedSamplesMoveNoMoreThanTheirTile) {
  const Stage stage = fence();
  for (const std::uint32_t samples : {1U, 4U}) {
    UndersampleConfig config = scanning(Correction::kFour, Neighbourhood::kEight);
    config.samples = samples;
    const RenderConfig render = small(32, 32);
    UndersampleProgram program(stage.image, stage.camera, render, config, stage.size(), 0);
    const Sampled run = run_program(program, stage.tracer, config.pixel_grid_side(), true);
    EXPECT_GT(run.sampling.correction, 32U * 32U / 16) << "lines of the picture";
    const FrameRequirements requirements = program.requirements();
    for (const traces::TileWork& work : run.works) {
      for (const traces::WorkNode& node : work.nodes) {
        if (node.kind != traces::WorkNode::Kind::kTransfer) continue;
        EXPECT_LE(node.offset + node.items, requirements.region_bytes[static_cast<std::size_t>(node.region)])
            << "tile " << work.tile << ", region " << static_cast<int>(node.region);
        if (node.region == traces::Region::kPicture) {
          EXPECT_LE(node.items, 16U * 16 / samples * kPixelBytes);
        }
      }
    }
  }
}

TEST(PostCorrection, SamplesThatItTracesMayHitNothing) {
  const Stage stage = fence();
  const Sampling with = stage.undersample(small(32, 32), scanning(Correction::kFour)).sampling,
                 without = stage.undersample(small(32, 32), scanning(Correction::kOff)).sampling;
  EXPECT_EQ(with.background, without.background);
  EXPECT_GT(with.traced_background, without.traced_background);
  EXPECT_LT(with.traced_background - without.traced_background, with.correction);
}

TEST(PostCorrection, WithoutScansThereIsNoSecondPass) {
  const Stage rod = rod_of(1, 1.4F);
  const auto program = [&](Correction scans) {
    return UndersampleProgram(rod.image, rod.camera, small(kSide, kSide), scanning(scans), rod.size(), 0).tiles();
  };
  EXPECT_EQ(program(Correction::kOff), 9U);
  EXPECT_EQ(program(Correction::kTwo), 3 * 9U);
  EXPECT_EQ(program(Correction::kFour), 5 * 9U);
}

}  // namespace
}  // namespace kernels
