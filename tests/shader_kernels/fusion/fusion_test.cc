#include <algorithm>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/graph.h"
#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/programs.h"
#include "shader_kernels/recorder.h"
#include "sim/named.h"
#include "tests/full_size.h"
#include "tests/shader_kernels/hand_counts.h"
#include "tests/shader_kernels/harness.h"
#include "tests/shader_kernels/showcase.h"
#include "traces/scenes/builtin.h"

namespace kernels {
namespace {

struct Double {
  template <class V>
  struct Ports {
    Local<V, WordRecord> words, doubled;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.words));
      port(NAMED(p.doubled));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> word = at.words.load(item).word;
    at.doubled.store(item, {word + word});
  }
};

/// Part of a fused kernel: loads a word and its double, and adds them.
struct Add {
  template <class V>
  struct Ports {
    Local<V, WordRecord> words, doubled, sums;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.words));
      port(NAMED(p.doubled));
      port(NAMED(p.sums));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.sums.store(item, {at.words.load(item).word + at.doubled.load(item).word});
  }
};

/// Part of a fused kernel: loads the double, adds one, and stores it.
struct Increment {
  template <class V>
  struct Ports {
    Local<V, WordRecord> doubled;
    static void describe(auto& p, auto&& port) { port(NAMED(p.doubled)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.doubled.store(item, {at.doubled.load(item).word + 1U});
  }
};

/// Part that cannot use registers: it loads the double of the next item.
struct LookAhead {
  template <class V>
  struct Ports {
    Local<V, WordRecord> doubled, ahead;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.doubled));
      port(NAMED(p.ahead));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.ahead.store(item, {at.doubled.load(item + 1U).word});
  }
};

/// Part that doubles a word of its own, by the same operation as another part.
struct DoubleAgain {
  template <class V>
  struct Ports {
    Local<V, WordRecord> words, again;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.words));
      port(NAMED(p.again));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> word = at.words.load(item).word;
    at.again.store(item, {word + word});
  }
};

template <class... Parts>
struct Named : Fused<Parts...> {
  static constexpr std::string_view kName = "test";
};
struct InRegisters : Named<Double, Add> {
  static constexpr std::array<std::string_view, 1> kRegisters{"doubled"};
};
struct NeverStored : Named<Add> {
  static constexpr std::array<std::string_view, 1> kRegisters{"doubled"};
};

/// Returns the number of nodes with an operation in the graph of kernel K.
template <class K>
std::uint32_t number_of(Op op) {
  return count_ops(record_graph<K>())[static_cast<std::size_t>(op)];
}

TEST(Fusion, LoadsEachRecordOnceAndTakesStoredOnesFromRegisters) {
  using K = Named<Double, Add>;
  EXPECT_EQ(number_of<K>(Op::kLoadLocal), 1U);
  EXPECT_EQ(number_of<K>(Op::kStoreLocal), 2U);
  EXPECT_EQ(number_of<K>(Op::kIntAdd), 2U);
}

TEST(Fusion, StoresNothingInMemoriesWithoutOtherReaders) {
  EXPECT_EQ(number_of<InRegisters>(Op::kStoreLocal), 1U);
  EXPECT_EQ(number_of<InRegisters>(Op::kLoadLocal), 1U);
}

TEST(Fusion, StoresARecordThatPartsChangeOnce) {
  using K = Named<Double, Increment>;
  EXPECT_EQ(number_of<K>(Op::kStoreLocal), 1U);
  const Graph graph = record_graph<K>();
  EXPECT_EQ(graph.nodes[graph.nodes.back().stored.front()].op, Op::kIntAdd);
  EXPECT_EQ(number_of<K>(Op::kIntAdd), 2U);
}

TEST(Fusion, SharesEqualOperationsOfParts) {
  using K = Named<Double, DoubleAgain>;
  EXPECT_EQ(number_of<K>(Op::kIntAdd), 1U);
  EXPECT_EQ(number_of<K>(Op::kStoreLocal), 2U);
}

