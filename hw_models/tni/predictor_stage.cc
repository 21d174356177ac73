#include "hw_models/tni/predictor_stage.h"

#include <algorithm>

#include <fmt/format.h>

#include "traces/walk.h"

namespace hw {

sim::Time PredictorStage::tick(sim::Time now) {
  const bool passed = pass_ray(now);
  while (passed && ideal_ && pass_ray(now)) {
  }
  const auto waiting = [&](sim::Time at) {
    return links_.rays_in.can_pop(at) ? CycleReason::kOutputFull : CycleReason::kStarved;
  };
  const sim::Time next = clock_.edge_after(now, 1);
  activity_.spend(now, clock_.period(), passed ? CycleReason::kPredicting : waiting(now), waiting(next));
  return links_.rays_in.can_pop(next) ? std::max(next, links_.rays_out.push_at()) : links_.rays_in.pop_at();
}

bool PredictorStage::pass_ray(sim::Time now) {
  if (!links_.rays_in.can_pop(now) || !links_.rays_out.can_push(now)) return false;
  RayJob job = links_.rays_in.pop(now);
  stats_.rays += 1;
  if (const std::uint32_t word = *job.walk; traces::is_look_up(word)) {
    const bool predicted = traces::node_of(word) != traces::kNoPrediction;
    stats_.look_ups += 1;
    stats_.predicted += predicted;
    stats_.correct += traces::is_correct_look_up(word);
    stats_.wrong += predicted && !traces::is_correct_look_up(word);
    stats_.updates += traces::stores_hit(word);
    job.walk += 1;
  }
  links_.rays_out.push(now, job);
  return true;
}

std::string PredictorStage::state() const {
  return fmt::format("rays {}, waiting {}", stats_.rays, links_.rays_in.empty() ? "none" : "some");
}

}  // namespace hw
