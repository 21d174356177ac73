#include "traces/scene/gltf/source.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "sim/config/quantity.h"
#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "traces/scene/glb.h"
#include "traces/scene/gltf/parse.h"
#include "traces/scene/gltf/schema.h"

namespace traces::gltf {
namespace {

/// Decodes percent escapes. If a percent sign is not followed by two hexadecimal digits, keeps it and sets `is_good` to
/// false.
std::string decode_percent(std::string_view text, bool& is_good) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* first = text.data() + i + 1;
    if (text[i] != '%') {
      out += text[i];
    } else if (i + 2 < text.size() && std::from_chars(first, first + 2, value, 16).ptr == first + 2) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += text[i];
      is_good = false;
    }
  }
  return out;
}

bool is_outside_folder(std::string_view path) {
  while (!path.empty()) {
    const std::size_t slash = path.find('/');
    if (path.substr(0, slash) == "..") return true;
    path.remove_prefix(slash == std::string_view::npos ? path.size() : slash + 1);
  }
  return false;
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

/// Checks the part of a data: URI between "data:" and the comma. Returns what is wrong, or an empty text. Sets
/// `is_base64` if that part ends with ";base64".
std::string data_uri_fault(std::string_view header, bool& is_base64) {
  std::size_t end = header.find(';');
  const std::string_view type = header.substr(0, end);
  if (!type.empty() && type.find('/') == std::string_view::npos) {
    return fmt::format("has the media type '{}', which is not type/subtype", sim::printable(type, 40));
  }
  while (end != std::string_view::npos) {
    header.remove_prefix(end + 1);
    end = header.find(';');
    const std::string_view parameter = header.substr(0, end);
    if (is_base64) return "has parameters after ;base64";
    is_base64 = equal_ignoring_case(parameter, "base64");
    if (!is_base64 && parameter.find('=') == std::string_view::npos) {
      return fmt::format("has the parameter '{}', which is neither name=value nor base64",
                         sim::printable(parameter, 40));
    }
  }
  return {};
}

/// Decodes base64 in place. Returns what is wrong, or an empty text. The '=' at the end is optional.
std::string decode_base64(std::string& text) {
  while (text.ends_with('=')) text.pop_back();
  const std::size_t size = text.size();
  const auto is_digit = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '/';
  };
  const auto wrong = std::ranges::find_if_not(text, is_digit);
  if (wrong != text.end()) {
    return fmt::format("has the character '{}' in its data, which is not base64",
                       sim::printable(std::string_view(&*wrong, 1)));
  }
  if (size % 4 == 1) return "has base64 data that ends within a byte";
  constexpr std::size_t kPiece = 1 << 20;  // a multiple of 4, which fits the int that the decoder takes
  text.append((4 - size % 4) % 4, '=');
  std::string bytes(text.size() / 4 * 3, '\0');
  for (std::size_t i = 0; i < text.size(); i += kPiece) {
    EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()) + i / 4 * 3,
                    reinterpret_cast<const unsigned char*>(text.data()) + i,
                    static_cast<int>(std::min(kPiece, text.size() - i)));
  }
  bytes.resize(size / 4 * 3 + (size % 4 == 0 ? 0 : size % 4 - 1));
  text = std::move(bytes);
  return {};
}

}  // namespace

bool is_data_uri(std::string_view uri) { return equal_ignoring_case(uri.substr(0, 5), "data:"); }

std::string data_of(std::string_view uri, std::string_view where) {
  const std::size_t comma = uri.find(',');
  std::string data, fault;
  bool is_base64 = false, is_good = true;
  if (comma == std::string_view::npos) {
    fault = "has no comma";
  } else {
    fault = data_uri_fault(uri.substr(5, comma - 5), is_base64);
    data = decode_percent(uri.substr(comma + 1), is_good);
  }
  if (!is_good) fault = "has a '%' in its data that is not followed by two hexadecimal digits";
  if (fault.empty() && is_base64) fault = decode_base64(data);
  if (fault.empty()) return data;
  throw sim::InputError(
      fmt::format("{}: the URI '{}' {}; allowed: data:[type/subtype][;name=value][;base64],DATA (RFC 2397)", where,
                  sim::printable(uri, 60), fault));
}

std::string local_path(std::string_view uri, std::string_view where) {
  bool ignored = true;
  const std::string path = decode_percent(uri, ignored);
  const char* fault = nullptr;
  if (path.empty()) {
    fault = "is empty";
  } else if (path.find_first_of(std::string_view("\\\0:", 3)) != std::string::npos) {
    fault = "is remote or not a plain path";
  } else if (path.front() == '/') {
    fault = "is absolute";
  } else if (is_outside_folder(path)) {
    fault = "leaves the file's folder";
  }
  if (fault != nullptr) {
    throw sim::InputError(
        fmt::format("{}: the URI '{}' {}; allowed are data: URIs and files in the same folder or below", where,
                    sim::printable(uri), fault));
  }
  return path;
}

