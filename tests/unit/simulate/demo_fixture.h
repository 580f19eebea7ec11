// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/rigid_transform.h"
#include "simulate/demo_site.h"

namespace alidade::demo_test {

inline std::string freshFolder(const std::string& name) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("alidade-demo-" + std::to_string(::getpid()) + "-" + name);
  std::filesystem::remove_all(folder);
  return folder.string();
}

inline DemoOptions smallOptions() {
  DemoOptions options;
  options.points = 10'000;
  options.frames = 2;
  options.width = 320;
  options.height = 240;
  return options;
}

inline std::string bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

template <class T>
T valueAt(const std::string& bytes, std::size_t at) {
  T value{};
  EXPECT_LE(at + sizeof value, bytes.size());
  if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <class T>
std::vector<T> arrayOf(const std::string& path) {
  const std::string bytes = bytesOf(path);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

inline glm::dvec3 vectorOf(const nlohmann::json& json) {
  return {json.at(0), json.at(1), json.at(2)};
}

inline RigidTransform transformOf(const nlohmann::json& json) {
  const auto& q = json.at("rotation_wxyz");
  return {
      glm::dquat(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>()),
      vectorOf(json.at("translation_m"))};
}

/// One small site for all tests of this binary, and its truth.json.
class DemoSiteTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (s_site) return;
    const auto made = writeDemoSite(freshFolder("shared"), smallOptions(), Progress());
    ASSERT_TRUE(made) << made.error().text();
    s_site = new DemoSite(*made);
    s_truth = new nlohmann::json(nlohmann::json::parse(bytesOf(made->truth + "/truth.json")));
  }
  static void TearDownTestSuite() {
    if (!s_site) return;
    std::filesystem::remove_all(std::filesystem::path(s_site->scan).parent_path());
    delete s_site;
    delete s_truth;
    s_site = nullptr;
    s_truth = nullptr;
  }
  void SetUp() override { ASSERT_TRUE(s_site != nullptr); }

  static const DemoSite& site() { return *s_site; }
  static const nlohmann::json& truth() { return *s_truth; }
  static const nlohmann::json& element(const std::string& name) {
    for (const auto& one : truth().at("elements"))
      if (one.at("name") == name) return one;
    ADD_FAILURE() << "no element " << name;
    return truth().at("elements").at(0);
  }

 private:
  static inline DemoSite* s_site = nullptr;
  static inline nlohmann::json* s_truth = nullptr;
};

}  // namespace alidade::demo_test
