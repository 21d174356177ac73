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

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/images/writers.h"

namespace traces {
namespace {

/// A file in memory. Seekable, as the library writes the offsets of lines last.
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

}  // namespace traces
