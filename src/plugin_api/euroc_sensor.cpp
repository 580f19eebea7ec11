// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/euroc_sensor.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "plugin_api/text_file.h"
#include "plugin_api/yaml_fields.h"

namespace alidade {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 20;
/// What a matrix printed with a few digits may be off a rotation.
constexpr double kNearlyRotation = 1e-3;

const std::string kAdvice = "Choose the sensor.yaml of a camera's folder, as the EuRoC data sets have it";

std::string wordOf(const TextFields& fields, std::string_view key) {
  const auto found = fields.find(key);
  return found == fields.end() ? std::string() : lowerCase(found->second);
}

/// As many numbers as wanted, in brackets.
Result<std::vector<double>> numbersOf(const TextFields& fields, const std::string& key, std::size_t count, const std::string& path) {
  const auto found = fields.find(key);
  if (found == fields.end()) return fail("'" + key + "' is missing", path, kAdvice);
  std::string text = found->second;
  for (char& c : text)
    if (c == '[' || c == ']' || c == ',') c = ' ';
  const auto values = parseNumbers(text, count);
  if (!values || values->size() != count) return fail(fmt::format("'{}' is not a list of {} numbers", key, count), path, kAdvice);
  for (const double value : *values)
    if (!std::isfinite(value)) return fail("'" + key + "' holds a number that is not finite", path, kAdvice);
  return *values;
}

Result<CameraModel> modelOf(const TextFields& fields, const std::string& path) {
  if (const std::string type = wordOf(fields, "sensor_type"); !type.empty() && type != "camera")
    return fail("The sensor is no camera but " + quotedWords(type), path, kAdvice);
  if (const std::string camera = wordOf(fields, "camera_model"); camera != "pinhole")
    return fail("The camera_model " + quotedWords(camera) + " is not read", path, "Read is pinhole");
  const std::string lens = wordOf(fields, "distortion_model");
  if (lens == "radial-tangential" || lens == "radtan") return CameraModel::OpenCv4;
  if (lens == "equidistant") return CameraModel::OpenCvFisheye;
  return fail("The distortion_model " + quotedWords(lens) + " is not read", path, "Read are radial-tangential and equidistant");
}

Result<RigidTransform> transformOf(const std::vector<double>& m, const std::string& path) {
  glm::dmat3 rotation;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) rotation[column][row] = m[static_cast<std::size_t>(4 * row + column)];
  const glm::dmat3 square = glm::transpose(rotation) * rotation;
  double worst = std::abs(glm::determinant(rotation) - 1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(square[i][j] - (i == j ? 1 : 0)));
  if (!(worst < kNearlyRotation) || m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    return fail("'T_BS' is no rigid transform: a rotation, a position and the row 0 0 0 1 are expected", path, kAdvice);
  return RigidTransform{glm::normalize(glm::quat_cast(rotation)), {m[3], m[7], m[11]}};
}

}  // namespace

Result<EurocSensor> parseEurocSensor(std::string_view text, const std::string& path) {
  if (trimmed(text).empty()) return fail("The sensor file is empty", path, kAdvice);
  if (text.find('\0') != std::string_view::npos) return fail("The sensor file is no text file", path, kAdvice);
  const TextFields fields = yamlFields(text);
  const auto model = modelOf(fields, path);
  if (!model) return fail(model.error());
  const auto size = numbersOf(fields, "resolution", 2, path);
  if (!size) return fail(size.error());
  const auto possible = [](double v) { return v >= 1 && v <= 1 << 20 && v == std::floor(v); };
  if (!possible((*size)[0]) || !possible((*size)[1]))
    return fail(fmt::format("The resolution {} × {} is impossible", (*size)[0], (*size)[1]), path, "Give it in whole pixels");
  auto parameters = numbersOf(fields, "intrinsics", 4, path);
  if (!parameters) return fail(parameters.error());
  const auto lens = numbersOf(fields, "distortion_coefficients", 4, path);
  if (!lens) return fail(lens.error());
  // fu fv cu cv, and then the lens, is the order of OpenCV's models.
  parameters->insert(parameters->end(), lens->begin(), lens->end());
  const auto intrinsics = Intrinsics::fromParameters(*model, static_cast<int>((*size)[0]), static_cast<int>((*size)[1]), *parameters);
  if (!intrinsics) return fail(intrinsics.error().in(path));
  if (auto valid = intrinsics->validate(); !valid) return fail(valid.error().in(path));
  const auto matrix = numbersOf(fields, "T_BS.data", 16, path);
  if (!matrix) return fail(matrix.error());
  const auto transform = transformOf(*matrix, path);
  if (!transform) return fail(transform.error());
  return EurocSensor{*intrinsics, *transform};
}

Result<std::optional<EurocSensor>> readEurocSensor(const std::string& path) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return fail(text.error());
  if (!looksLikeEurocSensor(*text)) return std::nullopt;
  auto sensor = parseEurocSensor(*text, path);
  if (!sensor) return fail(sensor.error());
  return std::move(*sensor);
}

bool looksLikeEurocSensor(std::string_view head) {
  const auto holds = [&](std::string_view words) { return head.find(words) != std::string_view::npos; };
  return holds("T_BS") && (holds("sensor_type") || holds("distortion_model"));
}

}  // namespace alidade
