#include "tools/host/build_info.h"

#include "build_info_data.h"

namespace tools {

BuildInfo build_info() {
  return {RAYWATT_VERSION,  RAYWATT_GIT,       RAYWATT_GIT_DIRTY,  RAYWATT_COMPILER,  RAYWATT_FLAGS,
          RAYWATT_MODEL_ID, RAYWATT_REPORT_ID, RAYWATT_SOURCE_DIR, RAYWATT_BINARY_DIR};
}

}  // namespace tools
