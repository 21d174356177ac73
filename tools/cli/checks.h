#pragma once

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tools {

/// Has the options of all verbs that are there refuse an empty value: as a rule, that of a variable that is not set.
/// --set says itself what it takes.
void refuse_empty_values(CLI::App& app);

/// Refuses a negative number, which CLI11 takes for a huge one.
void refuse_negative(CLI::Option& option);

}  // namespace tools
