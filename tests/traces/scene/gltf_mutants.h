#pragma once
#include <cstdint>
#include <string>

#include "tests/traces/scene/tiny_gltf_file.h"

namespace test {

/// Returns the bytes of a file after a random change that `number` determines: other JSON values, flipped bits, wrong
/// lengths, a cut.
std::string mutant_of(const TinyGltf& seed, std::uint64_t number);

}  // namespace test
