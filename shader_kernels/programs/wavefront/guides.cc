#include "shader_kernels/programs/wavefront/guides.h"

namespace kernels {

ProjectionUniforms<float> projection_of(const CameraUniforms<float>& camera) {
  // A picture position (x, y) is seen along corner + right x + down y. The three cross products are, up to a common
  // factor, the dual basis of these vectors.
  const Vec3<float> axis = cross(camera.right, camera.down);
  const float scale = (dot(axis, camera.corner) < 0 ? -1.0F : 1.0F) / sqrt(dot(axis, axis));
  return {camera.origin, cross(camera.down, camera.corner) * scale, cross(camera.corner, camera.right) * scale,
          axis * scale};
}

LaunchResult launch_guides(const WaveContext& wave, const WaveBounce& /*bounce*/, const StageInput& in) {
  const GuideUniforms& guides = *wave.retained.guides;
  if (!guides.has_moved) {
    RecordGuide::Ports<float> ports;
    ports.motion = guides.motion;
    return {wave.graph.launch<RecordGuide>(ports, in.items, in.lanes), 0};
  }
  RecordMovingGuide::Ports<float> ports;
  ports.motion = guides.motion;
  ports.vertices.bind_stored(guides.region, guides.past_word, wave.graph.access_log());
  return {wave.graph.launch<RecordMovingGuide>(ports, in.items, in.lanes), 0};
}

}  // namespace kernels
