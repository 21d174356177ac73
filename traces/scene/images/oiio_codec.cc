// The only source file that uses OpenImageIO. It is compiled into the module raywatt_images.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>

#include <OpenImageIO/color.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include "traces/scene/images/codec.h"

namespace traces {
namespace {

/// Suppresses what libpng and libjpeg print on stderr while the object exists; errors are returned as texts instead.
/// Replaces the C stream `stderr`, which glibc allows, and not its file descriptor.
class QuietLibraries {
 public:
  QuietLibraries() {
    const std::lock_guard lock(mutex_);
    static std::FILE* const nowhere = std::fopen("/dev/null", "we");
    if (users_++ == 0 && nowhere != nullptr) stderr = nowhere;
  }
  ~QuietLibraries() {
    const std::lock_guard lock(mutex_);
    if (--users_ == 0) stderr = original_stderr_;
  }
  QuietLibraries(const QuietLibraries&) = delete;
  QuietLibraries& operator=(const QuietLibraries&) = delete;

 private:
  static inline std::mutex mutex_;
  static inline std::size_t users_ = 0;
  static inline std::FILE* const original_stderr_ = stderr;
};

/// An image file in memory, opened for reading in one format.
class Input {
 public:
  Input(std::span<const std::byte> bytes, const char* format)
      : memory_(const_cast<std::byte*>(bytes.data()), bytes.size()), input_(OIIO::ImageInput::create(format)) {
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    hints.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy_);
    if (!input_) {
      error_ = OIIO::geterror();
    } else if (!input_->open("image", spec_, hints)) {
      error_ = input_->geterror();
    }
  }

  /// Returns why the image cannot be used, or an empty text.
  std::string image_problem(std::uint64_t most_pixels) const {
    if (!error_.empty()) return error_;
    if (spec_.width < 1 || spec_.height < 1 || spec_.depth > 1) return "the image has no pixels";
    const std::uint64_t pixels = static_cast<std::uint64_t>(spec_.width) * static_cast<std::uint64_t>(spec_.height);
    if (pixels > most_pixels) {
      return std::to_string(spec_.width) + " x " + std::to_string(spec_.height) + " pixels, allowed are " +
             std::to_string(most_pixels);
    }
    if (spec_.nchannels < 1 || spec_.nchannels > 4)
      return std::to_string(spec_.nchannels) + " channels, allowed are 1 to 4";
    return {};
  }

  template <class T>
  std::string read_pixels(OIIO::TypeDesc type, std::vector<T>& pixels) {
    pixels.resize(static_cast<std::size_t>(spec_.width) * static_cast<std::size_t>(spec_.height) * channel_count());
    if (input_->read_image(0, 0, 0, spec_.nchannels, type, pixels.data())) return {};
    return "damaged: " + input_->geterror();
  }

  std::size_t channel_count() const { return static_cast<std::size_t>(spec_.nchannels); }
  ImageCodec::Size size() const {
    return {static_cast<std::uint32_t>(spec_.width), static_cast<std::uint32_t>(spec_.height)};
  }

 private:
  QuietLibraries quiet_;
  OIIO::Filesystem::IOMemReader memory_;
  OIIO::Filesystem::IOProxy* proxy_ = &memory_;
  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::ImageSpec spec_;
  std::string error_;
};

class OiioCodec : public ImageCodec {
 public:
  std::string decode_image(std::span<const std::byte> bytes, const char* format, std::uint64_t most_pixels, Size& size,
                           std::vector<std::uint32_t>& rgba) const override {
    Input input(bytes, format);
    if (std::string error = input.image_problem(most_pixels); !error.empty()) return error;
    std::vector<std::uint8_t> pixels;
    if (std::string error = input.read_pixels(OIIO::TypeDesc::UINT8, pixels); !error.empty()) return error;
    size = input.size();
    const std::size_t n = input.channel_count();
    rgba.resize(pixels.size() / n);
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      const std::uint8_t* p = &pixels[i * n];
      const std::uint32_t r = p[0], g = n < 3 ? r : p[1], b = n < 3 ? r : p[2];
      const std::uint32_t a = n == 2 ? p[1] : n == 4 ? p[3] : 255;
      rgba[i] = r | (g << 8) | (b << 16) | (a << 24);
    }
    return {};
  }

  std::string decode_exr(std::span<const std::byte> bytes, std::uint64_t most_pixels, Size& size,
                         std::vector<float>& rgb) const override {
    Input input(bytes, "openexr");
    if (std::string error = input.image_problem(most_pixels); !error.empty()) return error;
    std::vector<float> pixels;
    if (std::string error = input.read_pixels(OIIO::TypeDesc::FLOAT, pixels); !error.empty()) return error;
    size = input.size();
    const std::size_t n = input.channel_count();
    rgb.resize(pixels.size() / n * 3);
    for (std::size_t i = 0; i < pixels.size() / n; ++i) {
      for (std::size_t k = 0; k < 3; ++k) rgb[i * 3 + k] = pixels[i * n + std::min(k, n - 1)];
    }
    return {};
  }

  std::string apply_colour_map(const char* map, std::span<const float> values,
                               std::vector<std::uint8_t>& rgb) const override {
    if (values.empty()) return {};
    const OIIO::ImageSpec line(static_cast<int>(values.size()), 1, 1, OIIO::TypeDesc::FLOAT);
    const OIIO::ImageBuf from(line, const_cast<float*>(values.data()));
    const OIIO::ImageBuf colours = OIIO::ImageBufAlgo::color_map(from, 0, map);
    if (colours.has_error()) return colours.geterror();
    std::vector<float> linear(3 * values.size());
    const OIIO::ROI all(0, line.width, 0, 1, 0, 1, 0, 3);
    if (!colours.get_pixels(all, OIIO::TypeDesc::FLOAT, linear.data())) return colours.geterror();
    rgb.resize(linear.size());
    std::ranges::transform(linear, rgb.begin(), [](float value) {
      return static_cast<std::uint8_t>(std::lround(255 * OIIO::linear_to_sRGB(std::clamp(value, 0.0F, 1.0F))));
    });
    return {};
  }

  std::string draw_text(const char* text, const char* font, std::uint32_t height, Size& size,
                        std::vector<std::uint8_t>& grey) const override {
    const int rows = static_cast<int>(height), baseline = rows * 3 / 4;
    const OIIO::ROI box = OIIO::ImageBufAlgo::text_size(text, rows, font);
    if (!box.defined()) return "cannot be drawn";
    OIIO::ImageBuf drawn(OIIO::ImageSpec(std::max(box.xend, 1), rows, 1, OIIO::TypeDesc::UINT8));
    constexpr float kWhite[] = {1}, kBlack[] = {0};
    if (!OIIO::ImageBufAlgo::fill(drawn, kWhite) ||
        !OIIO::ImageBufAlgo::render_text(drawn, 0, baseline, text, rows, font, kBlack)) {
      return drawn.geterror();
    }
    size = {static_cast<std::uint32_t>(drawn.spec().width), height};
    grey.resize(std::size_t{size.width} * size.height);
    return drawn.get_pixels(drawn.roi(), OIIO::TypeDesc::UINT8, grey.data()) ? "" : drawn.geterror();
  }
};

}  // namespace
}  // namespace traces

extern "C" __attribute__((visibility("default"))) const traces::ImageCodec* raywatt_image_codec_5() {
  static const traces::OiioCodec codec;
  return &codec;
}