TEST(Fusion, RefusesALoadOfWhatAnotherPartMayHaveStored) {
  EXPECT_THROW((record_graph<Named<Double, LookAhead>>()), std::logic_error);
}

TEST(Fusion, RefusesALoadOfARegisterThatNoPartHasStored) {
  EXPECT_THROW(record_graph<NeverStored>(), std::logic_error);
}

TEST(Fusion, NamesTheKernelsWhoseWorkItDoes) {
  using Names = std::vector<std::string_view>;
  EXPECT_EQ((CheckInterpolate<false, true, false>::part_names()),
            (Names{"check_similarity_x_secondary", "interpolate_x_secondary"}));
  EXPECT_EQ(PackSample::part_names(), Names{"pack_colour"});
  for (const KernelInfo& kernel : kernel_catalogue()) {
    for (const std::string_view part : kernel.parts) EXPECT_TRUE(find_kernel(part)->parts.empty()) << kernel.name;
    const bool is_variant = kernel.name.ends_with("_untextured") || kernel.name.ends_with("_local");
    EXPECT_EQ(kernel.parts.empty(), kernel.id < kKernelId<FetchSurface<false>> || is_variant) << kernel.name;
  }
}

TEST(Fusion, ListsTheAccessesOfAnyPart) {
  EXPECT_TRUE(kListsAccesses<FetchLit<false>::Ports<float>>);
  EXPECT_TRUE(kListsAccesses<LightSurfaceGeometry<true>::Ports<float>>);
  EXPECT_FALSE(kListsAccesses<LightSurface::Ports<float>>);
  EXPECT_FALSE(kListsAccesses<CombineRecordShadow::Ports<float>>);
}

