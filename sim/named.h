#pragma once

namespace sim {

/// The member's name at the end of an expression such as "config.l1.size".
consteval const char* member_name(const char* expression) {
  const char* name = expression;
  for (const char* c = expression; *c != '\0'; ++c) {
    if (*c == '.') name = c + 1;
  }
  return name;
}

}  // namespace sim

/// A member and its name as two arguments, so that a declaration says it once: field(NAMED(c.rays), "rays", ...).
#define NAMED(member) member, ::sim::member_name(#member)
