#include <csetjmp>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <png.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/images/writers.h"

namespace traces {
namespace {

/// A PNG file being written, with libpng's structures. libpng reports errors by longjmp, so write() holds nothing to
/// destroy.
class Writer {
 public:
  Writer() : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, this, &Writer::fail, &Writer::ignore)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~Writer() { png_destroy_write_struct(&png_, &info_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  bool write(std::uint32_t width, std::uint32_t height, std::uint32_t channels, const std::uint8_t* pixels,
             std::span<png_text> texts) {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_write_fn(png_, this, &Writer::append, nullptr);
    png_set_IHDR(png_, info_, width, height, 8, channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(png_, info_, PNG_sRGB_INTENT_ABSOLUTE);
    png_set_text(png_, info_, texts.data(), static_cast<int>(texts.size()));
    png_write_info(png_, info_);
    for (std::uint32_t y = 0; y < height; ++y) png_write_row(png_, pixels + std::size_t{y} * width * channels);
    png_write_end(png_, info_);
    return true;
  }

  std::string bytes;
  std::string error = "no memory";

 private:
  static void fail(png_structp png, png_const_charp message) {
    static_cast<Writer*>(png_get_error_ptr(png))->error = message;
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}
  static void append(png_structp png, png_bytep data, std::size_t size) {
    static_cast<Writer*>(png_get_io_ptr(png))->bytes.append(reinterpret_cast<const char*>(data), size);
  }

  png_structp png_;
  png_infop info_ = nullptr;
};

}  // namespace

std::string png_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                      std::span<const std::uint8_t> pixels, std::span<const ImageNote> notes) {
  std::vector<png_text> texts;
  for (const ImageNote& note : notes) {
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = const_cast<char*>(note.name.c_str());
    text.text = const_cast<char*>(note.text.c_str());
    texts.push_back(text);
  }
  Writer writer;
  if (!writer.write(width, height, channels, pixels.data(), texts))
    throw sim::IoError(fmt::format("no PNG file of {} x {} pixels: {}", width, height, sim::printable(writer.error)));
  return std::move(writer.bytes);
}

}  // namespace traces
