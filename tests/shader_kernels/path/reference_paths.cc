#include "tests/shader_kernels/path/reference_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "traces/scene/texels.h"

namespace kernels {
namespace {

using glm::dvec3;
using traces::MaterialRecord;

double largest(const dvec3& v) { return std::max({v.x, v.y, v.z}); }

/// Schlick's approximation, in closed form for any reflectance at normal incidence.
double fifth_power_of_rest(double cosine) { return std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5); }

/// GGX microfacets with parameter alpha, around the unit vector z.
struct Ggx {
  double alpha;
  double density(double cosine) const {
    const double k = cosine * cosine * (alpha * alpha - 1) + 1;
    return alpha * alpha / (std::numbers::pi * k * k);
  }
  double lambda(double cosine) const {
    const double tangent_squared = (1 - cosine * cosine) / (cosine * cosine);
    return (-1 + std::sqrt(1 + alpha * alpha * tangent_squared)) / 2;
  }
  double both_visible(double a, double b) const { return 1 / (1 + lambda(a) + lambda(b)); }
};

struct Axes {
  dvec3 x, y, z;
  explicit Axes(const dvec3& normal) : z(normal) {
    const dvec3 other = std::abs(z.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    x = glm::normalize(glm::cross(other, z));
    y = glm::cross(z, x);
  }
  dvec3 to_world(const dvec3& v) const { return x * v.x + y * v.y + z * v.z; }
};

}  // namespace

struct ReferencePaths::Surface {
  const MaterialRecord& material;
  dvec3 position, normal, diffuse;
  double side, alpha, distance;
  bool is_rough() const { return alpha > 0; }
};

ReferencePaths::ReferencePaths(const traces::MemoryImage& image, const traces::Camera& camera,
                               const RenderConfig& config, const PathConfig& path)
    : image_(image),
      camera_(camera),
      config_(config),
      path_(path),
      embree_(image, 1),
      epsilon_(config.ray_epsilon * static_cast<double>(image.diagonal())) {
  constexpr std::uint32_t kUnknown =
      (traces::kDetailStreams & ~traces::kAbsorbing & ~traces::kOccluded) | traces::kMasked;
  for (const MaterialRecord& material : image.materials) {
    if ((material.flags & kUnknown) != 0) throw std::invalid_argument("a material has details");
  }
  if (image.has_two_levels() || image.has_mip_maps()) throw std::invalid_argument("instances or mip maps");
  if (config.glass_shadows != GlassShadows::kOpaque) throw std::invalid_argument("glass passes shadow rays");
}

std::vector<PixelSums> ReferencePaths::render(std::uint32_t samples, std::uint32_t seed) {
  numbers_.seed(seed);
  std::vector<PixelSums> pixels(std::size_t{config_.width} * config_.height);
  const double height = 2 * std::tan(0.5 * static_cast<double>(camera_.vertical_fov));
  const auto axis = [&](int column) { return glm::normalize(dvec3(camera_.to_world[column])); };
  const dvec3 origin(camera_.to_world[3]);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (std::uint32_t sample = 0; sample < samples; ++sample) {
      const double x = static_cast<double>(i % config_.width) + random() - 0.5 * config_.width;
      const double y = static_cast<double>(i / config_.width) + random() - 0.5 * config_.height;
      const double pixel = height / config_.height;
      pixels[i].add(trace_path(origin, glm::normalize(axis(0) * (x * pixel) - axis(1) * (y * pixel) - axis(2))));
    }
  }
  return pixels;
}

traces::Hit ReferencePaths::trace_ray(const dvec3& origin, const dvec3& direction, double t_min, double t_max,
                                      traces::RayKind kind) const {
  const traces::Ray ray{glm::vec3(origin), static_cast<float>(t_min), glm::vec3(direction), static_cast<float>(t_max)};
  traces::Hit hit;
  embree_.trace({&ray, 1}, kind, {&hit, 1}, nullptr);
  return hit;
}

dvec3 ReferencePaths::trace_path(dvec3 origin, dvec3 direction) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  dvec3 light(0), throughput(1);
  bool scattered = false;
  double t_min = 0;
  for (std::uint32_t ray = 1;; ++ray) {
    const auto kind = ray == 1 ? traces::RayKind::kPrimary : traces::RayKind::kReflection;
    const traces::Hit hit = trace_ray(origin, direction, t_min, kInfinity, kind);
    if (!hit.is_hit()) return light + throughput * dvec3(image_.background);
    const Surface surface = fetch_surface(hit, origin, direction);
    if ((surface.material.flags & traces::kAbsorbing) != 0 && surface.side < 0) {
      const std::uint32_t material = image_.attributes[hit.triangle_index()].material;
      throughput *= glm::exp(-dvec3(image_.details[material].absorption) * surface.distance);
    }
    const bool adds_emission = path_.emission == PathEmission::kAll || image_.lights.empty() || !scattered;
    if (adds_emission) light += throughput * dvec3(surface.material.emission);
    light += throughput * direct_light(surface, direction);
    if (ray == config_.depth || !continue_path(surface, direction, throughput, scattered)) return light;
    origin = surface.position;
    t_min = epsilon_;
  }
}

