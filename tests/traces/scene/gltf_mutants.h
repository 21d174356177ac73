#pragma once
#include <cstdint>
#include <string>

#include "tests/traces/scene/tiny_gltf_file.h"

namespace test {

/// Returns a glTF file with a random fault, determined by `number`: JSON values, flipped bits, wrong lengths, a missing
/// end.
std::string mutant_of(const TinyGltf& seed, std::uint64_t number);

}  // namespace test
