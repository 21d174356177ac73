#include "traces/scene/images/formats.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>
#include <utility>
#include <vector>

#include <OpenEXR/IexBaseExc.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>
#include <png.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace traces {
namespace {

/// A PNG file that is being written, with libpng's structures. libpng reports errors by longjmp, so write_picture()
/// must have no local objects with destructors.
class Writer {
 public:
  Writer()
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, this, &Writer::report_error, &Writer::ignore_warning)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~Writer() { png_destroy_write_struct(&png_, &info_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  bool write_picture(std::uint32_t width, std::uint32_t height, std::uint32_t channels, const std::uint8_t* pixels,
                     std::span<png_text> texts) {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_write_fn(png_, this, &Writer::append_bytes, nullptr);
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
  static void report_error(png_structp png, png_const_charp message) {
    static_cast<Writer*>(png_get_error_ptr(png))->error = message;
    png_longjmp(png, 1);
  }
  static void ignore_warning(png_structp, png_const_charp) {}
  static void append_bytes(png_structp png, png_bytep data, std::size_t size) {
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
  if (!writer.write_picture(width, height, channels, pixels.data(), texts))
    throw sim::IoError(fmt::format("no PNG file of {} x {} pixels: {}", width, height, sim::printable(writer.error)));
  return std::move(writer.bytes);
}

namespace {

/// An output file in memory. Seeking is possible, because OpenEXR writes the offsets of scan lines last.
class Memory : public Imf::OStream {
 public:
  Memory() : OStream("memory") {}
  void write(const char* data, int size) override {
    const auto count = static_cast<std::size_t>(size);
    if (bytes.size() < at_ + count) bytes.resize(at_ + count);
    std::memcpy(bytes.data() + at_, data, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }

  std::string bytes;

 private:
  std::size_t at_ = 0;
};

}  // namespace

std::string exr_bytes(std::uint32_t width, std::uint32_t height, std::span<const ImageChannel> channels,
                      std::span<const float> values, std::span<const ImageNote> notes) try {
  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  header.zipCompressionLevel() = 1;  // docs/design/choices.md
  for (const ImageNote& note : notes) header.insert(note.name, Imf::StringAttribute(note.text));
  Imf::FrameBuffer frame;
  std::vector<std::vector<half>> halves(channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const char* const name = channels[c].name.c_str();
    const void* first = &values[c];
    std::size_t stride = channels.size() * sizeof(float);
    if (channels[c].is_half) {
      for (std::size_t i = c; i < values.size(); i += channels.size()) halves[c].emplace_back(values[i]);
      first = halves[c].data();
      stride = sizeof(half);
    }
    const Imf::PixelType type = channels[c].is_half ? Imf::HALF : Imf::FLOAT;
    header.channels().insert(name, Imf::Channel(type));
    frame.insert(name, {type, static_cast<char*>(const_cast<void*>(first)), stride, stride * width});
  }
  Memory memory;
  {
    Imf::OutputFile file(memory, header);  // its destructor completes the file
    file.setFrameBuffer(frame);
    file.writePixels(static_cast<int>(height));
  }
  return std::move(memory.bytes);
} catch (const Iex::BaseExc& error) {
  throw sim::IoError(fmt::format("no OpenEXR file of {} x {} pixels: {}", width, height, sim::printable(error.what())));
}

namespace {

// An OpenEXR file begins with a magic number of four bytes, one byte of version and three bytes of flags.
constexpr std::size_t kFlags = 5, kHeader = 8;
constexpr int kTiledDeepOrParts = 0x02 | 0x08 | 0x10;

constexpr std::size_t kMostChannels = 4, kBytesOfChannel = 16;  // bytes of a channel's entry after its name
constexpr std::size_t kLongestName = 255;

// Attribute types of fixed size. OpenEXR reads that number of bytes, whatever size the header claims.
constexpr std::array<std::pair<std::string_view, std::size_t>, 9> kKinds = {{{"box2i", 16},
                                                                             {"chromaticities", 32},
                                                                             {"compression", 1},
                                                                             {"float", 4},
                                                                             {"int", 4},
                                                                             {"lineOrder", 1},
                                                                             {"rational", 8},
                                                                             {"timecode", 8},
                                                                             {"v2f", 8}}};

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T number{};
  if (at + sizeof number <= bytes.size()) std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

/// Removes a zero-terminated text from the front of `rest` and stores it in `text`. Returns false if there is no zero.
bool take_text(std::string_view& rest, std::string_view& text) {
  const std::size_t end = rest.find('\0');
  if (end == std::string_view::npos) return false;
  text = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return true;
}

/// Checks the channel list of an OpenEXR header. Returns what is wrong with it, or an empty text.
std::string problem_of_channels(std::string_view list) {
  std::size_t channels = 0;
  std::string_view name;
  for (; take_text(list, name) && !name.empty() && name.size() <= kLongestName; ++channels) {
    list.remove_prefix(std::min(list.size(), kBytesOfChannel));
  }
  if (!name.empty() || !list.empty()) return "damaged: the list of channels";
  return channels > kMostChannels ? fmt::format("{} channels, allowed are 1 to {}", channels, kMostChannels) : "";
}

/// Returns what is wrong with an attribute of an OpenEXR header, or an empty text: its size differs from that of its
/// type, or raywatt does not write this type.
std::string problem_of_kind(std::string_view kind, std::size_t size) {
  if (kind == "string" || kind == "chlist") return {};
  const auto* found = std::ranges::find(kKinds, kind, &std::pair<std::string_view, std::size_t>::first);
  if (found == kKinds.end()) return fmt::format("an attribute of the kind '{}'", sim::printable(kind));
  return found->second == size ? "" : fmt::format("damaged: a {} of {} bytes", kind, size);
}

/// Returns what is wrong with the data window (two inclusive corners) of an OpenEXR header, or an empty text.
std::string problem_of_window(std::string_view box, std::uint64_t most_pixels) {
  const auto side = [&](std::size_t at) {
    return std::int64_t{number_at<std::int32_t>(box, at + 8)} - number_at<std::int32_t>(box, at) + 1;
  };
  const std::int64_t width = side(0), height = side(4);
  if (width < 1 || height < 1) return "the image has no pixels";
  const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  return pixels > most_pixels ? fmt::format("{} x {} pixels, allowed are {}", width, height, most_pixels) : "";
}

}  // namespace

std::string exr_problem(std::string_view file, std::uint64_t most_pixels) {
  if (file.size() < kHeader) return "damaged: ends early";
  if ((file[kFlags] & kTiledDeepOrParts) != 0) return "tiled, deep or of several parts; allowed: one part of lines";
  std::string_view rest = file.substr(kHeader), name, kind;
  std::string problem;
  while (problem.empty()) {
    if (!take_text(rest, name)) return "damaged: ends early";
    if (name.empty()) break;
    if (!take_text(rest, kind) || rest.size() < sizeof(std::uint32_t)) return "damaged: ends early";
    const auto size = number_at<std::uint32_t>(rest, 0);
    rest.remove_prefix(sizeof size);
    if (size > rest.size()) return "damaged: an attribute is longer than the file";
    const std::string_view value = rest.substr(0, size);
    if (name.size() > kLongestName) return "damaged: a name without an end";
    problem = problem_of_kind(kind, size);
    if (kind == "chlist") problem = problem_of_channels(value);
    if (name == "dataWindow" && problem.empty()) problem = problem_of_window(value, most_pixels);
    rest.remove_prefix(size);
  }
  return problem;
}

}  // namespace traces
