#include "shader_kernels/programs/wavefront/render_config.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/did_you_mean.h"

namespace kernels {
namespace {

constexpr std::string_view kNoEffects = "none";

std::string_view without_spaces(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

}  // namespace

Effects parse_effects(std::string_view text) {
  constexpr auto kNames = names_of(Effect{});
  Effects effects;
  if (without_spaces(text) == kNoEffects) return effects;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view name = without_spaces(rest.substr(0, comma));
    const auto found = std::ranges::find(kNames, name);
    if (found == kNames.end()) {
      const std::vector<std::string> known(kNames.begin(), kNames.end());
      throw sim::InputError(fmt::format("'{}' is no effect{}; allowed: {}, or several of {} between commas",
                                        sim::printable(std::string(name)), traces::did_you_mean(name, known),
                                        kNoEffects, fmt::join(kNames, ", ")));
    }
    effects.add(static_cast<Effect>(found - kNames.begin()));
    if (comma == std::string_view::npos) return effects;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace kernels
