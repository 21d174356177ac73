#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace traces {

/// The reason that the library for OpenEXR, which takes memory for whatever a header claims, must not see this file;
/// empty if it may: one part of scan lines, attributes of kinds that we write, within the file, up to four channels, no
/// more pixels than that.
std::string exr_problem(std::string_view file, std::uint64_t most_pixels);

}  // namespace traces
