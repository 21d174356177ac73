#include "tests/traces/scene/gltf_mutants.h"

#include <algorithm>
#include <climits>
#include <iterator>

#include "sim/hash.h"

namespace test {
namespace {

using nlohmann::json;

/// Random numbers that determine one mutant.
class Dice {
 public:
  explicit Dice(std::uint64_t mutant) : mutant_(mutant) {}
  std::size_t below(std::size_t limit) { return limit == 0 ? 0 : sim::hash(mutant_, count_++) % limit; }

 private:
  std::uint64_t mutant_, count_ = 0;
};

void collect(json& value, std::vector<json*>& all) {
  all.push_back(&value);
  if (value.is_structured()) {
    for (json& child : value) collect(child, all);
  }
}

/// Replaces or removes a random value of the JSON.
void edit_json(TinyGltf& file, Dice& dice) {
  static const json kValues[] = {0,
                                 1,
                                 2,
                                 3,
                                 -1,
                                 255,
                                 65536,
                                 1'000'000'000,
                                 1U << 31,
                                 UINT_MAX,
                                 1ULL << 53,
                                 1e300,
                                 -1e300,
                                 1e-300,
                                 0.5,
                                 "",
                                 "text",
                                 "TRIANGLES",
                                 nullptr,
                                 true,
                                 json::array(),
                                 json::object(),
                                 json::array({0, 0}),
                                 json::array({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16})};
  std::vector<json*> all;
  collect(file.json, all);
  json& target = *all[1 + dice.below(all.size() - 1)];
  if (target.is_object() && !target.empty() && dice.below(2) == 0) {
    auto victim = target.begin();
    std::advance(victim, static_cast<std::ptrdiff_t>(dice.below(target.size())));
    target.erase(victim);
  } else if (target.is_number_integer() && dice.below(2) == 0) {
    target = target.get<std::int64_t>() + static_cast<std::int64_t>(dice.below(9)) - 4;
  } else {
    target = kValues[dice.below(std::size(kValues))];
  }
}

void set_word(std::string& bytes, std::size_t at, std::uint32_t value) {
  if (at + sizeof value <= bytes.size()) std::memcpy(bytes.data() + at, &value, sizeof value);
}

}  // namespace

std::string mutant_of(const TinyGltf& seed, std::uint64_t number) {
  Dice dice(number);
  TinyGltf file = seed;
  switch (dice.below(6)) {
    case 0:  // flips bits in the buffer: numbers, indices, compressed data, pictures
      for (std::size_t n = 1 + dice.below(4); n > 0; --n) {
        char& byte = file.binary[dice.below(file.binary.size())];
        byte = static_cast<char>(byte ^ (1 << dice.below(8)));
      }
      return file.glb();
    case 1: {  // replaces a run of bytes in the buffer
      const std::size_t begin = dice.below(file.binary.size()), run = 1 + dice.below(16);
      for (std::size_t i = begin; i < std::min(begin + run, file.binary.size()); ++i) {
        file.binary[i] = static_cast<char>(dice.below(2) == 0 ? 0xff : dice.below(256));
      }
      return file.glb();
    }
    case 2: {  // cuts the file, with or without matching lengths in the header
      std::string bytes = file.glb();
      bytes.resize(dice.below(bytes.size()));
      if (dice.below(2) == 0) set_word(bytes, 8, static_cast<std::uint32_t>(bytes.size()));
      return bytes;
    }
    case 3: {  // sets wrong lengths, flips bits anywhere
      std::string bytes = file.glb();
      set_word(bytes, 4 * dice.below(5), static_cast<std::uint32_t>(sim::hash(number, 99) >> dice.below(32)));
      char& byte = bytes[dice.below(bytes.size())];
      byte = static_cast<char>(byte ^ (1 << dice.below(8)));
      return bytes;
    }
    default:  // changes values in the JSON
      for (std::size_t n = 1 + dice.below(3); n > 0; --n) edit_json(file, dice);
      return dice.below(2) == 0 ? file.glb() : file.text();
  }
}

}  // namespace test
