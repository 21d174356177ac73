#pragma once
#include <span>
#include <string>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

// Dimensions of the car in metres. Its front is +x, its right side +z, the ground y = 0.
inline constexpr float kFrontAxle = 1.30F, kRearAxle = -1.31F;
inline constexpr float kWheel = 0.335F;  ///< radius of a wheel, and height of the axles
inline constexpr float kArch = 0.385F;   ///< radius of the wheel arches
inline constexpr float kTrack = 0.795F;  ///< distance from the car's middle plane to the middle of a wheel

/// Makes the body of the car up to the belt line: fenders, bonnet, doors, tail. It is open below and has wheel arches.
Mesh make_shell(const Detail& detail);

/// Makes roof and pillars without glass. The lower edge is inside the shell.
Mesh make_cabin(const Detail& detail);

/// Makes the liners of the wheel arches and the floor.
Mesh make_underbody(const Detail& detail);

/// Makes the rims of the wheel arches.
Mesh make_arch_lips(const Detail& detail);

/// Returns half the width of the car's shell at a point of its side.
float half_width_at(float x, float y);

/// Makes a patch of columns x rows cells between two smoothed lines in the plane z = 0. The lines run in the same
/// direction; the patch faces +z if the second is to the left of the first.
Mesh make_patch(std::span<const glm::vec2> first, std::span<const glm::vec2> second, std::uint32_t columns,
                std::uint32_t rows);

/// Makes a strip of the given width along a line in the plane z = 0.
Mesh make_strip(std::span<const glm::vec2> line, float width, std::uint32_t columns);

/// Side from which a patch is projected onto the car's body. It sets the direction of projection and the world axes
/// that are the patch's x and y.
enum class From : std::uint8_t {
  kFront,  ///< projected along -x; patch axes (z, y)
  kRear,   ///< projected along +x; patch axes (z, y)
  kLeft,   ///< projected along +z; patch axes (x, y)
  kRight,  ///< projected along -z; patch axes (x, y)
  kAbove   ///< projected along -y; patch axes (x, z)
};

/// Projects a patch onto a body, `lift` above its surface and with its normals. Parts that miss the body are omitted.
Mesh drape_patch(const Mesh& body, const Mesh& patch, From from, float lift);

}  // namespace traces::car
