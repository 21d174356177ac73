#pragma once
#include <array>

namespace tools::pages::colours {

// Colours on a light ground; the page's scripts have those on a dark one for each. They differ in lightness too, for
// readers who see hues otherwise, and what lies beside each other differs in both.
inline constexpr const char* kAccent = "#1f5fa8";
inline constexpr const char* kWork = "#2b6cb0";
inline constexpr const char* kWorkMiddle = "#63a0d8";
inline constexpr const char* kWorkLight = "#a9cbea";
inline constexpr const char* kWait = "#b85c12";
inline constexpr const char* kWaitMiddle = "#e0964a";
inline constexpr const char* kWaitLight = "#f2c793";
inline constexpr const char* kTrace = "#17736d";
inline constexpr const char* kTraceMiddle = "#4aa89a";
inline constexpr const char* kTraceLight = "#9cd3c7";
inline constexpr const char* kTree = "#6b4a95";
inline constexpr const char* kTreeMiddle = "#a184c2";
inline constexpr const char* kTreeLight = "#cebfdf";
inline constexpr const char* kRaster = "#b3446c";
inline constexpr const char* kRasterMiddle = "#d487a3";
inline constexpr const char* kRasterLight = "#ecc4d2";
inline constexpr const char* kRasterWork = "#7a7414";
inline constexpr const char* kRest = "#8a9099";
inline constexpr const char* kRestLight = "#d3d7dc";
inline constexpr const char* kText = "#1c2733";
inline constexpr const char* kInverse = "#ffffff";

/// Blocks of the GPU in the order of hw::Block: the same on every page.
inline constexpr std::array kBlocks = {kTrace, kWork, kTree, kTreeMiddle, kWorkMiddle, kRest, kWait, kRaster};

}  // namespace tools::pages::colours
