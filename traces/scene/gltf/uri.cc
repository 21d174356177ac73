#include "traces/scene/gltf/uri.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace traces::gltf {
namespace {

/// Decodes percent escapes. Sets `is_good` to false, and keeps the percent sign, if two hexadecimal digits are missing.
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

bool leaves_folder(std::string_view path) {
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

/// Returns the fault of the part between "data:" and the comma, or an empty text. `is_base64`: true if it ends with
/// ";base64".
std::string fault_of_header(std::string_view header, bool& is_base64) {
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

/// Decodes base64 in place; returns the fault, or an empty text. The '=' at the end is optional.
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
  constexpr std::size_t kPiece = 1 << 20;  // a multiple of 4; the function takes an int
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
    fault = fault_of_header(uri.substr(5, comma - 5), is_base64);
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
