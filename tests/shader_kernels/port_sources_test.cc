#include "shader_kernels/programs/wavefront/port_sources.h"

#include <stdexcept>
#include <string>

#include "harness.h"
#include "shader_kernels/catalogue.h"
#include "sim/named.h"

namespace kernels {
namespace {

/// A kernel with one port of records R, whose name is that of an array or not.
template <template <class> class R, bool kKnown>
struct OnePort {
  static constexpr std::string_view kName = "one_port";
  template <class V>
  struct Ports {
    Local<V, R> port;
    F<V> uniform;
    static void describe(auto& p, auto&& port) {
      port(p.port, kKnown ? "geometry" : "geometries");
      port(NAMED(p.uniform));
    }
  };
};

struct PortSourcesTest : testing::Test {
  PortSourcesTest()
      : image(traces::build_memory_image(traces::open_scene("cornell"), {}, 1)),
        scene(image, small(8, 8)),
        sources(scene, tile) {
    tile.buffer.hold_wave(4);
    tile.buffer.hold_samples(4);
  }
  /// Message of binding the ports of K, if that fails.
  template <class K>
  std::string failure() const {
    typename K::template Ports<float> ports;
    try {
      sources.bind<K>(ports, nullptr);
    } catch (const std::logic_error& error) {
      return error.what();
    }
    return "";
  }

  const traces::MemoryImage image;
  const SceneTables scene;
  TileResult tile;
  const PortSources sources;
};

TEST_F(PortSourcesTest, APortIsBoundToTheArrayOfItsNameAndType) {
  OnePort<GeometryRecord, true>::Ports<float> ports;
  sources.bind<OnePort<GeometryRecord, true>>(ports, nullptr);
  tile.buffer.geometry[3].object = 17;
  EXPECT_EQ(ports.port.load(3).object, 17U);
}

TEST_F(PortSourcesTest, APortFollowsAnArrayThatHasGrown) {
  OnePort<GeometryRecord, true>::Ports<float> before, after;
  sources.bind<OnePort<GeometryRecord, true>>(before, nullptr);
  tile.buffer.hold_samples(4096);
  sources.bind<OnePort<GeometryRecord, true>>(after, nullptr);
  EXPECT_EQ(after.port.base, reinterpret_cast<std::byte*>(tile.buffer.geometry.data()));
}

TEST_F(PortSourcesTest, APortBoundByHandStaysSo) {
  std::vector<GeometryRecord<float>> own(1);
  OnePort<GeometryRecord, true>::Ports<float> ports;
  ports.port.bind(own.data());
  sources.bind<OnePort<GeometryRecord, true>>(ports, nullptr);
  EXPECT_EQ(ports.port.base, reinterpret_cast<std::byte*>(own.data()));
}

TEST_F(PortSourcesTest, APortWithoutAnArrayOfItsNameFailsAndSaysWhich) {
  const std::string message = failure<OnePort<GeometryRecord, false>>();
  EXPECT_NE(message.find("one_port"), std::string::npos);
  EXPECT_NE(message.find("geometries"), std::string::npos);
}

TEST_F(PortSourcesTest, APortOfAnotherTypeThanItsArrayFailsAndSaysWhich) {
  const std::string message = failure<OnePort<SecondaryRecord, true>>();
  EXPECT_NE(message.find("one_port"), std::string::npos);
  EXPECT_NE(message.find("geometry"), std::string::npos);
}

TEST_F(PortSourcesTest, CachedPortsReadTheSceneAndNoteIt) {
  std::vector<traces::Access> log;
  ShadeSurface<false>::Ports<float> ports;
  sources.bind<ShadeSurface<false>>(ports, &log);
  EXPECT_EQ(ports.attributes.load(2).material, image.attributes[2].material);
  EXPECT_EQ(log.size(), 1U);
}

}  // namespace
}  // namespace kernels
