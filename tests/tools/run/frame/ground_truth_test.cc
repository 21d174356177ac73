#include "tools/run/frame/ground_truth.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tools/analysis/picture.h"
#include "traces/accel/embree_tracer.h"
#include "traces/scene/images.h"

namespace test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kSamples = 16;

tools::Inputs small_cornell() {
  tools::JobOptions options;
  options.scene = "cornell";
  options.resolution = "32x16";
  return tools::load_inputs(options);
}

/// Returns the only EXR file in a cache folder of reference pictures.
fs::path picture_in(const fs::path& cache) {
  for (const auto& entry : fs::directory_iterator(cache)) {
    if (entry.path().extension() == ".exr") return entry.path();
  }
  return {};
}

TEST(GroundTruth, IsKeptAndReadAgain) {
  const TempFolder folder;
  const fs::path cache = folder.path() / "not" / "yet";
  tools::Inputs inputs = small_cornell();
  const std::vector<float> first = tools::ground_truth(inputs, kSamples, 1, cache);
  const fs::file_time_type written = fs::last_write_time(picture_in(cache));
  EXPECT_EQ(tools::ground_truth(inputs, kSamples, 1, cache), first);
  EXPECT_EQ(fs::last_write_time(picture_in(cache)), written);
  EXPECT_EQ(tools::ground_truth(inputs, kSamples, 1, {}), first) << "without a cache";
}

TEST(GroundTruth, OfAnotherViewFrameOrNumberOfSamplesHasAFileOfItsOwn) {
  const TempFolder folder;
  tools::Inputs inputs = small_cornell();
  const auto files_after = [&](std::uint32_t samples) {
    tools::ground_truth(inputs, samples, 1, folder.path());
    return names_in(folder.path()).size();
  };
  EXPECT_EQ(files_after(kSamples), 2U) << "picture and digest";
  EXPECT_EQ(files_after(4), 4U);
  inputs.frame = 1;
  EXPECT_EQ(files_after(4), 6U);
  inputs.camera.vertical_fov *= 0.5F;
  EXPECT_EQ(files_after(4), 8U);
  inputs.config.render.depth = 1;
  EXPECT_EQ(files_after(4), 10U);
}

TEST(GroundTruth, IsNotTakenFromFilesThatAreNotIt) {
  const TempFolder folder;
  tools::Inputs inputs = small_cornell();
  const std::vector<float> truth = tools::ground_truth(inputs, kSamples, 1, folder.path());
  const fs::path picture = picture_in(folder.path());
  const std::string good = read_bytes(picture);
  const std::string name = picture.filename();

  folder.write(name, "not a picture");
  EXPECT_EQ(tools::ground_truth(inputs, kSamples, 1, folder.path()), truth);
  EXPECT_EQ(read_bytes(picture), good) << "written again";

  folder.write(name, good.substr(0, good.size() / 2));
  EXPECT_EQ(tools::ground_truth(inputs, kSamples, 1, folder.path()), truth);

  traces::write_exr(picture, 32, 16, std::vector<float>(truth.size(), 0.5F));  // replaces the cached picture
  EXPECT_EQ(tools::ground_truth(inputs, kSamples, 1, folder.path()), truth);
  EXPECT_EQ(read_bytes(picture), good);

  fs::remove(fs::path(picture).replace_extension(".sha256"));
  EXPECT_EQ(tools::ground_truth(inputs, kSamples, 1, folder.path()), truth);
}

TEST(GroundTruth, HasOtherSamplesThanTheProgramItMeasures) {
  tools::Inputs inputs = small_cornell();
  const std::vector<float> truth = tools::ground_truth(inputs, kSamples, 1, {});
  inputs.config.render.samples = kernels::SamplePattern::kJittered;
  const traces::EmbreeTracer embree(inputs.image, 1);
  const std::vector<float> same_seed = tools::render_frame(inputs, kernels::parse_program("full:16"), embree, 1).rgb;
  EXPECT_GT(tools::mean_squared_error(truth, same_seed), 0);
}

TEST(GroundTruth, LeavesItsInputsAsTheyWere) {
  tools::Inputs inputs = small_cornell();
  inputs.frame = 7;
  tools::ground_truth(inputs, kSamples, 1, {});
  EXPECT_EQ(inputs.frame, 7U);
  EXPECT_EQ(inputs.config.render.samples, kernels::SamplePattern::kRegular);
}

TEST(GroundTruth, IsCachedWhereTheEnvironmentSets) {
  ::setenv("XDG_CACHE_HOME", "/a/cache", 1);
  EXPECT_EQ(tools::cache_folder(), "/a/cache/raywatt");
  ::setenv("XDG_CACHE_HOME", "not/absolute", 1);
  ::setenv("HOME", "/a/home", 1);
  EXPECT_EQ(tools::cache_folder(), "/a/home/.cache/raywatt");
  ::unsetenv("XDG_CACHE_HOME");
  ::unsetenv("HOME");
  EXPECT_EQ(tools::cache_folder(), "");
}

}  // namespace
}  // namespace test
