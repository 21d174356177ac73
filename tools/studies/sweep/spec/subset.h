#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"

namespace tools::sweep {

/// For each axis, which of its values.
using Choice = std::vector<std::uint32_t>;

/// Combinations of values that are wanted, each once. Of a grid all, the last axis fastest; of the others as drawn.
/// `sizes`: how many values each axis has. InputError for more than a million.
///
/// random: combinations that are not wanted are drawn anew. sobol: the sequence goes on for them. latin_hypercube: each
/// value of an axis is drawn equally often; combinations that are not wanted, or drawn twice, are left out.
std::vector<Choice> choose(const Subset& subset, std::span<const std::uint32_t> sizes,
                           const std::function<bool(const Choice&)>& is_wanted);

}  // namespace tools::sweep
