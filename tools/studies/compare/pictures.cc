#include <span>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "tools/analysis/picture.h"
#include "tools/studies/compare/compare.h"
#include "traces/scene/images.h"

namespace tools {
namespace {

constexpr std::uint64_t kLargestPicture = 1ULL << 30;

double squared_error(const traces::Texture& a, const traces::Texture& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    for (const unsigned shift : {0U, 8U, 16U}) {
      const auto channel = [&](std::uint32_t texel) { return static_cast<double>((texel >> shift) & 0xff) / 255; };
      const double difference = channel(a.texels[i]) - channel(b.texels[i]);
      squares += difference * difference;
    }
  }
  return squares / (3 * static_cast<double>(a.texels.size()));
}

traces::Texture read_png(const std::filesystem::path& file) {
  const std::string bytes = sim::read_file(file, kLargestPicture);
  return traces::read_image(std::as_bytes(std::span(bytes.data(), bytes.size())), file.string());
}

/// True if there is something of this name, be it a picture or not.
bool has(const ReportFile& report, const char* type) {
  std::error_code failed;
  return std::filesystem::exists(std::filesystem::symlink_status(report.picture(type), failed));
}

bool have(const ReportFile& a, const ReportFile& b, const char* type) { return has(a, type) && has(b, type); }

template <class Image>
bool same_size(const Image& a, const Image& b, Comparison& out) {
  if (a.width == b.width && a.height == b.height) return true;
  out.no_picture = fmt::format("sizes differ: {}x{} and {}x{}", a.width, a.height, b.width, b.height);
  return false;
}

}  // namespace

void compare_pictures(const ReportFile& a, const ReportFile& b, Comparison& out) {
  try {
    if (have(a, b, "exr")) {
      const traces::FloatImage of_a = traces::read_exr(a.picture("exr")), of_b = traces::read_exr(b.picture("exr"));
      if (same_size(of_a, of_b, out)) out.squared_error = mean_squared_error(of_a.rgb, of_b.rgb);
    } else if (have(a, b, "png")) {
      const traces::Texture of_a = read_png(a.picture("png")), of_b = read_png(b.picture("png"));
      if (same_size(of_a, of_b, out)) out.squared_error = squared_error(of_a, of_b);
    } else {
      out.no_picture = "not both have one";
    }
  } catch (const sim::InputError& error) {
    out.no_picture = error.what();  // the figures are good all the same
  }
}

}  // namespace tools
