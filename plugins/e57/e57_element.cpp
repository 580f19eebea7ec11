// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/e57_element.h"

#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "plugin_api/text_file.h"

namespace alidade {

std::string_view localName(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const auto colon = name.rfind(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

std::optional<double> numberOf(const pugi::xml_node& node) {
  if (!node) return std::nullopt;
  const std::string_view text = trimmed(node.text().get());
  std::optional<double> value = text.empty() ? 0.0 : parseNumber(text);
  if (value && std::strcmp(node.attribute("type").value(), "ScaledInteger") == 0) {
    const auto scale = parseNumber(node.attribute("scale").as_string("1"));
    const auto offset = parseNumber(node.attribute("offset").as_string("0"));
    value = scale && offset ? std::optional(*value * *scale + *offset) : std::nullopt;
  }
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> integerOf(const pugi::xml_node& node) {
  if (!node) return std::nullopt;
  const std::string_view text = trimmed(node.text().get());
  return text.empty() ? 0 : parseInteger(text);
}

std::string textOf(const pugi::xml_node& node) { return std::string(trimmed(node.text().get())); }

Result<std::optional<double>> numberAttribute(const pugi::xml_node& node, const char* name) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return std::optional<double>();
  const auto value = parseNumber(trimmed(attribute.value()));
  if (!value || !std::isfinite(*value))
    return fail(fmt::format("The {} {} of the field {} is no number", name, quotedWords(attribute.value()), node.name()));
  return value;
}

Result<std::optional<std::int64_t>> integerAttribute(const pugi::xml_node& node, const char* name) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return std::optional<std::int64_t>();
  const auto value = parseInteger(trimmed(attribute.value()));
  if (!value)
    return fail(fmt::format("The {} {} of the field {} is no whole number", name, quotedWords(attribute.value()), node.name()));
  return value;
}

Result<RigidTransform> poseOf(const pugi::xml_node& node) {
  RigidTransform pose;
  const auto part = [&](const pugi::xml_node& of, const char* name, double& into) -> bool {
    if (!of.child(name)) return true;
    const auto value = numberOf(of.child(name));
    if (value) into = *value;
    return value.has_value();
  };
  if (const pugi::xml_node rotation = node.child("rotation")) {
    glm::dquat q(0.0, 0.0, 0.0, 0.0);
    if (!part(rotation, "w", q.w) || !part(rotation, "x", q.x) || !part(rotation, "y", q.y) || !part(rotation, "z", q.z))
      return fail("A pose's rotation holds what is no number");
    const double length = std::hypot(std::hypot(q.w, q.x), std::hypot(q.y, q.z));
    if (!std::isfinite(length)) return fail("A pose's rotation is not finite");
    if (length > 0) pose.rotation = glm::dquat(q.w / length, q.x / length, q.y / length, q.z / length);
  }
  const pugi::xml_node translation = node.child("translation");
  if (!part(translation, "x", pose.translation.x) || !part(translation, "y", pose.translation.y) ||
      !part(translation, "z", pose.translation.z))
    return fail("A pose's translation holds what is no number");
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(pose.translation[axis]) > 1e12) return fail("A pose's translation reaches beyond 1e12 m");
  return pose;
}

}  // namespace alidade
