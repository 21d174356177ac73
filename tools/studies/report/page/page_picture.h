#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace tools::pages {

/// A picture file as a page holds it, a data: URL. One of more pixels than `most` is averaged over squares, so that
/// people see all of it and pages stay small. Nothing if the file is not there or is no picture.
std::optional<std::string> page_picture(const std::filesystem::path& file, std::size_t most);

/// Side of the smallest squares that divide a picture into at most so many.
std::uint32_t square_for(std::uint32_t width, std::uint32_t height, std::size_t most);

}  // namespace tools::pages