// Checks that a fused kernel has the operations of its parts, without those that an earlier part has done. Counted by
// hand. light_surface: classify_surfaces; and, compare, and, next for `later`; and, compare for what is lit;
// shade_ambient with 3 select; shade_diffuse with and, less 3 mul that shade_ambient has done; once each of surfaces,
// mattes, paths, colours, places.
constexpr Hand kFusedByHand[] = {
    //                         add mul d/s oth cmp sel int cnv  ld  st  $
    {"fetch_surface", {19, 33, 2, 1, 9, 9, 17, 0, 3, 12, 2}},
    {"fetch_surface_instanced", {25, 44, 2, 1, 9, 9, 23, 2, 3, 12, 3}},
    {"light_surface", {15, 35, 2, 6, 8, 10, 16, 0, 5, 9, 0}},
    // record_*: also hits and texcoords.
    {"light_surface_geometry", {15, 35, 2, 6, 9, 11, 19, 0, 6, 10, 1}},
    {"light_surface_geometry_instanced", {15, 35, 2, 6, 9, 11, 22, 0, 6, 10, 1}},
    {"light_surface_kept", {28, 53, 4, 7, 10, 12, 19, 0, 7, 11, 1}},
    {"light_surface_kept_instanced", {34, 62, 4, 7, 10, 12, 23, 0, 7, 11, 2}},
    {"light_surface_secondary", {15, 35, 2, 6, 13, 18, 31, 0, 7, 10, 1}},
    {"light_surface_secondary_instanced", {15, 35, 2, 6, 13, 18, 34, 0, 7, 10, 1}},
    // shade_surface: also rays, hits, paths, colours, besides surfaces; record_* without triangle_index_of (1 integer)
    // and
    // instance_index_of (4), which shade_surface has done, as it has loaded the instance.
    {"fetch_lit", {34, 68, 4, 7, 9, 11, 17, 0, 5, 13, 2}},
    {"fetch_lit_instanced", {40, 79, 4, 7, 9, 11, 23, 2, 5, 13, 3}},
    {"fetch_lit_geometry", {34, 68, 4, 7, 10, 12, 19, 0, 5, 14, 3}},
    {"fetch_lit_geometry_instanced", {40, 79, 4, 7, 10, 12, 25, 2, 5, 14, 3}},
    {"fetch_lit_kept", {47, 86, 6, 8, 11, 13, 19, 0, 5, 15, 3}},
    {"fetch_lit_kept_instanced", {59, 106, 6, 8, 11, 13, 25, 2, 5, 15, 4}},
    {"fetch_lit_secondary", {34, 68, 4, 7, 14, 19, 31, 0, 6, 14, 3}},
    {"fetch_lit_secondary_instanced", {40, 79, 4, 7, 14, 19, 37, 2, 6, 14, 3}},
    {"light_later", {15, 35, 2, 6, 1, 1, 1, 0, 5, 3, 0}},
    {"generate_geometry", {20, 20, 2, 4, 0, 0, 0, 1, 1, 4, 0}},
    {"generate_secondary", {20, 20, 2, 4, 0, 0, 0, 1, 1, 5, 0}},
    {"generate_surface", {20, 20, 2, 4, 0, 0, 0, 1, 1, 6, 0}},
    {"generate_traits", {20, 20, 2, 4, 0, 0, 0, 1, 1, 6, 0}},
    // One comparison, one load each of shadow_hits and shadow_paths.
    {"combine_record_shadow", {3, 0, 0, 0, 1, 4, 1, 0, 4, 2, 0}},
    {"combine_record_secondary_shadow", {3, 0, 0, 0, 1, 4, 1, 0, 4, 2, 0}},
    {"combine_record_traits_shadow", {3, 0, 0, 0, 1, 4, 1, 0, 4, 2, 0}},
    {"combine_record_branch_shadow", {5, 3, 0, 0, 2, 5, 1, 0, 6, 2, 0}},
    // Instead of `passed` to_float, add, mul; the stream `passed` is not stored, which saves shift, or; once each of
    // geometry and secondary.
    {"check_interpolate_x", {33, 28, 2, 15, 7, 6, 5, 6, 4, 4, 0}},
    {"check_interpolate_x_secondary", {53, 52, 6, 18, 10, 9, 8, 6, 6, 5, 0}},
    {"check_interpolate_y", {19, 16, 0, 14, 7, 6, 5, 6, 4, 3, 0}},
    {"check_interpolate_y_secondary", {23, 22, 0, 15, 10, 9, 8, 6, 6, 3, 0}},
    // With textures: 6 encoded, vector sub, dot, and what the check counts; colours are loaded and clamped already.
    {"check_interpolate_x_texture", {50, 55, 20, 15, 17, 15, 11, 6, 4, 4, 0}},
    {"check_interpolate_x_secondary_texture", {70, 79, 24, 18, 20, 18, 14, 6, 6, 5, 0}},
    {"check_interpolate_y_texture", {36, 43, 18, 14, 17, 15, 11, 6, 4, 3, 0}},
    {"check_interpolate_y_secondary_texture", {40, 49, 18, 15, 20, 18, 14, 6, 6, 3, 0}},
    // As light_surface, with shade_visible in place of shade_diffuse; all but the references is in registers, and the
    // colour is stored once.
    {"interpolate_lit_x", {58, 66, 6, 8, 9, 15, 18, 4, 7, 15, 0}},
    {"interpolate_lit_y", {50, 57, 4, 7, 9, 15, 18, 4, 7, 13, 0}},
    // Without 2 wraps, or; 2 (has, select, or), and.
    {"check_attributes_x_untextured", {38, 50, 18, 15, 16, 15, 10, 5, 6, 3, 0}},
    {"check_attributes_y_untextured", {38, 50, 18, 15, 16, 15, 10, 5, 6, 3, 0}},
    // As pack_colour; along rows to_float, div_mod, 2 mul, 2 add, to_int.
    {"pack_sample", {9, 15, 9, 6, 3, 3, 5, 3, 1, 1, 0}},
    {"pack_grid_sample", {13, 19, 9, 7, 3, 3, 5, 5, 1, 1, 0}},
    // As without cones, and 6 add, 5 mul, 2 div_sqrt, 2 other, 3 integer for the footprint.
    {"fetch_surface_cones", {25, 38, 4, 3, 9, 9, 20, 0, 3, 12, 2}},
    {"fetch_surface_cones_instanced", {33, 54, 7, 3, 9, 9, 26, 2, 3, 12, 3}},
    {"fetch_lit_cones", {40, 73, 6, 9, 9, 11, 20, 0, 5, 13, 2}},
    {"fetch_lit_cones_instanced", {48, 89, 9, 9, 9, 11, 26, 2, 5, 13, 3}},
    {"fetch_lit_geometry_cones", {40, 73, 6, 9, 10, 12, 22, 0, 5, 14, 3}},
    {"fetch_lit_geometry_cones_instanced", {48, 89, 9, 9, 10, 12, 28, 2, 5, 14, 3}},
    {"fetch_lit_kept_cones", {53, 91, 8, 10, 11, 13, 22, 0, 5, 15, 3}},
    {"fetch_lit_kept_cones_instanced", {67, 116, 11, 10, 11, 13, 28, 2, 5, 15, 4}},
    {"fetch_lit_secondary_cones", {40, 73, 6, 9, 14, 19, 34, 0, 6, 14, 3}},
    {"fetch_lit_secondary_cones_instanced", {48, 89, 9, 9, 14, 19, 40, 2, 6, 14, 3}},
    // As pack_grid_sample, and store_identities less the sample's index.
    {"pack_identified", {13, 19, 9, 7, 5, 5, 7, 5, 3, 2, 0}},
    {"pack_identified_shadows", {13, 19, 9, 7, 5, 5, 24, 5, 3, 2, 0}},
    // Less one load of samples; the sum of the global colour is in registers.
    {"record_counted", {3, 0, 0, 2, 1, 1, 1, 0, 3, 1, 0}},
    // Without 6 encoded, vector sub, dot, less, select, or.
    {"check_attributes_x_local", {27, 23, 0, 11, 15, 10, 17, 5, 4, 3, 0}},
    {"check_attributes_y_local", {27, 23, 0, 11, 15, 10, 17, 5, 4, 3, 0}},
    {"check_attributes_x_local_untextured", {21, 23, 0, 3, 9, 8, 9, 5, 4, 3, 0}},
    {"check_attributes_y_local_untextured", {21, 23, 0, 3, 9, 8, 9, 5, 4, 3, 0}},
    // As combine_record_shadow.
    {"combine_record_visible_shadow", {3, 0, 0, 0, 1, 4, 1, 0, 4, 2, 0}},
    // As light_surface, with shade_open in place of shade_diffuse: the colour is stored once. With shade_soft: 17 add,
    // 23 mul, div_sqrt, 7 other, compare, select, 25 integer, 2 convert, rays more. Occlusion: without shade_ambient.
    {"light_surface_open", {17, 34, 2, 6, 8, 12, 15, 0, 5, 7, 0}},
    {"light_surface_soft", {32, 58, 3, 13, 9, 11, 41, 2, 6, 9, 0}},
    {"light_surface_occlusion", {21, 36, 3, 10, 10, 9, 41, 2, 5, 8, 0}},
    // Also shade_surface, as in fetch_lit.
    {"fetch_lit_open", {36, 67, 4, 7, 9, 13, 16, 0, 5, 11, 2}},
    {"fetch_lit_open_instanced", {42, 78, 4, 7, 9, 13, 22, 2, 5, 11, 3}},
    {"fetch_lit_open_cones", {42, 72, 6, 9, 9, 13, 19, 0, 5, 11, 2}},
    {"fetch_lit_open_cones_instanced", {50, 88, 9, 9, 9, 13, 25, 2, 5, 11, 3}},
    {"fetch_lit_soft", {51, 91, 5, 14, 10, 12, 42, 2, 5, 13, 2}},
    {"fetch_lit_soft_instanced", {57, 102, 5, 14, 10, 12, 48, 4, 5, 13, 3}},
    {"fetch_lit_soft_cones", {57, 96, 7, 16, 10, 12, 45, 2, 5, 13, 2}},
    {"fetch_lit_soft_cones_instanced", {65, 112, 10, 16, 10, 12, 51, 4, 5, 13, 3}},
    {"fetch_lit_occlusion", {40, 69, 5, 11, 11, 10, 42, 2, 4, 12, 2}},
    {"fetch_lit_occlusion_instanced", {46, 80, 5, 11, 11, 10, 48, 4, 4, 12, 3}},
    {"fetch_lit_occlusion_cones", {46, 74, 7, 13, 11, 10, 45, 2, 4, 12, 2}},
    {"fetch_lit_occlusion_cones_instanced", {54, 90, 10, 13, 11, 10, 51, 4, 4, 12, 3}},
    // Once each of surfaces; places and mattes are in registers.
    {"fetch_visible", {24, 36, 2, 1, 6, 6, 11, 0, 4, 10, 2}},
    {"fetch_visible_instanced", {30, 47, 2, 1, 6, 6, 17, 2, 4, 10, 3}},
    {"fetch_visible_cones", {30, 41, 4, 3, 6, 6, 14, 0, 4, 10, 2}},
    {"fetch_visible_cones_instanced", {38, 57, 7, 3, 6, 6, 20, 2, 4, 10, 3}},
};

