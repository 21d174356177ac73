#include "traces/scene/gltf/source.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/config/quantity.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "traces/scene/glb.h"
#include "traces/scene/gltf/extensions.h"
#include "traces/scene/gltf/properties.h"
#include "traces/scene/gltf/rewrite.h"
#include "traces/scene/gltf/uri.h"

namespace traces::gltf {
namespace {

/// Reads a file of a scene. Throws InputError, naming the key, if it exceeds limits.memory.
std::string read_limited(const std::filesystem::path& file, const SceneLimits& limits) {
  std::error_code failed;
  const std::uintmax_t size = std::filesystem::file_size(file, failed);
  if (!failed && size > limits.memory.bytes) {
    throw sim::InputError(
        fmt::format("{}: has {} bytes, more than limits.memory, {}; allowed: a larger one, e.g. --set "
                    "limits.memory='8 GiB'",
                    sim::printable(file.string()), size, sim::quantity_text(limits.memory.bytes, sim::byte_units())));
  }
  return sim::read_file(file, limits.memory.bytes);
}

[[noreturn]] void refuse(const Source& source, const std::string& why) {
  throw sim::InputError(source.shown_name + ": " + why);
}

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word;  // GLB is little-endian, as are all supported hosts
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// Checks the GLB header, the JSON chunk and an optional BIN chunk; further chunks are ignored.
void check_container(Source& source) {
  constexpr std::uint32_t kJson = 0x4e4f534a, kBin = 0x004e4942;
  const std::uint64_t size = source.bytes.size();
  if (size < 20) refuse(source, fmt::format("a GLB file has at least 20 bytes, this one {}", size));
  if (word_at(source.bytes, 4) != 2) {
    refuse(source, fmt::format("GLB version {}; only 2 is supported", word_at(source.bytes, 4)));
  }
  const std::uint64_t length = word_at(source.bytes, 8);
  if (length != size) {
    refuse(source, fmt::format("the GLB header says {} bytes, the file has {}: truncated or damaged", length, size));
  }
  if (word_at(source.bytes, 16) != kJson) refuse(source, "the first chunk of a GLB file must be JSON");
  source.json_begin = 20;
  source.json_size = word_at(source.bytes, 12);
  const std::uint64_t json_end = 20 + std::uint64_t{source.json_size};
  if (json_end > size) refuse(source, "the JSON chunk is longer than the file");
  if (json_end == size) return;
  if (json_end + 8 > size || word_at(source.bytes, json_end) > size - json_end - 8) {
    refuse(source, "the chunk after the JSON is longer than the file");
  }
  if (word_at(source.bytes, json_end + 4) != kBin) refuse(source, "the second chunk of a GLB file must be BIN");
}

std::string_view json_of(const Source& source) {
  return std::string_view(source.bytes).substr(source.json_begin, source.json_size);
}

/// Image formats, to recognise a picture given as a scene: first bytes and name.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kPictures = {
    {{"\x89PNG", "PNG"}, {"\xff\xd8\xff", "JPEG"}, {"\x76\x2f\x31\x01", "OpenEXR"}}};

void check_no_picture(const Source& source) {
  for (const auto& [begin, name] : kPictures) {
    if (!source.bytes.starts_with(begin)) continue;
    refuse(source, fmt::format("is a {} picture, not a glTF scene; allowed: .glb and .gltf files of scenes", name));
  }
}

sim::Json parse(const Source& source, std::size_t levels) {
  const std::string_view text = json_of(source);
  try {
    sim::Json json = sim::parse_json(text, levels);
    if (!json.is_object()) refuse(source, "the JSON must be an object");
    return json;
  } catch (const sim::JsonError& error) {
    if (error.kind == sim::JsonError::Kind::kNumberRange) refuse(source, "a number in the JSON is out of range");
    const std::string_view before = text.substr(0, error.bytes_read == 0 ? 0 : error.bytes_read - 1);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
    refuse(source, fmt::format("line {}, column {}: not valid JSON", line, before.size() - line_begin + 1));
  } catch (const sim::InputError& error) {
    refuse(source, fmt::format("the JSON {}", error.what()));
  }
}

void check_lists(const Source& source, const sim::Json& json, const SceneLimits& limits) {
  for (const auto& [key, value] : json.items()) {
    if (value.is_array() && value.size() > limits.nodes) {
      refuse(source,
             fmt::format("'{}' has {} entries, allowed are {}", sim::printable(key), value.size(), limits.nodes));
    }
  }
  const auto asset = json.find("asset");
  if (asset != json.end() && asset->is_object() && asset->contains("version") && (*asset)["version"].is_string()) {
    const std::string& version = (*asset)["version"].get_ref<const std::string&>();
    if (!version.starts_with("2.")) {
      refuse(source, "glTF version '" + sim::printable(version) + "'; supported is 2.0");
    }
  }
  const auto required = json.find("extensionsRequired");
  if (required == json.end() || !required->is_array()) return;
  for (const auto& extension : *required) {
    if (!extension.is_string() || !is_supported_extension(extension.get<std::string>())) {
      refuse(source, fmt::format("needs the extension {}, which is not supported; supported: {}",
                                 sim::printable(extension.is_string() ? extension.get<std::string>()
                                                                      : sim::json_line(extension)),
                                 supported_extensions()));
    }
  }
}

void replace_json(Source& source, std::string text) {
  source.json_size = text.size();
  if (source.binary) {
    set_glb_json(source.bytes, std::move(text));
  } else {
    source.bytes = std::move(text);
  }
}

/// Refuses symbolic links that lead out of the folder.
void check_inside(const std::filesystem::path& folder, const std::string& relative, const std::string& where) {
  std::error_code failed;
  const std::filesystem::path home = std::filesystem::canonical(folder.empty() ? "." : folder, failed);
  const std::filesystem::path file = std::filesystem::canonical(folder / relative, failed);
  if (failed) throw sim::InputError(fmt::format("{}: the file '{}' is missing", where, sim::printable(relative)));
  const auto [rest, unused] = std::mismatch(home.begin(), home.end(), file.begin(), file.end());
  if (rest != home.end()) {
    throw sim::InputError(fmt::format("{}: '{}' is a link that leads out of the file's folder; allowed are files in it",
                                      where, sim::printable(relative)));
  }
}

/// Reads the files and data: URIs of buffers and images.
class Resources {
 public:
  Resources(Source& source, std::filesystem::path folder, Budget& budget, const SceneLimits& limits)
      : source_(source), folder_(std::move(folder)), budget_(budget), limits_(limits) {}

