#include "tests/fuzz/trace_work.h"

#include <random>
#include <vector>

#include <nlohmann/json.hpp>

#include "sim/io/json.h"
#include "tests/fuzz/common.h"
#include "tests/fuzz/trace_reading.h"
#include "traces/trace_file/format.h"
#include "traces/trace_file/packing.h"

// Fuzz target: the content of a trace's blocks, which this target compresses with valid checksums and offsets.

namespace {

using Json = nlohmann::ordered_json;
using Parts = std::vector<std::string>;

Parts split(std::string_view bytes) {
  Parts parts;
  for (std::size_t end = 0; end != std::string_view::npos;) {
    end = bytes.find(fuzz::kBetween);
    parts.emplace_back(bytes.substr(0, end));
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + fuzz::kBetween.size());
  }
  return parts;
}

std::string joined(const Parts& parts) {
  std::string all = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) all.append(fuzz::kBetween).append(parts[i]);
  return all;
}

std::string number(std::uint64_t value, int bytes) {
  std::string out;
  for (; bytes > 0; --bytes, value >>= 8) out += static_cast<char>(value & 0xff);
  return out;
}

class File {
 public:
  explicit File(const std::string& header) {
    const std::string packed(packer_.pack_block(header));
    bytes_.append(traces::kTraceMagic).append(number(packed.size(), 4)).append(packed);
  }

  /// Appends a compressed block and returns its offset and size as JSON.
  Json put(const std::string& content) {
    const std::string_view packed = packer_.pack_block(content);
    Json range = {{"offset", bytes_.size()}, {"bytes", packed.size()}};
    bytes_.append(packed);
    return range;
  }
  std::string finished(const std::string& contents) {
    const Json range = put(contents);
    const std::uint64_t offset = range["offset"], size = range["bytes"];
    return bytes_.append(number(offset, 8)).append(number(size, 4)).append(traces::kTraceEnd);
  }

 private:
  traces::Packer packer_;
  std::string bytes_;
};

/// Sets the block positions of all trees and frames in the contents to those of the existing tree and tiles.
void set_ranges(Json& contents, const Json& tree, const Json& tiles) {
  if (!contents.is_object()) return;
  for (const auto& [key, ranges] : {std::pair("trees", &tree), std::pair("parts", &tiles)}) {
    if (!contents.contains(key) || !contents[key].is_array()) continue;
    for (Json& entry : contents[key]) {
      if (entry.is_object()) entry.update(*ranges);
    }
  }
}

std::string trace_of(const Parts& parts) {
  File file(parts[0]);
  const Json tree = file.put(parts[2]);
  std::string sizes;
  std::uint64_t first = 0;
  for (std::size_t i = 3; i < parts.size(); ++i) {
    const Json range = file.put(parts[i]);
    if (i == 3) first = range["offset"];
    sizes += number(range["bytes"].get<std::uint64_t>(), 4);
  }
  const Json tiles = {{"offset", first}, {"tiles", parts.size() - 3}, {"sizes", file.put(sizes)}};
  if (sim::is_nested_deeper(parts[1], sim::kDeepestJson)) return file.finished(parts[1]);
  Json contents = Json::parse(parts[1], nullptr, false);
  if (contents.is_discarded()) return file.finished(parts[1]);
  set_ranges(contents, tree, tiles);
  return file.finished(contents.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  Parts parts = split(fuzz::text_of(data, size));
  std::minstd_rand random(seed);
  const std::size_t which = random() % parts.size();
  std::string& part = parts[which];
  if (which < 2 && random() % 4 != 0) {
    part = fuzz::mutated_json(part, static_cast<unsigned>(random()));
    if (part.empty()) return LLVMFuzzerMutate(data, size, most);
  } else if (which >= 3 && random() % 16 == 0) {
    parts.push_back(std::string(part));
  } else {
    part = fuzz::mutated_bytes(part, 16);
  }
  return fuzz::replace(data, size, most, joined(parts));
}

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Parts parts = split(fuzz::text_of(data, size));
  if (parts.size() < 4) return 0;
  fuzz::read_trace(fuzz::file_of(trace_of(parts), "input.trace"));
  return 0;
}