ReferencePaths::Surface ReferencePaths::fetch_surface(const traces::Hit& hit, const dvec3& origin,
                                                      const dvec3& direction) const {
  const traces::AttributeRecord& a = image_.attributes[hit.triangle_index()];
  const MaterialRecord& m = image_.materials[a.material];
  const std::array<double, 3> w{1 - static_cast<double>(hit.u) - static_cast<double>(hit.v), static_cast<double>(hit.u),
                                static_cast<double>(hit.v)};
  dvec3 normal(0);
  double u = 0, v = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    normal += w[i] * dvec3(a.normal[i]);
    u += w[i] * static_cast<double>(a.uv[i].x);
    v += w[i] * static_cast<double>(a.uv[i].y);
  }
  normal = glm::normalize(normal);
  const double side = glm::dot(normal, direction) <= 0 ? 1 : -1;
  dvec3 diffuse = dvec3(m.base_colour) * static_cast<double>(m.diffuse_share);
  if ((m.flags & traces::kTextured) != 0) diffuse *= base_texel(m.base_texture, u, v);
  const double roughness = static_cast<double>(m.flags >> traces::kRoughnessShift) / 255;
  const auto distance = static_cast<double>(hit.t);
  return {m, origin + direction * distance, normal * side, diffuse, side, roughness * roughness, distance};
}

/// Returns the bilinear colour of a texture, in linear light.
dvec3 ReferencePaths::base_texel(std::uint32_t texture, double u, double v) const {
  using Wrap = traces::Texture::Wrap;
  const traces::Texture& t = image_.textures[texture];
  const bool nearest = t.filter == traces::Texture::Filter::kNearest;
  const auto fold = [](std::int64_t i, std::int64_t size, Wrap wrap) {
    if (wrap == Wrap::kClamp) return std::clamp<std::int64_t>(i, 0, size - 1);
    const std::int64_t period = wrap == Wrap::kMirror ? 2 * size : size;
    const std::int64_t in = (i % period + period) % period;
    return in < size ? in : 2 * size - 1 - in;
  };
  const auto texel = [&](double x, double y) {
    const auto column = fold(static_cast<std::int64_t>(x), t.width, t.wrap_u);
    const auto row = fold(static_cast<std::int64_t>(y), t.height, t.wrap_v);
    const std::uint32_t rgba = t.texels[static_cast<std::size_t>(row * t.width + column)];
    dvec3 colour;
    for (int c = 0; c < 3; ++c) colour[c] = traces::srgb_to_linear((rgba >> (8 * c) & 255U) / 255.0);
    return colour;
  };
  const double x = u * t.width, y = v * t.height;
  if (nearest) return texel(std::floor(x), std::floor(y));
  const double x0 = std::floor(x - 0.5), y0 = std::floor(y - 0.5), right = x - 0.5 - x0, lower = y - 0.5 - y0;
  return glm::mix(glm::mix(texel(x0, y0), texel(x0 + 1, y0), right),
                  glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), right), lower);
}

