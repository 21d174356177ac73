#pragma once
#include "traces/scene/scene.h"

namespace test {

/// Returns a small scene with every feature of Scene: every kind of texture, alpha, surface and light, instances that
/// share a mesh, a shearing node, key frames of every path and interpolation, a skin, morph targets, and two cameras.
traces::Scene feature_scene();

/// Returns a textured quad that faces +z, with normals, two sets of texture coordinates, tangents and colours.
traces::Mesh feature_quad(const char* name, std::uint32_t material);

}  // namespace test