TEST(FusedGraphs, OperationsAreThoseOfThePartsLessWhatIsShared) {
  ASSERT_EQ(kFirstFused + std::size(kFusedByHand), kernel_catalogue().size());
  expect_counts(kFusedByHand);
}

// Tests that fused kernels change only the recorded work. Pictures, marks and rays are those of separate kernels.

/// Pictures and recorded work of all frames that a program rendered.
struct Frames {
  std::vector<float> rgb;
  std::vector<std::vector<std::uint32_t>>
      packed;  ///< words written to the frame buffer by each tile, in dispatch order
  std::vector<std::vector<SampleMark>> marks;
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  Sampling sampling;
  std::uint64_t launches = 0, fused = 0;
  std::set<std::string_view> kernels;  ///< names of all kernels that were launched
};

Frames run(FrameProgram& program, const traces::Tracer& tracer) {
  Frames out;
  run_tiles(program, tracer, true, [&](const TileResult& tile) {
    out.packed.push_back(tile.packed);
    out.marks.push_back(tile.marks);
    for (std::size_t k = 0; k < out.rays.size(); ++k) out.rays[k] += tile.rays[k];
    for (const traces::WorkNode& node : tile.work.nodes) {
      if (node.kind != traces::WorkNode::Kind::kLaunch) continue;
      ++out.launches;
      out.kernels.insert(kernel_catalogue()[node.kernel].name);
      out.fused += kernel_catalogue()[node.kernel].parts.empty() ? 0U : 1U;
    }
  });
  out.rgb = program.picture();
  out.sampling = program.sampling();
  return out;
}

