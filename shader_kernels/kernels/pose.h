#pragma once
#include <string_view>

#include "shader_kernels/kernels/build_tree.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/value.h"
#include "sim/named.h"

namespace kernels {

// Kernels that move geometry to the pose of a frame, before its trees are built or refitted. Matrices of nodes and
// joints are computed by the host, as by applications.

/// Position of a vertex.
template <class V>
struct PointRecord {
  Vec3<V> at;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.at)); }
};

/// The four joints of a skinned vertex, two in each word, and their weights: 24 bytes.
template <class V>
struct SkinRecord {
  I<V> joints01, joints23;
  F<V> weight0, weight1, weight2, weight3;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.joints01, r.joints23, r.weight0, r.weight1, r.weight2, r.weight3));
  }
};

/// The columns of an affine matrix, 48 bytes.
template <class V>
struct MatrixRecord {
  Vec3<V> x, y, z, origin;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.x, r.y, r.z, r.origin)); }
};

/// Record that the application writes to update an instance: matrix to the world, root node and object id, 56 bytes.
template <class V>
struct PosedInstanceRecord {
  Vec3<V> x, y, z, origin;
  I<V> root, object;
  static void fields(auto& r, auto&& field) { name_all(field, NAMED_ALL(r.x, r.y, r.z, r.origin, r.root, r.object)); }
};

/// The record of an instance, as traces::InstanceRecord.
template <class V>
struct EncodedInstance {
  Vec3<V> row0;
  F<V> origin0;
  Vec3<V> row1;
  F<V> origin1;
  Vec3<V> row2;
  F<V> origin2;
  I<V> root, object;
  F<V> handedness, volume;
  static void fields(auto& r, auto&& field) {
    name_all(field, NAMED_ALL(r.row0, r.origin0, r.row1, r.origin1, r.row2, r.origin2, r.root, r.object, r.handedness,
                              r.volume));
  }
};

template <class V>
Vec3<V> transform_point(const MatrixRecord<V>& m, const Vec3<V>& p) {
  return m.x * p.x + m.y * p.y + m.z * p.z + m.origin;
}

/// Moves a vertex by its four joints: linear blend skinning.
struct SkinVertex {
  static constexpr std::string_view kName = "skin_vertex";
  static constexpr std::string_view kMeaning = "vertex in its rest pose, joints, weights -> posed vertex";
  template <class V>
  struct Ports {
    Local<V, PointRecord> rest;
    Local<V, SkinRecord> skin;
    Local<V, MatrixRecord> joints;
    Local<V, PointRecord> posed;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.rest, p.skin, p.joints, p.posed));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const PointRecord<V> rest = io.rest.load(item);
    const SkinRecord<V> skin = io.skin.load(item);
    const MatrixRecord<V> joint0 = io.joints.load(skin.joints01 & 0xffffU);
    const MatrixRecord<V> joint1 = io.joints.load(skin.joints01 >> 16U);
    const MatrixRecord<V> joint2 = io.joints.load(skin.joints23 & 0xffffU);
    const MatrixRecord<V> joint3 = io.joints.load(skin.joints23 >> 16U);
    const Vec3<V> at0 = transform_point<V>(joint0, rest.at) * skin.weight0;
    const Vec3<V> at1 = transform_point<V>(joint1, rest.at) * skin.weight1;
    const Vec3<V> at2 = transform_point<V>(joint2, rest.at) * skin.weight2;
    const Vec3<V> at3 = transform_point<V>(joint3, rest.at) * skin.weight3;
    io.posed.store(item, {at0 + at1 + at2 + at3});
  }
};

/// Moves a vertex of a rigid mesh to the world.
struct PoseVertex {
  static constexpr std::string_view kName = "pose_vertex";
  static constexpr std::string_view kMeaning = "vertex of a rigid mesh -> vertex in the world";
  template <class V>
  struct Ports {
    Local<V, PointRecord> rest, posed;
    Vec3<V> to_world_x, to_world_y, to_world_z, to_world_origin;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.rest, p.posed, p.to_world_x, p.to_world_y, p.to_world_z, p.to_world_origin));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const PointRecord<V> rest = io.rest.load(item);
    const MatrixRecord<V> to_world{io.to_world_x, io.to_world_y, io.to_world_z, io.to_world_origin};
    io.posed.store(item, {transform_point<V>(to_world, rest.at)});
  }
};

/// Writes the record of an instance that has moved: the inverse of its matrix.
struct PoseInstance {
  static constexpr std::string_view kName = "pose_instance";
  static constexpr std::string_view kMeaning = "matrix of an instance -> its record";
  template <class V>
  struct Ports {
    Local<V, PosedInstanceRecord> moved;
    Local<V, EncodedInstance> encoded;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.moved, p.encoded)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const PosedInstanceRecord<V> m = io.moved.load(item);
    const Vec3<V> yz = cross<V>(m.y, m.z), zx = cross<V>(m.z, m.x), xy = cross<V>(m.x, m.y);
    const F<V> volume = dot<V>(m.x, yz);
    const F<V> inverse = F<V>(1.0F) / volume;
    const Vec3<V> row0 = yz * inverse, row1 = zx * inverse, row2 = xy * inverse;
    const F<V> handedness = select(volume < F<V>(0.0F), F<V>(-1.0F), F<V>(1.0F));
    io.encoded.store(item, {row0, -dot<V>(row0, m.origin), row1, -dot<V>(row1, m.origin), row2, -dot<V>(row2, m.origin),
                            m.root, m.object, handedness, abs(volume)});
  }
};

/// Computes the box of an instance in the world from the box of its mesh.
struct BoundInstance {
  static constexpr std::string_view kName = "bound_instance";
  static constexpr std::string_view kMeaning = "matrix and mesh of an instance -> its box";
  template <class V>
  struct Ports {
    Local<V, PosedInstanceRecord> moved;
    Local<V, BoxRecord> meshes, boxes;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.moved, p.meshes, p.boxes)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const PosedInstanceRecord<V> m = io.moved.load(item);
    const BoxRecord<V> mesh = io.meshes.load(item);
    const Vec3<V> x0 = m.x * mesh.lower.x, x1 = m.x * mesh.upper.x, y0 = m.y * mesh.lower.y, y1 = m.y * mesh.upper.y;
    const Vec3<V> z0 = m.z * mesh.lower.z, z1 = m.z * mesh.upper.z;
    const Vec3<V> lower = m.origin + min_of<V>(x0, x1) + min_of<V>(y0, y1) + min_of<V>(z0, z1);
    const Vec3<V> upper = m.origin + max_of<V>(x0, x1) + max_of<V>(y0, y1) + max_of<V>(z0, z1);
    io.boxes.store(item, {lower, upper});
  }
};

}  // namespace kernels
