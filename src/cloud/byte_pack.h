// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace alidade {

/// Plain values one after the other, in the machine's byte order: for files that only this machine goes on with.
class BytePacker {
 public:
  template <class T>
    requires std::is_trivially_copyable_v<T>
  void put(const T& value) {
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(T));
  }
  template <class T>
  void putAll(const std::vector<T>& values) {
    put<std::uint64_t>(values.size());
    const auto* from = reinterpret_cast<const std::byte*>(values.data());
    bytes.insert(bytes.end(), from, from + values.size() * sizeof(T));
  }
  void putText(const std::string& text) { putAll(std::vector<char>(text.begin(), text.end())); }

  std::vector<std::byte> bytes;
};

/// Reads what BytePacker wrote. Past the end, or a length beyond it, gives zeros and ok() turns false.
class ByteUnpacker {
 public:
  explicit ByteUnpacker(std::span<const std::byte> bytes) : m_bytes(bytes) {}

  template <class T>
    requires std::is_trivially_copyable_v<T>
  T get() {
    T value{};
    if (m_bytes.size() < sizeof(T)) {
      m_ok = false;
      return value;
    }
    std::memcpy(static_cast<void*>(&value), m_bytes.data(), sizeof(T));
    m_bytes = m_bytes.subspan(sizeof(T));
    return value;
  }
  template <class T>
  std::vector<T> getAll() {
    const auto count = get<std::uint64_t>();
    if (count > m_bytes.size() / sizeof(T)) {
      m_ok = false;
      return {};
    }
    std::vector<T> values(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), m_bytes.data(), count * sizeof(T));
    m_bytes = m_bytes.subspan(count * sizeof(T));
    return values;
  }
  std::string getText() {
    const std::vector<char> text = getAll<char>();
    return {text.begin(), text.end()};
  }
  bool ok() const { return m_ok; }

 private:
  std::span<const std::byte> m_bytes;
  bool m_ok = true;
};

/// A checksum against truncation and stray bits, eight bytes at a time; not against malice.
inline std::uint64_t checksumOf(std::span<const std::byte> bytes) {
  std::uint64_t sum = 0x9e3779b97f4a7c15ull ^ bytes.size();
  while (!bytes.empty()) {
    std::uint64_t word = 0;
    const std::size_t n = bytes.size() < sizeof word ? bytes.size() : sizeof word;
    std::memcpy(&word, bytes.data(), n);
    sum = (sum ^ word) * 0xbf58476d1ce4e5b9ull;
    sum ^= sum >> 29;
    bytes = bytes.subspan(n);
  }
  return sum;
}

}  // namespace alidade