void expect_same(const Frames& fused, const Frames& apart) {
  EXPECT_EQ(fused.rgb, apart.rgb);
  EXPECT_EQ(fused.packed, apart.packed);
  EXPECT_EQ(fused.marks, apart.marks);
  EXPECT_EQ(fused.rays, apart.rays);
  EXPECT_EQ(fused.sampling.traced, apart.sampling.traced);
  EXPECT_EQ(fused.sampling.correction, apart.sampling.correction);
  EXPECT_EQ(fused.sampling.passed, apart.sampling.passed);
  EXPECT_EQ(fused.sampling.failed, apart.sampling.failed);
  EXPECT_EQ(fused.sampling.background, apart.sampling.background);
  EXPECT_LT(fused.launches, apart.launches);
  EXPECT_GT(fused.fused, 0U);
  EXPECT_EQ(apart.fused, 0U);
}

/// Compares the results of all programs with and without fusion on a scene.
void expect_fusion_to_change_nothing(const traces::Scene& scene, const traces::BvhConfig& bvh = {},
                                     ProgramConfig programs = {}, traces::MipMaps mip_maps = traces::MipMaps::kOn) {
  const traces::MemoryImage image = traces::build_memory_image(scene, bvh, 0, nullptr, mip_maps);
  const traces::BvhTracer tracer(image);
  const glm::vec3 sides = image.upper - image.lower;
  const float size = std::max({sides.x, sides.y, sides.z});
  programs.undersample.correct_shadows = true;
  const RateMap rates(programs.multirate);
  for (const char* name : {"full:1", "full:4", "multirate:under", "multirate:super", "undersample", "supersample",
                           "reconstruct", "reconstruct:sraa"}) {
    for (const Streams streams : {Streams::kCompacted, Streams::kDivergent}) {
      SCOPED_TRACE(testing::Message() << name << (streams == Streams::kDivergent ? ", divergent" : ""));
      RenderConfig render = small(64, 32);
      render.streams = streams;
      const auto frames = [&](Fusion fusion) {
        render.fusion = fusion;
        const Frame frame{image, scene.cameras.front(), render, programs, rates, 0, size};
        return run(*make_program(parse_program(name), frame), tracer);
      };
      expect_same(frames(Fusion::kOn), frames(Fusion::kOff));
    }
  }
}

