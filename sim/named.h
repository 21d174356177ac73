#pragma once

namespace sim {

/// Returns the name of the member that an expression ends with: "size" for "config.l1.size".
consteval const char* member_name(const char* expression) {
  const char* name = expression;
  for (const char* c = expression; *c != '\0'; ++c) {
    if (*c == '.') name = c + 1;
  }
  return name;
}

}  // namespace sim

/// Expands to two arguments, a member and its name, as in field(NAMED(c.rays), "rays", ...).
#define NAMED(member) member, ::sim::member_name(#member)
