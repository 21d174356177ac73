#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "shader_kernels/graph.h"
#include "shader_kernels/kernels/build_tree.h"
#include "shader_kernels/kernels/classify.h"
#include "shader_kernels/kernels/collapse.h"
#include "shader_kernels/kernels/denoise.h"
#include "shader_kernels/kernels/details.h"
#include "shader_kernels/kernels/effects.h"
#include "shader_kernels/kernels/fused.h"
#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/kernels/layers.h"
#include "shader_kernels/kernels/light.h"
#include "shader_kernels/kernels/path.h"
#include "shader_kernels/kernels/pixels.h"
#include "shader_kernels/kernels/pose.h"
#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/kernels/record_hits.h"
#include "shader_kernels/kernels/secondary_rays.h"
#include "shader_kernels/kernels/shade_surface.h"
#include "shader_kernels/kernels/similarity.h"
#include "shader_kernels/kernels/subpixels.h"
#include "traces/stream.h"

namespace kernels {

/// All kernel types of the simulator. A kernel's position in this list is its KernelId.
using AllKernels = std::tuple<
    GenerateRays, GenerateJitteredRays, ClassifyLayers, TestAlpha<false, false>, TestAlpha<true, false>,
    TestShadow<false, false>, TestShadow<true, false>, ScatterLayers, ClassifyHits, ShadeBackground,
    ShadeSurface<false>, ClassifyDetails, Absorb, FetchVertices<false>, ShadeBase<>, ShadePhysical<>, ShadeBump<>,
    ShadeBlend, ClassifySurfaces, ShadeTextured<>, ShadeEmission, ShadeGlow<>, ShadeAmbient, ShadeOccluded<>,
    ShadeDiffuse, CombineShadow, ShadeStraight, ShadeMirror, ShadeGlass, AverageColour, PackColour,
    // Kernels of adaptive sampling.
    ListSamples, GenerateListedRays, ClearGeometry, ClearSecondary, RecordGeometry<false>, RecordSurface<false>,
    RecordSecondary<false>, RecordShadow, RecordSecondaryShadow, CheckSimilarity<false, false, false>,
    CheckSimilarity<false, true, false>, CheckSimilarity<true, false, false>, CheckSimilarity<true, true, false>,
    CheckSimilarity<false, false, true>, CheckSimilarity<false, true, true>, CheckSimilarity<true, false, true>,
    CheckSimilarity<true, true, true>, InterpolateSample<false, false>, InterpolateSample<false, true>,
    InterpolateSample<true, false>, AverageSamples, ClearSurface, RecordLocal<false>, RecordLocal<true>, RecordGlobal,
    CheckAttributes<false, true>, CheckAttributes<true, true>, InterpolateAttributes<false>,
    InterpolateAttributes<true>, ShadeVisible, ClassifyOccluded, StoreIdentities<false>, StoreIdentities<true>,
    FindSuspects<false>, FindSuspects<true>,
    // Kernels of the supersample program.
    ClearTraits, RecordTraits<false>, RecordTraitsShadow, WeighBranch, RecordBranch<false>, RecordBranchShadow,
    TestSubpixels, WeighCentres<false>, WeighCentres<true>, PackSubpixels, PackSubpixelsAtomic, GenerateExtraRays,
    SumSubpixels, ShowSubpixels<false>, ShowSubpixels<true>, SettleSubpixels, PropagateSubpixels, AverageSubpixels,
    // Variants for scenes with instances.
    ShadeSurface<true>, FetchVertices<true>, TestAlpha<false, true>, TestAlpha<true, true>, TestShadow<false, true>,
    TestShadow<true, true>, RecordGeometry<true>, RecordSurface<true>, RecordSecondary<true>, RecordTraits<true>,
    RecordBranch<true>,
    // Variants for mip maps.
    ShadeSurface<false, true>, ShadeSurface<true, true>, ShadeTextured<MipFilter::kNearest>,
    ShadeTextured<MipFilter::kLinear>, ShadeBase<MipFilter::kNearest>, ShadeBase<MipFilter::kLinear>,
    ShadePhysical<MipFilter::kNearest>, ShadePhysical<MipFilter::kLinear>, ShadeBump<MipFilter::kNearest>,
    ShadeBump<MipFilter::kLinear>, ShadeGlow<MipFilter::kNearest>, ShadeGlow<MipFilter::kLinear>,
    ShadeOccluded<MipFilter::kNearest>, ShadeOccluded<MipFilter::kLinear>,
    // Counts the samples of a tile whose global colour is not faint (program undersample).
    CountColoured,
    // Kernels of the reconstruct programs.
    GenerateRotatedRays, GenerateShadedRays, GenerateVisibleRays, ClearBranch, BeginBranch, RecordVisible,
    RecordBranchVisible, RecordVisibleShadow, LimitColours<0>, LimitColours<1>, LimitColours<2>, ListBranches,
    Reconstruct<1, false>, Reconstruct<2, false>, Reconstruct<1, true>, Reconstruct<2, true>, ListContrasts<0>,
    ListContrasts<1>, ListContrasts<2>, GenerateContrastRays, AverageContrasts<0>, AverageContrasts<1>,
    AverageContrasts<2>,
    // Kernels for soft shadows, ambient occlusion and effects at only some pixels.
    ShadeOpen, ShadeSoft, CastOcclusion, ClearEffects, GenerateCentredRays, SelectEffects<false>, SelectEffects<true>,
    ShadeSoftShare, CastOcclusionShare, CombineRatio, UpsampleEffects<false>, UpsampleEffects<true>,
    // Kernels of the path program, and of rough reflections.
    SeedPaths, KeepVisible, ClassifyLit, SampleLight<false>, SampleLight<true>, SampleLightRough<false>,
    SampleLightRough<true>, ChooseLobe<false>, ChooseLobe<true>, ScatterDiffuse<false>, ScatterDiffuse<true>,
    ScatterRough, AveragePaths, ShadePhysical<MipFilter::kNone, true>, ShadePhysical<MipFilter::kNearest, true>,
    ShadePhysical<MipFilter::kLinear, true>, ReflectRough, CastBounce, TakeBounce,
    // Kernels that build and refit trees.
    BuildLeaf, BoundCentres, BoundBatches, MakeGrid, MortonCode, SortHistogram, SortScan, SortScatter, LinkNode,
    FitNode, EncodeNode, EncodeLeaf, RefitLeaf, RefitNode,
    // Kernels that pose geometry.
    SkinVertex, PoseVertex, PoseInstance, BoundInstance,
    // Kernels that make wide nodes.
    CollapseNode, EncodeChild, QuantiseChild,
    // Kernels of the denoiser.
    ClearGuides, RecordGuide, RecordMovingGuide, SplitLight<true>, SplitLight<false>, AccumulateHistory<true>,
    AccumulateHistory<false>, UnpackTaps<true>, UnpackTaps<false>, FilterLight<true, TapSource::kFirst>,
    FilterLight<true, TapSource::kTile>, FilterLight<true, TapSource::kMemory>, FilterLight<false, TapSource::kFirst>,
    FilterLight<false, TapSource::kTile>, FilterLight<false, TapSource::kMemory>, ModulateAlbedo<true>,
    ModulateAlbedo<false>, SplitGridLight<true>, SplitGridLight<false>,
    // Fused kernels. Their variants are added at the end; tests require that all unfused kernels precede them.
    FetchSurface<false>, FetchSurface<true>, LightSurface, LightSurfaceGeometry<false>, LightSurfaceGeometry<true>,
    LightSurfaceKept<false>, LightSurfaceKept<true>, LightSurfaceSecondary<false>, LightSurfaceSecondary<true>,
    FetchLit<false>, FetchLit<true>, FetchLitGeometry<false>, FetchLitGeometry<true>, FetchLitKept<false>,
    FetchLitKept<true>, FetchLitSecondary<false>, FetchLitSecondary<true>, LightDeferred, GenerateGeometry,
    GenerateSecondary, GenerateSurface, GenerateTraits, CombineRecordShadow, CombineRecordSecondaryShadow,
    CombineRecordTraitsShadow, CombineRecordBranchShadow, CheckInterpolate<false, false, false>,
    CheckInterpolate<false, true, false>, CheckInterpolate<true, false, false>, CheckInterpolate<true, true, false>,
    CheckInterpolate<false, false, true>, CheckInterpolate<false, true, true>, CheckInterpolate<true, false, true>,
    CheckInterpolate<true, true, true>, InterpolateLit<false>, InterpolateLit<true>, CheckAttributes<false, false>,
    CheckAttributes<true, false>, PackSample, PackGridSample, FetchSurface<false, true>, FetchSurface<true, true>,
    FetchLit<false, true>, FetchLit<true, true>, FetchLitGeometry<false, true>, FetchLitGeometry<true, true>,
    FetchLitKept<false, true>, FetchLitKept<true, true>, FetchLitSecondary<false, true>, FetchLitSecondary<true, true>,
    PackIdentified<false>, PackIdentified<true>, RecordCounted, CheckAttributes<false, true, false>,
    CheckAttributes<true, true, false>, CheckAttributes<false, false, false>, CheckAttributes<true, false, false>,
    CombineRecordVisibleShadow, LightSurfaceOpen, LightSurfaceSoft, LightSurfaceOcclusion, FetchLitOpen<false, false>,
    FetchLitOpen<true, false>, FetchLitOpen<false, true>, FetchLitOpen<true, true>, FetchLitSoft<false, false>,
    FetchLitSoft<true, false>, FetchLitSoft<false, true>, FetchLitSoft<true, true>, FetchLitOcclusion<false, false>,
    FetchLitOcclusion<true, false>, FetchLitOcclusion<false, true>, FetchLitOcclusion<true, true>,
    FetchVisible<false, false>, FetchVisible<true, false>, FetchVisible<false, true>, FetchVisible<true, true>>;

template <class K, class... Ks>
constexpr traces::KernelId kernel_index_in(std::type_identity<std::tuple<Ks...>>) {
  traces::KernelId index = 0;
  (void)((std::is_same_v<K, Ks> || (++index, false)) || ...);
  return index;
}
template <class K>
inline constexpr traces::KernelId kKernelId = kernel_index_in<K>(std::type_identity<AllKernels>{});

struct KernelInfo {
  traces::KernelId id = 0;
  std::string_view name;
  std::string_view meaning;
  Graph graph;
  std::vector<std::string_view> parts{};  ///< for a fused kernel: the names of the kernels that it runs
};

/// Returns all kernels, indexed by KernelId. The first call records their graphs.
const std::vector<KernelInfo>& kernel_catalogue();
/// Returns the kernel called `name`, or null if there is none.
const KernelInfo* find_kernel(std::string_view name);

}  // namespace kernels
