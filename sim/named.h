#pragma once

namespace sim {

/// Returns the member's name in an expression: "size" for "config.l1.size".
consteval const char* member_name(const char* expression) {
  const char* name = expression;
  for (const char* c = expression; *c != '\0'; ++c) {
    if (*c == '.') name = c + 1;
  }
  return name;
}

}  // namespace sim

/// Expands to a member and its name as two arguments: field(NAMED(c.rays), "rays", ...).
#define NAMED(member) member, ::sim::member_name(#member)
