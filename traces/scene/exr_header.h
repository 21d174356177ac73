#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace traces {

/// Returns why this file must not be given to OpenEXR, which allocates whatever a header claims; empty if it may.
/// Allowed: one part of scan lines, the attribute types that we write, all within the file, up to four channels, at
/// most `most_pixels` pixels.
std::string exr_problem(std::string_view file, std::uint64_t most_pixels);

}  // namespace traces