  /// Reads the URIs of a list's entries and replaces them by keys of Source::external. Needed because tinygltf
  /// accepts few data: URIs, decodes '+' in file names as a blank and refuses files longer than byteLength. Returns true if
  /// there were any.
  bool read(sim::Json& json, const char* list) {
    const auto entries = json.find(list);
    if (entries == json.end()) return false;
    const bool is_buffers = std::string_view(list) == "buffers";
    bool any = false;
    for (std::size_t i = 0; i < entries->size(); ++i) {
      sim::Json& entry = (*entries)[i];
      const auto uri = entry.find("uri");
      const std::string where = fmt::format("{}: {}[{}]", source_.shown_name, list, i);
      if (uri == entry.end()) {
        const bool is_placeholder = entry.contains("extensions");  // for decompressed data
        if (is_buffers && !source_.binary && !is_placeholder) {
          throw sim::InputError(where + ": has no URI; allowed for the first buffer of a GLB file");
        }
        continue;
      }
      const auto asked = uri->get<std::string>();
      std::string bytes = bytes_of(asked, where);
      if (is_buffers) {
        const auto length = entry["byteLength"].get<std::uint64_t>();
        if (bytes.size() < length) {
          throw sim::InputError(
              fmt::format("{}: its URI holds {} bytes; allowed: byteLength, {}, or more", where, bytes.size(), length));
        }
        bytes.resize(length);
      }
      if (bytes.empty()) throw sim::InputError(where + ": its URI holds no bytes; allowed: 1 or more");
      if (!is_data_uri(asked) && entry.value("name", "").empty()) entry["name"] = asked;
      std::string key = fmt::format("{}-{}", list, i);
      entry["uri"] = key;  // assigning the name may have moved the entry's members
      source_.external.emplace(std::move(key), std::move(bytes));
      any = true;
    }
    return any;
  }

  /// SHA-256 digests of the files read; empty if there were none.
  const std::string& digests() const { return digests_; }

 private:
  std::string bytes_of(const std::string& uri, const std::string& where) {
    if (is_data_uri(uri)) {
      budget_.take(uri.size(), 2, where);
      return data_of(uri, where);
    }
    const std::string relative = local_path(uri, where);
    check_inside(folder_, relative, where);
    std::string bytes = read_limited(folder_ / relative, limits_);
    budget_.take(bytes.size(), 2, fmt::format("the file '{}'", sim::printable(relative)));
    if (files_.insert(relative).second) digests_ += sim::sha256_hex(bytes);
    return bytes;
  }

  Source& source_;
  const std::filesystem::path folder_;
  Budget& budget_;
  const SceneLimits& limits_;
  std::set<std::string> files_;
  std::string digests_;
};

}  // namespace

Source read_source(const std::filesystem::path& path, const SceneLimits& limits, Budget& budget) {
  constexpr std::uint64_t kJsonExpansion = 16;  // upper bound of the bytes that a parsed value takes per byte of text
  Source source;
  source.shown_name = sim::printable(path.string());
  source.bytes = read_limited(path, limits);
  budget.take(source.bytes.size(), 2, "the file");
  source.sha256 = sim::sha256_hex(source.bytes);
  source.json_size = source.bytes.size();
  source.binary = source.bytes.starts_with("glTF");
  if (source.binary) check_container(source);
  check_no_picture(source);
  if (source.json_size == 0) refuse(source, "the file is empty");
  budget.take(source.json_size, kJsonExpansion, "the JSON");
  sim::Json json = parse(source, limits.json_depth);
  check_lists(source, json, limits);
  check_properties(json, source.shown_name);
  Resources resources(source, path.parent_path(), budget, limits);
  bool changed = resources.read(json, "buffers");
  changed |= resources.read(json, "images");
  if (!resources.digests().empty()) source.sha256 = sim::sha256_hex(source.sha256 + resources.digests());
  changed |= make_parsable(json, source.lent);
  if (changed) replace_json(source, sim::json_line(json));
  return source;
}

}  // namespace traces::gltf
