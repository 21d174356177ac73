#pragma once
// Includes the header of the installed Embree, version 3.13 or 4. Only .cc files of this folder include this file.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace traces {

/// Deleter of an Embree handle, which releases one reference.
template <class Handle, void (*kRelease)(Handle)>
struct EmbreeRelease {
  void operator()(Handle handle) const { kRelease(handle); }
};
template <class Handle, void (*kRelease)(Handle)>
using EmbreeOwner = std::unique_ptr<std::remove_pointer_t<Handle>, EmbreeRelease<Handle, kRelease>>;

using EmbreeDevice = EmbreeOwner<RTCDevice, rtcReleaseDevice>;
using EmbreeBvh = EmbreeOwner<RTCBVH, rtcReleaseBVH>;
using EmbreeScene = EmbreeOwner<RTCScene, rtcReleaseScene>;
using EmbreeGeometry = EmbreeOwner<RTCGeometry, rtcReleaseGeometry>;

inline EmbreeDevice open_embree(const std::string& options) {
  EmbreeDevice device(rtcNewDevice(options.c_str()));
  if (!device && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (!device) throw std::runtime_error("Embree does not start with options '" + options + "'");
  return device;
}

/// Throws if the Embree device reports an error. `doing` names the operation for the message.
inline void check_embree(RTCDevice device, const std::string& doing) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree error " + std::to_string(static_cast<int>(error)) + " while " + doing);
  }
}

}  // namespace traces
