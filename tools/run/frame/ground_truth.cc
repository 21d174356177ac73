#include "tools/run/frame/ground_truth.h"

#include <cstdlib>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/sha256.h"
#include "tools/host/build_info.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"
#include "traces/accel/embree_tracer.h"
#include "traces/scene/images.h"

namespace tools {

namespace fs = std::filesystem;

namespace {

/// Seed of the ground truth's samples. Other pictures use the frame number as seed, and no frame has this number.
constexpr std::uint32_t kOtherSeed = 0x80000000U;
constexpr std::uint64_t kDigestBytes = 4096;

/// Sets a variable to another value and restores it in the destructor.
template <class T>
class Restored {
 public:
  Restored(T& value, T meanwhile) : value_(value), before_(std::exchange(value, meanwhile)) {}
  ~Restored() { value_ = before_; }
  Restored(const Restored&) = delete;
  Restored& operator=(const Restored&) = delete;

 private:
  T& value_;
  const T before_;
};

std::string name_of(const Inputs& inputs, std::uint32_t samples) {
  const sim::Json config = sim::config_json(inputs.config);
  const glm::mat4& eye = inputs.camera.to_world;
  const std::string_view camera(reinterpret_cast<const char*>(&eye[0][0]), sizeof(float) * 16);
  sim::Sha256 key;
  key.add(build_info().model_id);
  key.add(inputs.scene_sha256);
  key.add(sim::json_line(config["scene"]));
  key.add(sim::json_line(config["render"]));
  key.add(camera);
  key.add(fmt::format("fov {} frame {} samples {}", inputs.camera.vertical_fov, inputs.frame, samples));
  return "truth-" + key.hex_digest();
}

std::string digest_of(const std::vector<float>& rgb) {
  return sim::sha256_hex({reinterpret_cast<const char*>(rgb.data()), rgb.size() * sizeof(float)});
}

std::optional<std::vector<float>> load_truth(const fs::path& picture, const fs::path& digest, std::size_t values) {
  try {
    traces::FloatImage image = traces::read_exr(picture);
    if (image.rgb.size() != values || sim::read_file(digest, kDigestBytes) != digest_of(image.rgb)) return {};
    return std::move(image.rgb);
  } catch (const sim::InputError&) {
  } catch (const sim::IoError&) {
  }
  return {};
}

void store_truth(const fs::path& picture, const fs::path& digest, const RunConfig& config,
                 const std::vector<float>& rgb) {
  try {
    std::error_code failed;
    fs::create_directories(picture.parent_path(), failed);
    traces::write_exr(picture, config.render.width, config.render.height, rgb);
    sim::write_file_atomically(digest, digest_of(rgb));
  } catch (const sim::IoError& error) {
    print_message("warning: the ground truth is not kept: {}", error.what());
  }
}

std::vector<float> render_truth(Inputs& inputs, std::uint32_t samples, std::uint32_t threads, Progress* progress) {
  const Restored<kernels::SamplePattern> pattern(inputs.config.render.samples, kernels::SamplePattern::kJittered);
  const Restored<std::uint32_t> seed(inputs.frame, inputs.frame ^ kOtherSeed);
  const traces::EmbreeTracer embree(inputs.image, host_threads(threads), is_interrupted);
  return render_frame(inputs, kernels::parse_program(fmt::format("full:{}", samples)), embree, threads,
                      {.progress = progress})
      .rgb;
}

}  // namespace

fs::path cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "raywatt";
  const char* home = std::getenv("HOME");
  if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "raywatt";
  return {};
}

std::vector<float> ground_truth(Inputs& inputs, std::uint32_t samples, std::uint32_t threads, const fs::path& cache,
                                Progress* progress) {
  if (cache.empty()) return render_truth(inputs, samples, threads, progress);
  const std::string name = name_of(inputs, samples);
  const fs::path picture = cache / (name + ".exr"), digest = cache / (name + ".sha256");
  const std::size_t values = std::size_t{inputs.config.render.width} * inputs.config.render.height * 3;
  if (std::optional<std::vector<float>> kept = load_truth(picture, digest, values)) return *std::move(kept);
  std::vector<float> rgb = render_truth(inputs, samples, threads, progress);
  store_truth(picture, digest, inputs.config, rgb);
  return rgb;
}

}  // namespace tools
