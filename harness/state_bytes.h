// Plain values in and out of a UnitState: equal values give equal bytes.
#pragma once

#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "harness/unit.h"

namespace quayside::harness {

class ByteWriter {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>, "structs have padding: put their members one by one");
    const auto* first = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(T));
  }
  void put(const double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) put(values[i]);
  }
  UnitState take() { return std::move(bytes_); }

 private:
  UnitState bytes_;
};

// Throws std::invalid_argument when the bytes end early, or when some are left at `finish`.
class ByteReader {
 public:
  explicit ByteReader(const UnitState& bytes) : bytes_(bytes) {}

  template <typename T>
  T get() {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    if (bytes_.size() - position_ < sizeof(T)) throw std::invalid_argument("a saved state is too short for this unit");
    T value;
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }
  template <typename T>
  void get(T& value) {
    value = get<T>();
  }
  void get(double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) get(values[i]);
  }
  void finish() const {
    if (position_ != bytes_.size()) throw std::invalid_argument("a saved state is too long for this unit");
  }

 private:
  const UnitState& bytes_;
  std::size_t position_ = 0;
};

}  // namespace quayside::harness
