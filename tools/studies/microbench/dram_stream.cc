#include "tools/studies/microbench/dram_stream.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"

namespace tools {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr double kLatestNs = 1e9;

std::string read_standard_input() {
  std::string text;
  std::array<char, 65536> part;
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), stdin)) {
    text.append(part.data(), n);
    if (text.size() > kMostBytes) throw sim::InputError("standard input: more than 1 GiB of requests");
  }
  if (std::ferror(stdin) != 0) throw sim::IoError("standard input: reading failed");
  return text;
}

class StreamParser {
 public:
  StreamParser(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {}

  std::vector<hw::DramRequest> parse() {
    std::vector<hw::DramRequest> requests;
    while (!rest_.empty()) {
      number_ += 1;
      const std::size_t end = rest_.find('\n');
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      line_ = line_.substr(0, line_.find('#'));
      if (const std::string_view first = word(); !first.empty()) requests.push_back(request(first));
    }
    if (requests.empty()) throw sim::InputError(fmt::format("{}: no requests; {}", name_, kAllowed));
    return requests;
  }

 private:
  static constexpr std::string_view kAllowed =
      "a line is a hexadecimal address, R or W, and if wanted an earliest time in ns, such as '0x1f40 R 12.5'";

  std::string_view word() {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    std::size_t begin = 0;
    while (begin < line_.size() && is_blank(line_[begin])) ++begin;
    std::size_t end = begin;
    while (end < line_.size() && !is_blank(line_[end])) ++end;
    const std::string_view word = line_.substr(begin, end - begin);
    line_.remove_prefix(end);
    return word;
  }

  hw::DramRequest request(std::string_view address) {
    hw::DramRequest r;
    const std::string_view kind = word(), time = word(), more = word();
    const bool prefixed = address.starts_with("0x") || address.starts_with("0X");
    const std::string_view digits = address.substr(prefixed ? 2 : 0);
    const auto [rest, bad] = std::from_chars(digits.data(), digits.data() + digits.size(), r.address, 16);
    if (bad != std::errc{} || rest != digits.data() + digits.size())
      refuse(address, "is not a hexadecimal address of at most 64 bits");
    if (kind.empty()) refuse(address, "is followed by neither R nor W");
    if (kind != "R" && kind != "W") refuse(kind, "is neither R nor W");
    r.write = kind == "W";
    if (!time.empty()) r.earliest = earliest(time);
    if (!more.empty()) refuse(more, "is one word too many");
    return r;
  }

  sim::Time earliest(std::string_view text) const {
    double ns = -1;
    const auto [rest, bad] = std::from_chars(text.data(), text.data() + text.size(), ns);
    if (bad != std::errc{} || rest != text.data() + text.size() || !(ns >= 0 && ns <= kLatestNs))
      refuse(text, "is not a time from 0 to 1e9 ns");
    return static_cast<sim::Time>(std::llround(ns * sim::kFemtosecondsPerNs));
  }

  [[noreturn]] void refuse(std::string_view word, std::string_view what) const {
    throw sim::InputError(fmt::format("{}:{}: '{}' {}; {}", name_, number_, sim::printable(word), what, kAllowed));
  }

  std::string_view rest_, line_;
  std::string name_;
  std::size_t number_ = 0;
};

}  // namespace

std::vector<hw::DramRequest> load_dram_stream(const std::string& file) {
  const std::string text = file == "-" ? read_standard_input() : sim::read_file(file, kMostBytes);
  return StreamParser(text, file == "-" ? "standard input" : file).parse();
}

}  // namespace tools
