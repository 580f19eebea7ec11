// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

namespace alidade::testing {

/// The bytes of a LAS file, made field by field from the published table of offsets so that a test
/// can break any of them. Little endian, as the machines that run the tests.
struct LasFileMaker {
  std::vector<std::uint8_t> bytes;

  /// A whole file without points: header, then `vlrs`.
  LasFileMaker(int minor, int format, std::uint16_t recordLength) {
    const std::uint16_t headerSize = minor >= 4 ? 375 : minor == 3 ? 235 : 227;
    bytes.assign(headerSize, 0);
    std::memcpy(bytes.data(), "LASF", 4);
    put<std::uint8_t>(24, 1);
    put<std::uint8_t>(25, static_cast<std::uint8_t>(minor));
    std::memcpy(&bytes[58], "maker", 5);
    put<std::uint16_t>(90, 40);
    put<std::uint16_t>(92, 2026);
    put<std::uint16_t>(94, headerSize);
    put<std::uint32_t>(96, headerSize);
    put<std::uint8_t>(104, static_cast<std::uint8_t>(format));
    put<std::uint16_t>(105, recordLength);
    for (int axis = 0; axis < 3; ++axis) put<double>(131 + 8 * axis, 0.001);
  }

  template <class T>
  void put(std::size_t offset, T value) {
    if (bytes.size() < offset + sizeof(T)) bytes.resize(offset + sizeof(T));
    std::memcpy(&bytes[offset], &value, sizeof(T));
  }

  template <class T>
  T get(std::size_t offset) const {
    T value;
    std::memcpy(&value, &bytes[offset], sizeof(T));
    return value;
  }

  /// Appends a record behind the header; call before addPoint.
  void addVlr(const std::string& user, std::uint16_t id, const std::vector<std::uint8_t>& payload) {
    const std::size_t at = bytes.size();
    bytes.resize(at + 54);
    std::memcpy(&bytes[at + 2], user.data(), user.size());
    put<std::uint16_t>(at + 18, id);
    put<std::uint16_t>(at + 20, static_cast<std::uint16_t>(payload.size()));
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    put<std::uint32_t>(96, static_cast<std::uint32_t>(bytes.size()));
    put<std::uint32_t>(100, get<std::uint32_t>(100) + 1);
  }

  void addEvlr(const std::string& user, std::uint16_t id, const std::vector<std::uint8_t>& payload) {
    const std::size_t at = bytes.size();
    bytes.resize(at + 60);
    std::memcpy(&bytes[at + 2], user.data(), user.size());
    put<std::uint16_t>(at + 18, id);
    put<std::uint64_t>(at + 20, payload.size());
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    if (get<std::uint32_t>(243) == 0) put<std::uint64_t>(235, at);
    put<std::uint32_t>(243, get<std::uint32_t>(243) + 1);
  }

  /// Appends a zeroed record with these coordinates and returns where it starts.
  std::size_t addPoint(std::int32_t x, std::int32_t y, std::int32_t z) {
    const std::size_t at = bytes.size();
    bytes.resize(at + get<std::uint16_t>(105));
    put<std::int32_t>(at, x);
    put<std::int32_t>(at + 4, y);
    put<std::int32_t>(at + 8, z);
    if (get<std::uint8_t>(25) >= 4)
      put<std::uint64_t>(247, get<std::uint64_t>(247) + 1);
    else
      put<std::uint32_t>(107, get<std::uint32_t>(107) + 1);
    return at;
  }

  /// One 192-byte entry of the extra bytes record.
  static std::vector<std::uint8_t> extraBytes(const std::string& name, int type, int options = 0) {
    std::vector<std::uint8_t> entry(192, 0);
    entry[2] = static_cast<std::uint8_t>(type);
    entry[3] = static_cast<std::uint8_t>(options);
    std::memcpy(&entry[4], name.data(), name.size());
    return entry;
  }

  /// The GeoTIFF key directory with one inline key after another.
  static std::vector<std::uint8_t> geoKeys(const std::vector<std::pair<std::uint16_t, std::uint16_t>>& keys) {
    std::vector<std::uint16_t> words = {1, 1, 0, static_cast<std::uint16_t>(keys.size())};
    for (const auto& [key, value] : keys) words.insert(words.end(), {key, 0, 1, value});
    std::vector<std::uint8_t> payload(words.size() * 2);
    std::memcpy(payload.data(), words.data(), payload.size());
    return payload;
  }

  /// Writes into a folder that goes with the process.
  std::string write(const std::string& name) const {
    struct Folder {
      std::filesystem::path path =
          std::filesystem::temp_directory_path() / ("alidade_las_" + std::to_string(::getpid()));
      Folder() { std::filesystem::create_directories(path); }
      ~Folder() { std::filesystem::remove_all(path); }
    };
    static const Folder folder;
    const auto path = folder.path / name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path.string();
  }
};

}  // namespace alidade::testing
