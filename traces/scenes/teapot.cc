#include "traces/scenes/teapot.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sim/hash.h"
#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/detail.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces {
namespace {

/// Radius and height of the four rings of control points of a patch of revolution.
struct Profile {
  float radius[4], height[4];
};

constexpr Profile kProfiles[] = {
    {{1.4F, 1.3375F, 1.4375F, 1.5F}, {2.4F, 2.53125F, 2.53125F, 2.4F}},  // rim
    {{1.5F, 1.75F, 2, 2}, {2.4F, 1.875F, 1.35F, 0.9F}},                  // upper body
    {{2, 2, 1.5F, 1.5F}, {0.9F, 0.45F, 0.225F, 0.15F}},                  // lower body
    {{0, 0.8F, 0, 0.2F}, {3.15F, 3.15F, 2.85F, 2.7F}},                   // knob
    {{0.2F, 0.4F, 1.3F, 1.3F}, {2.7F, 2.55F, 2.55F, 2.4F}},              // lid
    {{1.5F, 1.5F, 1.425F, 0}, {0.15F, 0.075F, 0, 0}},                    // bottom
};

// One half of the handle and of the spout: four rows of {x, half width, height}.
constexpr float kHalves[][4][4][3] = {
    // upper handle
    {{{-1.6F, 0, 2.025F}, {-1.6F, 0.3F, 2.025F}, {-1.5F, 0.3F, 2.25F}, {-1.5F, 0, 2.25F}},
     {{-2.3F, 0, 2.025F}, {-2.3F, 0.3F, 2.025F}, {-2.5F, 0.3F, 2.25F}, {-2.5F, 0, 2.25F}},
     {{-2.7F, 0, 2.025F}, {-2.7F, 0.3F, 2.025F}, {-3, 0.3F, 2.25F}, {-3, 0, 2.25F}},
     {{-2.7F, 0, 1.8F}, {-2.7F, 0.3F, 1.8F}, {-3, 0.3F, 1.8F}, {-3, 0, 1.8F}}},
    // lower handle
    {{{-2.7F, 0, 1.8F}, {-2.7F, 0.3F, 1.8F}, {-3, 0.3F, 1.8F}, {-3, 0, 1.8F}},
     {{-2.7F, 0, 1.575F}, {-2.7F, 0.3F, 1.575F}, {-3, 0.3F, 1.35F}, {-3, 0, 1.35F}},
     {{-2.5F, 0, 1.125F}, {-2.5F, 0.3F, 1.125F}, {-2.65F, 0.3F, 0.9375F}, {-2.65F, 0, 0.9375F}},
     {{-2, 0, 0.9F}, {-2, 0.3F, 0.9F}, {-1.9F, 0.3F, 0.6F}, {-1.9F, 0, 0.6F}}},
    // lower spout
    {{{1.7F, 0, 1.425F}, {1.7F, 0.66F, 1.425F}, {1.7F, 0.66F, 0.6F}, {1.7F, 0, 0.6F}},
     {{2.6F, 0, 1.425F}, {2.6F, 0.66F, 1.425F}, {3.1F, 0.66F, 0.825F}, {3.1F, 0, 0.825F}},
     {{2.3F, 0, 2.1F}, {2.3F, 0.25F, 2.1F}, {2.4F, 0.25F, 2.025F}, {2.4F, 0, 2.025F}},
     {{2.7F, 0, 2.4F}, {2.7F, 0.25F, 2.4F}, {3.3F, 0.25F, 2.4F}, {3.3F, 0, 2.4F}}},
    // spout's mouth
    {{{2.7F, 0, 2.4F}, {2.7F, 0.25F, 2.4F}, {3.3F, 0.25F, 2.4F}, {3.3F, 0, 2.4F}},
     {{2.8F, 0, 2.475F}, {2.8F, 0.25F, 2.475F}, {3.525F, 0.25F, 2.49375F}, {3.525F, 0, 2.49375F}},
     {{2.9F, 0, 2.475F}, {2.9F, 0.15F, 2.475F}, {3.45F, 0.15F, 2.5125F}, {3.45F, 0, 2.5125F}},
     {{2.8F, 0, 2.4F}, {2.8F, 0.15F, 2.4F}, {3.2F, 0.15F, 2.4F}, {3.2F, 0, 2.4F}}},
};

/// Makes the patch of one quarter (0 to 3) of a profile's revolution. Factor 0.56 approximates a circle, as in the
/// original teapot.
BezierPatch revolve_profile(const Profile& profile, int quarter) {
  constexpr float kArc[4][2] = {{1, 0}, {1, 0.56F}, {0.56F, 1}, {0, 1}};
  BezierPatch patch;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t i = 0; i < 4; ++i) {
      float x = kArc[i][0] * profile.radius[row];
      float z = kArc[i][1] * profile.radius[row];
      for (int turn = 0; turn < quarter; ++turn) {
        const float turned = x;
        x = -z;
        z = turned;
      }
      patch[row][i] = {x, profile.height[row], z};
    }
  }
  return patch;
}

/// Returns one half of the handle or spout; `side` is +1 or -1. Rows run along it; columns run around it so that
/// normals point outwards.
BezierPatch half_patch(const float (&rows)[4][4][3], float side) {
  BezierPatch patch;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t i = 0; i < 4; ++i) {
      const float* p = rows[row][side > 0 ? i : 3 - i];
      patch[row][i] = {p[0], p[2], side * p[1]};
    }
  }
  return patch;
}

