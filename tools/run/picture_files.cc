#include "tools/run/picture_files.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/analysis/debug_pictures.h"
#include "tools/analysis/picture.h"
#include "tools/host/parallel.h"
#include "tools/tiles/heat_map.h"
#include "traces/scene/images.h"

namespace tools {
namespace {

/// The picture files of a frame, each written by a separate job.
class PictureFiles {
 public:
  PictureFiles(const std::filesystem::path& folder, const FramePictures& of)
      : folder_(folder),
        of_(of),
        width_(of.played.inputs.config.render.width),
        height_(of.played.inputs.config.render.height) {}

  /// Returns the jobs, the slowest first.
  std::vector<std::function<void()>> write_jobs() {
    const std::vector<float>& rgb = of_.played.frame.rendered.rgb;
    if (of_.played.is_first && of_.has_picture && !of_.played.frame.is_part()) add_exr("image.exr", rgb);
    if (of_.played.is_first && of_.played.reference != nullptr)
      add_exr("reference.exr", of_.played.reference->rendered.rgb);
    if (of_.played.is_first && of_.has_picture) add_png("image.png", [&rgb] { return to_rgb8(rgb); });
    if (of_.played.is_first && of_.played.reference != nullptr) add_comparison(rgb, of_.played.reference->rendered.rgb);
    if (of_.played.inputs.frames() > 1 && of_.has_picture) {
      add_png(fmt::format("frame-{:04}.png", of_.played.inputs.frame), [&rgb] { return to_rgb8(rgb); });
    }
    if (of_.played.is_first && !of_.played.frame.is_part() && !of_.played.frame.rendered.pixels.empty()) {
      add_job(
          [this] { write_pixels(folder_ / kPixelsFile, of_.played.frame.rendered.pixels, width_, height_, notes_); });
    }
    add_debug_pictures();
    return std::move(jobs_);
  }

 private:
  void add_job(std::function<void()> job) { jobs_.push_back(std::move(job)); }
  void add_exr(const char* name, const std::vector<float>& rgb) {
    add_job([this, name, &rgb] { traces::write_exr(folder_ / name, width_, height_, rgb); });
  }
  void add_png(std::string name, std::function<std::vector<std::uint8_t>()> rgb8) {
    add_job([this, name = std::move(name), rgb8 = std::move(rgb8)] {
      traces::write_png(folder_ / name, width_, height_, rgb8());
    });
  }
  void add_comparison(const std::vector<float>& rgb, const std::vector<float>& reference) {
    add_png("reference.png", [&reference] { return to_rgb8(reference); });
    add_png("difference.png", [&rgb, &reference] { return difference_rgb8(rgb, reference); });
  }
  void add_debug_pictures() {
    const Inputs& inputs = of_.played.inputs;
    const std::string prefix = inputs.frames() > 1 ? fmt::format("frame-{:04}-", inputs.frame) : "";
    if (of_.debug && of_.played.tiles != nullptr && !of_.played.frame.rendered.pixels.empty()) {
      add_job([this, prefix] {
        write_heat_maps(folder_, prefix, heat_maps(of_.played.frame, *of_.played.tiles, width_, height_), notes_);
      });
    }
    std::vector<DebugPicture> pictures = debug_pictures(of_.program, of_.played.frame.rendered, width_, height_);
    if (of_.debug && inputs.config.render.primary == kernels::Primary::kRaster) {
      std::vector<DebugPicture> more = raster_pictures(inputs.image, inputs.camera, inputs.config.render);
      std::ranges::move(more, std::back_inserter(pictures));
    }
    for (DebugPicture& p : pictures) {
      add_job([this, prefix, p = std::move(p)] {
        traces::write_png(folder_ / fmt::format("{}debug-{}.png", prefix, p.name), p.width, p.height, p.rgb);
      });
    }
  }

  const std::filesystem::path folder_;
  const FramePictures& of_;
  const std::uint32_t width_, height_;
  const std::vector<traces::ImageNote> notes_ = notes_of(of_.played.inputs, of_.program);
  std::vector<std::function<void()>> jobs_;
};

}  // namespace

void write_pictures(const std::filesystem::path& folder, const FramePictures& of, std::size_t threads) {
  PictureFiles files(folder, of);
  const std::vector<std::function<void()>> jobs = files.write_jobs();
  parallel_for(jobs.size(), threads, [&](std::size_t i, std::size_t) { jobs[i](); });
}

}  // namespace tools