namespace {

/// Reads a file of a scene. Throws InputError, which names the configuration key, if the file exceeds limits.memory.
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

std::uint32_t read_word(const std::string& bytes, std::size_t at) {
  std::uint32_t word;  // GLB is little-endian, as are all supported hosts
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// Checks the GLB header, the JSON chunk and an optional BIN chunk. Further chunks are ignored.
void check_container(Source& source) {
  constexpr std::uint32_t kJson = 0x4e4f534a, kBin = 0x004e4942;
  const std::uint64_t size = source.bytes.size();
  if (size < 20) refuse(source, fmt::format("a GLB file has at least 20 bytes, this one {}", size));
  if (read_word(source.bytes, 4) != 2) {
    refuse(source, fmt::format("GLB version {}; only 2 is supported", read_word(source.bytes, 4)));
  }
  const std::uint64_t length = read_word(source.bytes, 8);
  if (length != size) {
    refuse(source, fmt::format("the GLB header says {} bytes, the file has {}: truncated or damaged", length, size));
  }
  if (read_word(source.bytes, 16) != kJson) refuse(source, "the first chunk of a GLB file must be JSON");
  source.json_begin = 20;
  source.json_size = read_word(source.bytes, 12);
  const std::uint64_t json_end = 20 + std::uint64_t{source.json_size};
  if (json_end > size) refuse(source, "the JSON chunk is longer than the file");
  if (json_end == size) return;
  if (json_end + 8 > size || read_word(source.bytes, json_end) > size - json_end - 8) {
    refuse(source, "the chunk after the JSON is longer than the file");
  }
  if (read_word(source.bytes, json_end + 4) != kBin) refuse(source, "the second chunk of a GLB file must be BIN");
}

std::string_view json_text(const Source& source) {
  return std::string_view(source.bytes).substr(source.json_begin, source.json_size);
}

/// First bytes and names of image formats, to recognise a picture that is given as a scene.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kPictures = {
    {{"\x89PNG", "PNG"}, {"\xff\xd8\xff", "JPEG"}, {"\x76\x2f\x31\x01", "OpenEXR"}}};

void check_no_picture(const Source& source) {
  for (const auto& [begin, name] : kPictures) {
    if (!source.bytes.starts_with(begin)) continue;
    refuse(source, fmt::format("is a {} picture, not a glTF scene; allowed: .glb and .gltf files of scenes", name));
  }
}

sim::Json parse_source_json(const Source& source, std::size_t levels) {
  const std::string_view text = json_text(source);
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

/// Throws InputError if a symbolic link leads out of the scene file's folder.
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

/// Reads the files and data: URIs to which the buffers and images of a glTF file refer.
class Resources {
 public:
  Resources(Source& source, std::filesystem::path folder, Budget& budget, const SceneLimits& limits)
      : source_(source), folder_(std::move(folder)), budget_(budget), limits_(limits) {}

  /// Reads the contents of the URIs in the entries of a JSON list, and replaces each URI by its key in
  /// Source::external. tinygltf cannot read them itself: it accepts few data: URIs, decodes '+' in file names as a
  /// blank and rejects files longer than byteLength. Returns true if there were any URIs.
  bool replace_uris(sim::Json& json, const char* list) {
    const auto entries = json.find(list);
    if (entries == json.end()) return false;
    const bool is_buffers = std::string_view(list) == "buffers";
    bool any = false;
    for (std::size_t i = 0; i < entries->size(); ++i) {
      sim::Json& entry = (*entries)[i];
      const auto uri = entry.find("uri");
      const std::string where = fmt::format("{}: {}[{}]", source_.shown_name, list, i);
      if (uri == entry.end()) {
        const bool is_placeholder = entry.contains("extensions");  // a placeholder for decompressed data
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
      entry["uri"] = key;  // assigning the name may have moved the members of the entry
      source_.external.emplace(std::move(key), std::move(bytes));
      any = true;
    }
    return any;
  }

  /// Returns the SHA-256 digests of the files read, concatenated; empty if there were none.
  const std::string& file_digests() const { return digests_; }

 private:
  std::string bytes_of(const std::string& uri, const std::string& where) {
    if (is_data_uri(uri)) {
      budget_.take_memory(uri.size(), 2, where);
      return data_of(uri, where);
    }
    const std::string relative = local_path(uri, where);
    check_inside(folder_, relative, where);
    std::string bytes = read_limited(folder_ / relative, limits_);
    budget_.take_memory(bytes.size(), 2, fmt::format("the file '{}'", sim::printable(relative)));
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
  constexpr std::uint64_t kJsonExpansion = 16;  // largest number of bytes that a parsed value takes per byte of text
  Source source;
  source.shown_name = sim::printable(path.string());
  source.bytes = read_limited(path, limits);
  budget.take_memory(source.bytes.size(), 2, "the file");
  source.sha256 = sim::sha256_hex(source.bytes);
  source.json_size = source.bytes.size();
  source.binary = source.bytes.starts_with("glTF");
  if (source.binary) check_container(source);
  check_no_picture(source);
  if (source.json_size == 0) refuse(source, "the file is empty");
  budget.take_memory(source.json_size, kJsonExpansion, "the JSON");
  sim::Json json = parse_source_json(source, limits.json_depth);
  check_lists(source, json, limits);
  check_properties(json, source.shown_name);
  Resources resources(source, path.parent_path(), budget, limits);
  bool changed = resources.replace_uris(json, "buffers");
  changed |= resources.replace_uris(json, "images");
  if (!resources.file_digests().empty()) source.sha256 = sim::sha256_hex(source.sha256 + resources.file_digests());
  changed |= make_parsable(json, source.lent);
  if (changed) replace_json(source, sim::json_line(json));
  return source;
}

}  // namespace traces::gltf
