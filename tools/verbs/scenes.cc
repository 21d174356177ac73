#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/report/table.h"
#include "tools/verbs/verbs.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/scene/builtin/builtin.h"
#include "traces/scene/info.h"
#include "traces/scene/library.h"

namespace tools {

namespace {

void list() {
  sim::Table table({"scene", "triangles", ""});
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) {
    const traces::SceneInfo info = traces::scene_info(traces::build_scene(scene.name));
    table.row({std::string(scene.name), std::to_string(info.triangles), std::string(scene.description)});
  }
  fmt::print("{}", table.text());
}

void show(const std::string& name) {
  const traces::Scene scene = traces::open_scene(name);
  const traces::SceneInfo info = traces::scene_info(scene);
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhInfo tree = traces::bvh_info(image);
  const auto line = [](const char* what, const std::string& value) { fmt::print("{:<18}{}\n", what, value); };
  line("scene", info.name);
  line("triangles", info.triangles == info.stored_triangles
                        ? std::to_string(info.triangles)
                        : fmt::format("{} ({} stored)", info.triangles, info.stored_triangles));
  line("instances", fmt::format("{} of {} meshes", info.instances, info.meshes));
  line("materials", std::to_string(info.materials));
  line("textures", std::to_string(info.textures));
  line("lights", std::to_string(info.lights));
  std::string cameras;
  for (const traces::Camera& c : scene.cameras) cameras += fmt::format("{}'{}'", cameras.empty() ? "" : ", ", c.name);
  line("cameras", cameras);
  line("memory image", sim::si_text(static_cast<double>(image.layout.end), "B"));
  line("BVH", fmt::format("{} nodes, {} leaves, depth {}, SAH cost {:.1f}", tree.nodes, tree.leaves, tree.depth,
                          tree.sah_cost));
  for (const std::string& warning : scene.warnings) fmt::print(stderr, "raywatt: warning: {}\n", warning);
}

}  // namespace

void add_scenes(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("scenes", "What can be rendered");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt scenes info teapot");
  verb->add_subcommand("list", "Built-in scenes")->callback(list);
  CLI::App* info = verb->add_subcommand("info", "Triangles, lights, cameras and tree of a scene");
  const auto name = std::make_shared<std::string>();
  info->add_option("scene", *name, "built-in scene, or a .gltf or .glb file")->required();
  info->callback([name] { show(*name); });
}

}  // namespace tools
