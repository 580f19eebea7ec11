// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "plugin_api/text_file.h"
#include "realitycapture/xmp_reader.h"

namespace alidade {

namespace {

const std::string kAdvice = "Export the XMP files from RealityCapture again";
constexpr int kMaxDepth = 16;

bool isCalled(const char* name, std::string_view wanted) { return std::string_view(name) == wanted; }

/// The rdf:Description that carries xcr's properties.
pugi::xml_node descriptionOf(const pugi::xml_node& node, int depth) {
  if (depth > kMaxDepth) return {};
  for (const pugi::xml_node child : node.children()) {
    if (isCalled(child.name(), "rdf:Description")) {
      for (const pugi::xml_attribute attribute : child.attributes())
        if (std::string_view(attribute.name()).starts_with("xcr:")) return child;
      for (const pugi::xml_node inner : child.children())
        if (std::string_view(inner.name()).starts_with("xcr:")) return child;
    }
    if (const auto found = descriptionOf(child, depth + 1)) return found;
  }
  return {};
}

/// An attribute or an element: RealityCapture has written both.
std::string_view valueOf(const pugi::xml_node& description, const char* name) {
  if (const auto attribute = description.attribute(name)) return attribute.as_string();
  return description.child_value(name);
}

Result<std::vector<double>> numbersOf(const pugi::xml_node& description, const char* name, const std::string& path) {
  const std::string_view text = valueOf(description, name);
  const auto numbers = parseNumbers(text, 64);
  if (!numbers) return fail(fmt::format("{} holds something that is no number: {}", name, quotedWords(text)), path, kAdvice);
  if (!std::all_of(numbers->begin(), numbers->end(), [](double v) { return std::isfinite(v); }))
    return fail(fmt::format("{} holds a number that is not finite", name), path, kAdvice);
  return *numbers;
}

Result<double> numberOf(const pugi::xml_node& description, const char* name, double otherwise, const std::string& path) {
  const auto numbers = numbersOf(description, name, path);
  if (!numbers) return fail(numbers.error());
  if (numbers->size() > 1) return fail(fmt::format("{} is not one number", name), path, kAdvice);
  return numbers->empty() ? otherwise : numbers->front();
}

Result<std::optional<RigidTransform>> poseOf(const pugi::xml_node& description, const std::string& path) {
  const auto rotation = numbersOf(description, "xcr:Rotation", path), position = numbersOf(description, "xcr:Position", path);
  if (!rotation) return fail(rotation.error());
  if (!position) return fail(position.error());
  if (rotation->empty() && position->empty()) {
    const bool geographic = !valueOf(description, "xcr:Latitude").empty() || !valueOf(description, "xcr:latitude").empty();
    if (geographic)
      return fail("The file states latitude and longitude, no position in the survey's coordinates", path,
                  "Set a projected output coordinate system in RealityCapture and export the XMP files with exact poses");
    return std::optional<RigidTransform>();
  }
  if (rotation->size() != 9 || position->size() != 3)
    return fail(fmt::format("xcr:Rotation and xcr:Position hold {} and {} numbers, not 9 and 3", rotation->size(), position->size()), path, kAdvice);
  glm::dmat3 matrix;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) matrix[c][r] = (*rotation)[std::size_t(3 * r + c)];
  const auto turned = nearestRotation(matrix);
  if (!turned) return fail("xcr:Rotation is no rotation", path, kAdvice);
  const glm::dvec3 centre((*position)[0], (*position)[1], (*position)[2]);
  // No survey on a map stands that high, and no place on earth stands nearer to its centre or farther.
  const double fromEarthsCentre = glm::length(centre);
  if (std::abs(centre.z) > 2e4 && fromEarthsCentre > 6.34e6 && fromEarthsCentre < 6.4e6)
    return fail("xcr:Position is in earth-centred coordinates", path,
                "Set a projected or local output coordinate system in RealityCapture and export the XMP files again");
  const RigidTransform pose{*turned, -(*turned * centre)};
  if (!pose.isFinite()) return fail("The pose is not finite", path, kAdvice);
  return std::optional<RigidTransform>(pose);
}

/// Why the model cannot be said exactly; empty where it can.
std::string refusalOf(std::string_view model, const std::vector<double>& d, double skew) {
  const bool straight = std::all_of(d.begin(), d.end(), [](double v) { return v == 0; });
  if (skew != 0) return "it has a skew, whose unit is not published";
  if (straight) return {};
  if (model != "brown3" && model != "brown4" && model != "brown3t2" && model != "brown4t2")
    return "its distortion model " + quotedWords(model) + " is covered by no camera model here";
  if (std::any_of(d.begin() + std::ptrdiff_t(std::min<std::size_t>(d.size(), 4)), d.end(), [](double v) { return v != 0; }))
    return "it has tangential coefficients, whose order differs between programs";
  return {};
}

Result<void> takeLens(const pugi::xml_node& description, const std::string& path, std::optional<glm::ivec2> size, XmpCamera& camera) {
  const auto focal = numberOf(description, "xcr:FocalLength35mm", 0, path), aspect = numberOf(description, "xcr:AspectRatio", 1, path),
             u = numberOf(description, "xcr:PrincipalPointU", 0, path), v = numberOf(description, "xcr:PrincipalPointV", 0, path),
             skew = numberOf(description, "xcr:Skew", 0, path);
  for (const auto* number : {&focal, &aspect, &u, &v, &skew})
    if (!*number) return fail(number->error());
  // The format's own spelling, and the right one.
  auto lens = numbersOf(description, "xcr:DistortionCoeficients", path);
  if (lens && lens->empty()) lens = numbersOf(description, "xcr:DistortionCoefficients", path);
  if (!lens) return fail(lens.error());
  if (*focal == 0) return camera.noIntrinsics = "it states no focal length", Result<void>();
  if (!size) return camera.noIntrinsics = "there is no picture beside it, so that its size is unknown", Result<void>();
  camera.noIntrinsics = refusalOf(valueOf(description, "xcr:DistortionModel"), *lens, *skew);
  if (!camera.noIntrinsics.empty()) return {};

  lens->resize(4, 0.0);
  const double side = std::max(size->x, size->y), f = *focal / 36 * side;
  const double cx = 0.5 * size->x + *u * side - 0.5, cy = 0.5 * size->y + *v * side - 0.5;
  const auto& k = *lens;
  Result<Intrinsics> made;
  if (k[3] != 0)
    made = Intrinsics::fromParameters(CameraModel::BrownSkewed, size->x, size->y, {f, f * *aspect, cx, cy, k[0], k[1], k[2], k[3], 0, 0, 0, 0, 0});
  else
    made = Intrinsics::fromParameters(CameraModel::OpenCv5, size->x, size->y, {f, f * *aspect, cx, cy, k[0], k[1], 0, 0, k[2]});
  if (!made) return fail(made.error().in(path));
  camera.intrinsics = *made;
  return {};
}

}  // namespace

Result<XmpCamera> parseXmp(const std::string& text, const std::string& path, std::optional<glm::ivec2> size) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) return fail(fmt::format("The XMP is damaged: {}", parsed.description()), fmt::format("{}, byte {}", path, parsed.offset), kAdvice);
  const auto description = descriptionOf(document, 0);
  if (!description) return fail("The XMP carries nothing of RealityCapture's", path, kAdvice);
  XmpCamera camera;
  auto pose = poseOf(description, path);
  if (!pose) return fail(pose.error());
  camera.cameraFromWorld = *pose;
  camera.relative = valueOf(description, "xcr:Coordinates") == "relative";
  if (auto taken = takeLens(description, path, size, camera); !taken) return fail(taken.error());
  return camera;
}

}  // namespace alidade
