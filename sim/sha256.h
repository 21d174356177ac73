#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace sim {

/// SHA-256 of what has been added so far, piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void add(std::string_view bytes);
  /// 64 lower-case hexadecimal digits. More may be added afterwards.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The digest of one piece.
std::string sha256_hex(std::string_view bytes);

}  // namespace sim