/// Returns the light of all light sources that a surface scatters into the direction from which the ray came.
dvec3 ReferencePaths::direct_light(const Surface& s, const dvec3& direction) const {
  using Kind = traces::Light::Kind;
  dvec3 sum(0);
  for (const traces::Light& light : image_.lights) {
    const bool local = light.kind != Kind::kDirectional;
    const dvec3 to_light = local ? dvec3(light.position) - s.position : -dvec3(light.direction);
    const double distance = local ? glm::length(to_light) : 1;
    const dvec3 l = glm::normalize(to_light);
    const double cosine = glm::dot(s.normal, l);
    if (cosine <= 0) continue;
    double irradiance = cosine / (distance * distance);
    if (light.kind == Kind::kSpot) {
      const double inner = static_cast<double>(light.cos_inner), outer = static_cast<double>(light.cos_outer);
      const double cone = (glm::dot(dvec3(light.direction), -l) - outer) / std::max(0.001, inner - outer);
      irradiance *= std::pow(std::clamp(cone, 0.0, 1.0), 2);
    }
    if (local && light.range > 0) {
      irradiance *= std::max(1 - std::pow(distance / static_cast<double>(light.range), 4), 0.0);
    }
    dvec3 scattered = s.diffuse;
    if (s.is_rough()) {
      const double eye = -glm::dot(s.normal, direction);
      const dvec3 h = glm::normalize(l - direction), f0(s.material.mirrored);
      const Ggx ggx{s.alpha};
      const dvec3 fresnel = f0 + (1.0 - f0) * fifth_power_of_rest(glm::dot(h, l));
      scattered *= 1 - fifth_power_of_rest(eye);
      scattered += fresnel * (std::numbers::pi * ggx.density(glm::dot(h, s.normal)) * ggx.both_visible(eye, cosine) /
                              (4 * eye * cosine));
    }
    if (largest(scattered) * irradiance <= 0) continue;
    const double t_min = epsilon_ / distance;
    const double t_max = local ? 1 - t_min : std::numeric_limits<double>::infinity();
    if (trace_ray(s.position, to_light, t_min, t_max, traces::RayKind::kShadow).is_hit()) continue;
    sum += scattered * dvec3(light.intensity) * irradiance;
  }
  return sum;
}

/// Chooses the next direction of a path. Returns false if the path ends.
bool ReferencePaths::continue_path(const Surface& s, dvec3& direction, dvec3& throughput, bool& scattered) {
  const MaterialRecord& m = s.material;
  const double eye = -glm::dot(s.normal, direction), entering = static_cast<double>(m.entering);
  const double ior = static_cast<double>(m.ior), eta = s.side > 0 ? 1 / ior : ior;
  const double refracted_squared = 1 - eta * eta * (1 - eye * eye);
  double reflectance = 1;
  if (refracted_squared >= 0) {
    const double f0 = std::pow((ior - 1) / (ior + 1), 2);
    reflectance = f0 + (1 - f0) * fifth_power_of_rest(eta <= 1 ? eye : std::sqrt(refracted_squared));
  }
  enum class Lobe : std::uint8_t { kDiffuse, kMirror, kGlass };
  std::vector<Lobe> lobes;
  if (largest(s.diffuse) > 0) lobes.push_back(Lobe::kDiffuse);
  if (largest(dvec3(m.mirrored)) + entering > 0) lobes.push_back(Lobe::kMirror);
  if (entering > 0) lobes.push_back(Lobe::kGlass);
  if (lobes.empty()) return false;
  const auto count = static_cast<double>(lobes.size());
  const Lobe lobe = lobes[std::min(static_cast<std::size_t>(random() * count), lobes.size() - 1)];
  throughput *= count;
  scattered = lobe == Lobe::kDiffuse || (lobe == Lobe::kMirror && s.is_rough());
  const double turn = 2 * std::numbers::pi * random(), number = random();
  if (lobe == Lobe::kDiffuse) {
    // A point of the unit sphere around the tip of the normal: its direction is cosine-distributed.
    const double z = 1 - 2 * number, radius = std::sqrt(1 - z * z);
    const dvec3 on_sphere(radius * std::cos(turn), radius * std::sin(turn), z);
    direction = glm::normalize(s.normal + on_sphere);
    throughput *= s.diffuse * (s.is_rough() ? 1 - fifth_power_of_rest(eye) : 1.0);
  } else if (lobe == Lobe::kMirror && !s.is_rough()) {
    direction += s.normal * (2 * eye);
    throughput *= dvec3(m.mirrored) + entering * reflectance;
  } else if (lobe == Lobe::kMirror) {
    const Ggx ggx{s.alpha};
    const double cosine = std::sqrt((1 - number) / (1 + (ggx.alpha * ggx.alpha - 1) * number));
    const double sine = std::sqrt(1 - cosine * cosine);
    const dvec3 h = Axes(s.normal).to_world({sine * std::cos(turn), sine * std::sin(turn), cosine});
    const double at_facet = -glm::dot(direction, h);
    direction = direction + h * (2 * at_facet);
    const double out = glm::dot(direction, s.normal);
    if (at_facet <= 0 || out <= 0) return false;
    const dvec3 f0(m.mirrored), fresnel = f0 + (1.0 - f0) * fifth_power_of_rest(at_facet);
    throughput *= fresnel * (ggx.both_visible(eye, out) * at_facet / (eye * cosine));
  } else {
    if (refracted_squared < 0) return false;
    direction = direction * eta + s.normal * (eta * eye - std::sqrt(refracted_squared));
    throughput *= dvec3(m.base_colour) * (entering * (1 - reflectance));
  }
  return largest(throughput) > 0;
}

}  // namespace kernels
