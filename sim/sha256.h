#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace sim {

/// Computes the SHA-256 digest of bytes that are added in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void add(std::string_view bytes);
  /// Returns the digest as 64 lower-case hexadecimal digits. More bytes may be added afterwards.
  std::string hex_digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns the SHA-256 digest of a text as 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

}  // namespace sim
