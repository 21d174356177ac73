#include <stdexcept>
#include <string>

#include "harness.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/wavefront/tile_graph.h"
#include "sim/named.h"

namespace kernels {
namespace {

/// A kernel with one port of records R. The port has the name of a known array if kKnown.
template <template <class> class R, bool kKnown>
struct OnePort {
  static constexpr std::string_view kName = "one_port";
  template <class V>
  struct Ports {
    Local<V, R> port;
    F<V> uniform;
    static constexpr void describe(auto& p, auto&& port) {
      port(p.port, kKnown ? "geometry" : "geometries");
      port(NAMED(p.uniform));
    }
  };
};

struct PortBinding : testing::Test {
  PortBinding() : image(traces::build_memory_image(traces::open_scene("cornell"), {}, 1)), scene(image, small(8, 8)) {
    tile.buffer.reserve_wave(4);
    tile.buffer.reserve_samples(4);
  }
  /// Returns the error message of binding the ports of K, or an empty text.
  template <class K>
  std::string failure() const {
    typename K::template Ports<float> ports;
    try {
      bind_ports<K>(ports, tile, scene, nullptr);
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return "";
  }

  const traces::MemoryImage image;
  const SceneTables scene;
  TileResult tile;
};

TEST_F(PortBinding, APortIsBoundToTheArrayOfItsNameAndType) {
  OnePort<GeometryRecord, true>::Ports<float> ports;
  bind_ports<OnePort<GeometryRecord, true>>(ports, tile, scene, nullptr);
  tile.buffer.samples.geometry[3].object = 17;
  EXPECT_EQ(ports.port.load(3).object, 17U);
}

TEST_F(PortBinding, APortFollowsAnArrayThatHasGrown) {
  OnePort<GeometryRecord, true>::Ports<float> before, after;
  bind_ports<OnePort<GeometryRecord, true>>(before, tile, scene, nullptr);
  tile.buffer.reserve_samples(4096);
  bind_ports<OnePort<GeometryRecord, true>>(after, tile, scene, nullptr);
  EXPECT_EQ(after.port.base, reinterpret_cast<std::byte*>(tile.buffer.samples.geometry.data()));
}

TEST_F(PortBinding, APortBoundByHandKeepsItsArray) {
  std::vector<GeometryRecord<float>> own(1);
  OnePort<GeometryRecord, true>::Ports<float> ports;
  ports.port.bind(own.data());
  bind_ports<OnePort<GeometryRecord, true>>(ports, tile, scene, nullptr);
  EXPECT_EQ(ports.port.base, reinterpret_cast<std::byte*>(own.data()));
}

TEST_F(PortBinding, APortWithoutAnArrayOfItsNameFailsByName) {
  const std::string message = failure<OnePort<GeometryRecord, false>>();
  EXPECT_NE(message.find("one_port"), std::string::npos);
  EXPECT_NE(message.find("geometries"), std::string::npos);
}

TEST_F(PortBinding, APortOfAnotherTypeThanItsArrayFailsByName) {
  const std::string message = failure<OnePort<SecondaryRecord, true>>();
  EXPECT_NE(message.find("one_port"), std::string::npos);
  EXPECT_NE(message.find("geometry"), std::string::npos);
}

TEST_F(PortBinding, CachedPortsReadTheSceneAndLogIt) {
  std::vector<traces::Access> log;
  ShadeSurface<false>::Ports<float> ports;
  bind_ports<ShadeSurface<false>>(ports, tile, scene, &log);
  EXPECT_EQ(ports.attributes.load(2).material, image.attributes[2].material);
  EXPECT_EQ(log.size(), 1U);
}

TEST_F(PortBinding, ALaunchSetsTheItemsOfTheQueuesThatItFills) {
  tile.buffer.rays.wave.hits[1].triangle = traces::kNoHit;
  for (const std::size_t hit : {0U, 2U, 3U}) tile.buffer.rays.wave.hits[hit].triangle = 5;
  TileGraph graph(scene, false, tile);
  graph.launch<ClassifyHits>(4);
  EXPECT_EQ(tile.buffer.queues.misses.items, 1U);
  EXPECT_EQ(tile.buffer.queues.surfaces.items, 3U);
  EXPECT_EQ(tile.buffer.queues.misses.entries[0], 1U);
}

}  // namespace
}  // namespace kernels