struct Basis {
  float value[4], slope[4];
};

Basis bernstein_weights(float t) {
  const float s = 1 - t;
  return {{s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t},
          {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t}};
}

}  // namespace

std::vector<BezierPatch> teapot_patches() {
  std::vector<BezierPatch> patches;
  const auto revolved = [&patches](const Profile& profile) {
    for (int quarter = 0; quarter < 4; ++quarter) patches.push_back(revolve_profile(profile, quarter));
  };
  for (std::size_t i = 0; i + 1 < std::size(kProfiles); ++i) revolved(kProfiles[i]);
  for (const auto& rows : kHalves) {
    patches.push_back(half_patch(rows, 1));
    patches.push_back(half_patch(rows, -1));
  }
  revolved(kProfiles[std::size(kProfiles) - 1]);
  return patches;
}

SurfacePoint evaluate_patch(const BezierPatch& patch, float u, float v) {
  const auto derive = [&patch](float at_u, float at_v, glm::vec3& du, glm::vec3& dv) {
    const Basis bu = bernstein_weights(at_u), bv = bernstein_weights(at_v);
    glm::vec3 position{0};
    du = dv = glm::vec3(0);
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t i = 0; i < 4; ++i) {
        position += bu.value[i] * bv.value[j] * patch[j][i];
        du += bu.slope[i] * bv.value[j] * patch[j][i];
        dv += bu.value[i] * bv.slope[j] * patch[j][i];
      }
    }
    return position;
  };
  glm::vec3 du, dv, unused_du, unused_dv;
  const glm::vec3 position = derive(u, v, unused_du, unused_dv);
  constexpr float kInside = 1e-3F;
  derive(glm::clamp(u, kInside, 1 - kInside), glm::clamp(v, kInside, 1 - kInside), du, dv);
  return {position, glm::normalize(glm::cross(du, dv))};
}

namespace {

/// Makes one mesh of all patches. Each patch has cells x cells squares; triangles without area at the poles are
/// omitted.
Mesh make_pot(std::string name, std::span<const BezierPatch> patches, std::uint32_t cells) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (const BezierPatch& patch : patches) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t j = 0; j <= cells; ++j) {
      for (std::uint32_t i = 0; i <= cells; ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(cells);
        const float v = static_cast<float>(j) / static_cast<float>(cells);
        const SurfacePoint point = evaluate_patch(patch, u, v);
        mesh.positions.push_back(point.position);
        mesh.normals.push_back(point.normal);
        mesh.uvs.emplace_back(u, v);
      }
    }
    add_grid(mesh, first, cells, cells);
  }
  std::erase_if(mesh.triangles, [&mesh](const std::array<std::uint32_t, 3>& t) {
    constexpr float kNothing = 1e-6F;
    const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    return glm::length(glm::cross(b - a, c - a)) < kNothing;
  });
  return mesh;
}

/// Returns a texture of four squares with a fine grain, so that neighbouring texels differ.
Texture make_checker() {
  constexpr std::uint32_t kSize = 256;
  Texture texture;
  texture.name = "checker";
  texture.width = texture.height = kSize;
  for (std::uint32_t y = 0; y < kSize; ++y) {
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const bool light = (x < kSize / 2) == (y < kSize / 2);
      const auto grain = static_cast<std::uint32_t>(sim::hash(x, y) % 17);
      const std::uint32_t r = (light ? 214U : 66U) + grain;
      const std::uint32_t g = (light ? 208U : 74U) + grain;
      const std::uint32_t b = (light ? 192U : 92U) + grain;
      texture.texels.push_back(r | (g << 8) | (b << 16) | (255U << 24));
    }
  }
  return texture;
}

}  // namespace

Scene build_teapot(const BuiltinOptions& options) {
  constexpr std::uint32_t kTriangles = 14'792;  // number of triangles with 15 and 16 cells
  const Detail detail = detail_for(options.triangles_or_default(kTriangles), kTriangles);
  Scene scene;
  scene.name = "teapot";
  scene.textures.push_back(make_checker());

  Material porcelain, floor;
  porcelain.name = "glazed porcelain";
  porcelain.base_colour = {0.80F, 0.29F, 0.16F};
  porcelain.mirror = 0.15F;
  floor.name = "checkered floor";
  floor.base_colour = glm::vec3(1);
  floor.base_texture.texture = 0;
  const std::uint32_t porcelain_id = add_material(scene, porcelain);
  const std::uint32_t floor_id = add_material(scene, floor);

  const std::vector<BezierPatch> patches = teapot_patches();
  add_object(scene, make_pot("teapot", patches, detail.cell_count(15, 3)), porcelain_id);
  add_object(scene, make_quad("floor", {-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, detail.cell_count(16, 2), 12), floor_id);

  Light lamp;
  lamp.position = {-5, 9, 7};
  lamp.intensity = glm::vec3(1, 0.95F, 0.88F);
  scene.lights.push_back(lamp);
  scene.cameras.push_back(look_at("front", {1.2F, 4.2F, 8.6F}, {0.2F, 1.3F, 0}, 0.5F));
  // The camera moves once around the pot.
  std::vector<ViewKey> path;
  for (int k = 0; k <= 8; ++k) {
    const glm::vec2 way = circle_point(0.25 - k / 8.0);
    path.push_back({1.5F * static_cast<float>(k), {0.2F + 8.6F * way.x, 4.2F, 8.6F * way.y}, {0.2F, 1.3F, 0}});
  }
  add_camera_path(scene, "path", path, 0.5F);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
