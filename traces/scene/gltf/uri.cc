#include "traces/scene/gltf/uri.h"

#include <charconv>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace traces::gltf {
namespace {

std::string decode_percent(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* first = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(first, first + 2, value, 16).ptr == first + 2) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

bool leaves_folder(std::string_view path) {
  while (!path.empty()) {
    const std::size_t slash = path.find('/');
    if (path.substr(0, slash) == "..") return true;
    path.remove_prefix(slash == std::string_view::npos ? path.size() : slash + 1);
  }
  return false;
}

}  // namespace

std::string local_path(std::string_view uri, std::string_view where) {
  const std::string path = decode_percent(uri);
  const char* fault = nullptr;
  if (path.empty()) {
    fault = "is empty";
  } else if (path.find_first_of(std::string_view("\\\0:", 3)) != std::string::npos) {
    fault = "is remote or not a plain path";
  } else if (path.front() == '/') {
    fault = "is absolute";
  } else if (leaves_folder(path)) {
    fault = "leaves the file's folder";
  }
  if (fault != nullptr) {
    throw sim::InputError(
        fmt::format("{}: the URI '{}' {}; allowed are data: URIs and files in the same folder or below", where,
                    sim::printable(uri), fault));
  }
  return path;
}

}  // namespace traces::gltf
