#include "hw_models/tni/tni_config.h"

namespace hw {

using traces::NodeFormat;

std::vector<sim::UnitPart> TrvConfig::parts(const TreeKind& tree) const {
  const bool q12 = tree.wide && tree.format == NodeFormat::kQ12, q8 = tree.is_decoded() && !q12;
  return {{"box_tester", q8 || q12 ? 0 : box_testers},
          {"box_tester_q8", q8 ? box_testers : 0},
          {"box_tester_q12", q12 ? box_testers : 0},
          {"node_decoder", tree.is_decoded() ? 1U : 0U},
          {"comparator", tree.comparisons(tree.slots) + (gather == Gather::kOff ? 0 : rays)}};
}

std::vector<sim::UnitPart> IstConfig::parts(const TreeKind& tree) const {
  return {{"block_decoder", tree.leaf == traces::LeafFormat::kBlock128 ? 1U : 0U}};
}

}  // namespace hw
