// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/e57_images.h"

#include <fmt/format.h>

#include "e57/e57_element.h"

namespace alidade {

namespace {

constexpr int kMostPixels = 1 << 20;  // a side

Result<double> number(const pugi::xml_node& node, const char* name) {
  if (!node.child(name)) return 0.0;
  const auto value = numberOf(node.child(name));
  if (!value) return fail(fmt::format("Its {} is no number", name));
  return *value;
}

Result<void> takeBlob(const pugi::xml_node& blob, E57Image& image) {
  const auto offset = integerAttribute(blob, "fileOffset"), length = integerAttribute(blob, "length");
  if (!offset) return fail(offset.error());
  if (!length) return fail(length.error());
  if (offset->value_or(-1) < 0 || length->value_or(-1) < 0) return fail("Its picture has no fileOffset or no length, or a negative one");
  image.fileOffset = static_cast<std::uint64_t>(**offset);
  image.length = static_cast<std::uint64_t>(**length);
  return {};
}

Result<void> takeRepresentation(const pugi::xml_node& node, E57Image& image) {
  if (const auto jpeg = node.child("jpegImage")) {
    image.coding = E57Image::Coding::Jpeg;
    if (auto ok = takeBlob(jpeg, image); !ok) return ok;
  } else if (const auto png = node.child("pngImage")) {
    image.coding = E57Image::Coding::Png;
    if (auto ok = takeBlob(png, image); !ok) return ok;
  }
  const auto width = integerOf(node.child("imageWidth")), height = integerOf(node.child("imageHeight"));
  if (!width || !height || *width < 0 || *height < 0 || *width > kMostPixels || *height > kMostPixels)
    return fail("Its imageWidth or imageHeight is missing or no size of a picture");
  image.width = static_cast<int>(*width);
  image.height = static_cast<int>(*height);
  const std::pair<const char*, double*> numbers[] = {
      {"focalLength", &image.focalLength}, {"pixelWidth", &image.pixelWidth}, {"pixelHeight", &image.pixelHeight},
      {"principalPointX", &image.principalX}, {"principalPointY", &image.principalY}};
  for (const auto& [name, into] : numbers) {
    const auto value = number(node, name);
    if (!value) return fail(value.error());
    *into = *value;
  }
  return {};
}

}  // namespace

Result<E57Image> e57ImageOf(const pugi::xml_node& node, std::size_t index) {
  E57Image image;
  image.name = textOf(node.child("name"));
  if (image.name.empty()) image.name = fmt::format("Picture {}", index + 1);
  if (const auto pose = node.child("pose")) {
    const auto transform = poseOf(pose);
    if (!transform) return fail(transform.error());
    image.worldFromCamera = *transform;
    image.hasPose = true;
  }
  const std::pair<const char*, E57Image::Projection> kinds[] = {
      {"visualReferenceRepresentation", E57Image::Projection::Visual},
      {"cylindricalRepresentation", E57Image::Projection::Cylindrical},
      {"sphericalRepresentation", E57Image::Projection::Spherical},
      {"pinholeRepresentation", E57Image::Projection::Pinhole}};  // the last one found counts: it says most
  for (const auto& [name, projection] : kinds) {
    const auto representation = node.child(name);
    if (!representation) continue;
    image.projection = projection;
    if (auto ok = takeRepresentation(representation, image); !ok) return fail(ok.error());
  }
  for (const pugi::xml_node child : node.children()) {
    if (localName(child) != "distortion") continue;
    for (const pugi::xml_node each : child.children())
      if (const auto value = numberOf(each)) image.distortion.emplace_back(std::string(localName(each)), *value);
  }
  return image;
}

}  // namespace alidade
