#include <cmath>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/programs/program_spec.h"
#include "sim/error.h"
#include "traces/accel/embree_tracer.h"

namespace kernels {
namespace {

/// Returns the PSNR of sRGB-encoded values with peak 1 (docs/design/methods.md).
double psnr(const Picture& a, const Picture& b) {
  const auto encode = [](double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; };
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    const double d = encode(static_cast<double>(a.rgb[i])) - encode(static_cast<double>(b.rgb[i]));
    sum += d * d;
  }
  return -10 * std::log10(sum / static_cast<double>(a.rgb.size()));
}

class Full : public testing::TestWithParam<const char*> {
 protected:
  const traces::Scene scene_ = traces::open_scene(GetParam());
  const traces::MemoryImage image_ = traces::build_memory_image(scene_);
  const traces::BvhTracer tracer_{image_};
  Picture picture(const RenderConfig& config, std::uint32_t samples = 1, bool record = false) const {
    return render(image_, scene_.cameras[0], tracer_, config, samples, record);
  }
};
INSTANTIATE_TEST_SUITE_P(BuiltIn, Full, testing::Values("cornell", "teapot"),
                         [](const auto& i) { return std::string(i.param); });

TEST_P(Full, TileSizeNeverChangesThePicture) {
  for (const SamplePattern pattern : {SamplePattern::kRegular, SamplePattern::kJittered}) {
    for (const std::uint32_t samples : {1U, 4U, 9U}) {
      RenderConfig config = small(83, 47);
      config.samples = pattern;
      const Picture reference = picture(config, samples);
      for (const std::uint32_t tile : {1U, 8U, 32U, 48U}) {
        config.tile = tile;
        EXPECT_EQ(picture(config, samples).rgb, reference.rgb) << "tile " << tile << ", full:" << samples;
      }
    }
  }
}

TEST_P(Full, ALoneSampleIsThePixelsCentreInEveryPattern) {
  RenderConfig config = small(83, 47);
  const Picture regular = picture(config), regular_four = picture(config, 4);
  config.samples = SamplePattern::kJittered;
  EXPECT_EQ(picture(config).rgb, regular.rgb);
  EXPECT_NE(picture(config, 4).rgb, regular_four.rgb);
}

TEST_P(Full, RecordingChangesNothing) {
  const Picture quiet = picture(small(64, 40), 4, false);
  const Picture recorded = picture(small(64, 40), 4, true);
  EXPECT_EQ(quiet.rgb, recorded.rgb);
  EXPECT_EQ(quiet.rays, recorded.rays);
}

TEST_P(Full, EmbreeSeesTheSamePicture) {
  const RenderConfig config = small(160, 96);
  const traces::EmbreeTracer embree(image_);
  const Picture truth = render(image_, scene_.cameras[0], embree, config);
  EXPECT_GT(psnr(picture(config), truth), 40);
}

TEST_P(Full, TilesMayRunOnManyThreads) {
  FullProgram program(image_, scene_.cameras[0], small(64, 64), 1, 0);
  std::mutex mutex;
  std::vector<std::thread> threads;
  for (std::uint32_t first = 0; first < 4; ++first) {
    threads.emplace_back([&, first] {
      TileResult tile;
      for (std::uint32_t t = first; t < program.tiles(); t += 4) {
        program.run_tile(t, tracer_, true, tile);
        const std::lock_guard lock(mutex);
        program.commit_tile(tile);
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(program.picture(), picture(small(64, 64)).rgb);
}

TEST_P(Full, MoreDepthMeansMoreRays) {
  RenderConfig config = small(64, 40);
  std::uint64_t before = 0;
  for (const std::uint32_t depth : {1U, 2U, 3U}) {
    config.depth = depth;
    const Picture p = picture(config);
    EXPECT_EQ(p.rays[0], 64U * 40U);
    EXPECT_EQ(p.rays[2] + p.rays[3] == 0, depth == 1);
    EXPECT_GT(p.rays[2] + p.rays[3] + 1, before);
    before = p.rays[2] + p.rays[3] + 1;
  }
}

TEST(FullProgram, AConstantSceneIsTheSameWithFourSamples) {
  traces::Scene scene = empty_scene();
  scene.background = {0.3F, 0.2F, 1.7F};
  scene.ambient = glm::vec3(0.7F);
  add_wall(scene, 0, 100, {.name = "matte", .base_colour = {0.9F, 0.5F, 0.1F}});
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  for (const glm::vec3 target : {glm::vec3(0), glm::vec3(0, 0, 9)}) {
    const traces::Camera camera = traces::look_at("c", {0, 0, 4}, target, 0.5F);
    EXPECT_EQ(render(image, camera, tracer, small(20, 12), 4).rgb, render(image, camera, tracer, small(20, 12), 1).rgb);
  }
}

TEST(FullProgram, PackedPixelsAreTheEncodedLinearOnes) {
  traces::Scene scene = empty_scene();
  scene.background = {0.2159F, 1.5F, 0};  // in sRGB: 0.5, above 1, and 0
  add_wall(scene, -100, 1, {});
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  const FullProgram program(image, traces::look_at("c", {0, 0, 4}, {0, 0, 9}, 0.5F), small(4, 4), 1, 0);
  TileResult tile;
  program.run_tile(0, tracer, false, tile);
  EXPECT_EQ(tile.packed[0], 0xff00ff80U);
  EXPECT_EQ(tile.linear[0].y, 1.0F);
}

TEST(FullProgram, JitterDependsOnTheFrame) {
  const traces::Scene scene = traces::open_scene("cornell");
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  RenderConfig config = small(16, 16);
  config.samples = SamplePattern::kJittered;
  const auto first_rays = [&](std::uint32_t frame) {
    const SpyTracer spy(tracer);
    TileResult tile;
    FullProgram(image, scene.cameras[0], config, 4, frame).run_tile(0, spy, false, tile);
    std::vector<glm::vec3> directions;
    for (const traces::Ray& ray : spy.seen(traces::RayKind::kPrimary)) directions.push_back(ray.direction);
    return directions;
  };
  EXPECT_EQ(first_rays(3), first_rays(3));
  EXPECT_NE(first_rays(3), first_rays(4));
}

/// Visitor that counts configuration fields and checks properties that all fields of RenderConfig must have.
struct CountFields {
  std::uint32_t count = 0;
  void operator()(const auto&, std::string_view key, std::string_view, std::string_view meaning, const sim::Limits&,
                  sim::Affects affects) {
    EXPECT_EQ(affects, sim::Affects::kFunction) << key;
    EXPECT_FALSE(meaning.empty()) << key;
    ++count;
  }
  template <class Part>
  void group(Part& part, std::string_view, std::string_view) {
    Part::describe(part, *this);
  }
};

TEST(RenderConfig, EveryFieldChangesTheWork) {
  RenderConfig config;
  CountFields fields;
  RenderConfig::describe(config, fields);
  EXPECT_EQ(fields.count, 22U + 2U) << "its own, and those of a rasteriser's work";
}

TEST(ProgramSpec, NamesAreParsed) {
  EXPECT_EQ(parse_program("full:16").samples, 16U);
  EXPECT_EQ(parse_program("full:9").name(), "full:9");
}

TEST(ProgramSpec, UnknownProgramsAreRefusedWithTheList) {
  for (const char* text :
       {"full:3", "full:", "full", "full:4x", "full:-4", "full:0", "fill:4", "", "full:99999999999", "FULL"}) {
    try {
      parse_program(text);
      ADD_FAILURE() << text;
    } catch (const sim::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("full:N"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace kernels