TEST(FusedKernels, CheckGlobalColoursOnlyInTilesThatHaveSome) {
  const traces::Scene scene = traces::open_scene("cornell");  // its lamp glows, most of its tiles are matt
  const traces::MemoryImage image = traces::build_memory_image(scene, {});
  const ProgramConfig programs;
  const RateMap rates(programs.multirate);
  const auto launched = [&](Fusion fusion) {
    RenderConfig render = small(64, 32);
    render.fusion = fusion;
    const Frame frame{image, scene.cameras.front(), render, programs, rates, 0, 1};
    return run(*make_program(parse_program("undersample"), frame), traces::BvhTracer(image)).kernels;
  };
  EXPECT_TRUE(launched(Fusion::kOn).contains("check_attributes_x_local_untextured"));
  EXPECT_TRUE(launched(Fusion::kOn).contains("check_attributes_y_untextured"));
  EXPECT_TRUE(launched(Fusion::kOn).contains("count_coloured")) << "samples of neighbours count, too";
  EXPECT_FALSE(launched(Fusion::kOff).contains("check_attributes_x_local_untextured"));
}

class FusedKernelsOf : public testing::TestWithParam<std::string> {};
/// Returns all built-in scenes at full size, otherwise the small ones.
std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) {
    if (scene.triangles <= test::full_or(10'000'000U, 60'000U)) names.emplace_back(scene.name);
  }
  return names;
}
INSTANTIATE_TEST_SUITE_P(BuiltIn, FusedKernelsOf, testing::ValuesIn(scene_names()),
                         [](const auto& i) { return i.param; });

TEST_P(FusedKernelsOf, MakeThePictureOfTheirParts) { expect_fusion_to_change_nothing(traces::open_scene(GetParam())); }

TEST(FusedKernels, MakeThePictureOfTheirPartsInTheShowcase) {
  expect_fusion_to_change_nothing(showcase_scene());
  expect_fusion_to_change_nothing(showcase_scene(), {}, {}, traces::MipMaps::kOff);
}

TEST(FusedKernels, MakeThePictureOfTheirPartsWithOptionalChecks) {
  ProgramConfig programs;
  programs.multirate.texture = 0.1;
  programs.undersample.samples = 4;
  programs.supersample.propagate = 2;
  expect_fusion_to_change_nothing(showcase_scene(), {}, programs);
}

TEST(FusedKernels, MakeThePictureOfTheirPartsWithInstances) {
  traces::BvhConfig bvh;
  bvh.instances = traces::InstanceLevels::kTwoLevel;
  expect_fusion_to_change_nothing(showcase_scene(), bvh);
  expect_fusion_to_change_nothing(traces::open_scene("cornell"), bvh);
}

}  // namespace
}  // namespace kernels
