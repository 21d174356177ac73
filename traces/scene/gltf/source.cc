#include "traces/scene/gltf/source.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "traces/scene/gltf/compressed/rewrite.h"
#include "traces/scene/gltf/extensions.h"
#include "traces/scene/gltf/properties.h"
#include "traces/scene/gltf/uri.h"

namespace traces::gltf {
namespace {

[[noreturn]] void refuse(const Source& source, const std::string& why) {
  throw sim::InputError(source.shown_name + ": " + why);
}

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word;  // GLB is little-endian, as are all machines this runs on
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// Header, JSON chunk, then an optional BIN chunk; further chunks are left alone.
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

nlohmann::json parse(const Source& source, std::size_t levels) {
  const std::string_view text = json_of(source);
  try {
    nlohmann::json json = sim::parse_json<nlohmann::json>(text, levels);
    if (!json.is_object()) refuse(source, "the JSON must be an object");
    return json;
  } catch (const nlohmann::json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte == 0 ? 0 : error.byte - 1);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
    refuse(source, fmt::format("line {}, column {}: not valid JSON", line, before.size() - line_begin + 1));
  } catch (const nlohmann::json::exception&) {
    refuse(source, "a number in the JSON is out of range");
  } catch (const sim::InputError& error) {
    refuse(source, fmt::format("the JSON {}", error.what()));
  }
}

void check_lists(const Source& source, const nlohmann::json& json, const SceneLimits& limits) {
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
      refuse(source,
             fmt::format("needs the extension {}, which is not supported; supported: {}",
                         sim::printable(extension.is_string() ? extension.get<std::string>() : extension.dump()),
                         supported_extensions()));
    }
  }
}

/// Puts other JSON in the place of the file's.
void replace_json(Source& source, std::string text) {
  while (text.size() % 4 != 0) text += ' ';
  source.bytes.replace(source.json_begin, source.json_size, text);
  source.json_size = text.size();
  if (!source.binary) return;
  const auto set_word = [&](std::size_t at, std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    std::memcpy(source.bytes.data() + at, &word, sizeof word);
  };
  set_word(8, source.bytes.size());
  set_word(12, text.size());
}

/// Follows symbolic links, which must not lead out of the folder either.
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

void read_external(Source& source, const nlohmann::json& json, const std::filesystem::path& folder, Budget& budget,
                   const SceneLimits& limits) {
  for (const char* list : {"buffers", "images"}) {
    const auto entries = json.find(list);
    if (entries == json.end() || !entries->is_array()) continue;
    for (std::size_t i = 0; i < entries->size(); ++i) {
      const auto& entry = (*entries)[i];
      if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
      const std::string& uri = entry["uri"].get_ref<const std::string&>();
      if (uri.starts_with("data:")) continue;
      const std::string where = fmt::format("{}: {}[{}]", source.shown_name, list, i);
      const std::string relative = local_path(uri, where);
      if (source.external.contains(relative)) continue;
      check_inside(folder, relative, where);
      std::string bytes = sim::read_file(folder / relative, limits.memory.bytes);
      budget.take(bytes.size(), 2, fmt::format("the file '{}'", sim::printable(relative)));
      source.sha256 += sim::sha256_hex(bytes);
      source.external.emplace(relative, std::move(bytes));
    }
  }
  if (!source.external.empty()) source.sha256 = sim::sha256_hex(source.sha256);
}

}  // namespace

Source read_source(const std::filesystem::path& path, const SceneLimits& limits, Budget& budget) {
  constexpr std::uint64_t kJsonExpansion = 16;  // bytes that a parsed value may take for each of its text
  Source source;
  source.shown_name = sim::printable(path.string());
  source.bytes = sim::read_file(path, limits.memory.bytes);
  budget.take(source.bytes.size(), 2, "the file");
  source.sha256 = sim::sha256_hex(source.bytes);
  source.json_size = source.bytes.size();
  source.binary = source.bytes.starts_with("glTF");
  if (source.binary) check_container(source);
  if (source.json_size == 0) refuse(source, "the file is empty");
  budget.take(source.json_size, kJsonExpansion, "the JSON");
  nlohmann::json json = parse(source, limits.json_depth);
  check_lists(source, json, limits);
  check_properties(json, source.shown_name);
  read_external(source, json, path.parent_path(), budget, limits);
  if (make_parsable(json)) replace_json(source, json.dump());
  return source;
}

}  // namespace traces::gltf
