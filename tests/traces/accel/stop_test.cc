#include <gtest/gtest.h>

#include "sim/error.h"
#include "traces/accel/build.h"
#include "traces/accel/embree_tracer.h"
#include "traces/scenes/library.h"

// Tests that long builds of a tree can be cancelled.

namespace traces {
namespace {

bool at_once() { return true; }
bool never() { return false; }

TEST(Stop, EndsTheBuildOfATree) {
  const Scene scene = open_scene("chess", {.triangles = 100'000}, {});
  EXPECT_THROW(build_memory_image(scene, {}, 1, at_once), sim::Cancelled);
  const MemoryImage image = build_memory_image(scene, {}, 1, never);
  EXPECT_EQ(image.nodes.size(), build_memory_image(scene).nodes.size());
  EXPECT_THROW(EmbreeTracer(image, 1, at_once), sim::Cancelled);
  EXPECT_NO_THROW(EmbreeTracer(image, 1, never));
}

}  // namespace
}  // namespace traces
